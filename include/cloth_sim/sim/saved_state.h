#pragma once
/// \file Saved states of a simulation, and their header.
///
/// A saved state is a header, then everything that the future of a simulation depends on:
/// topology, springs, masses, positions and velocities, clamps, obstacles, phases, tears, counts,
/// and what the method keeps from step to step (src/sim/state_format.cpp has the list). All
/// numbers are little-endian, so that any machine can read the files of any other.

#include <cstdint>
#include <stdexcept>
#include <string>

namespace cloth_sim {

struct SimulationParts;

/// Says why a state cannot be saved or loaded, in one line.
class StateError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Version of the contents. Raised whenever their list changes; other versions are refused.
constexpr std::uint32_t kStateVersion = 15;
/// Larger files are taken for something else [bytes]: 512 x 512 particles take some 300 MB.
constexpr std::uint64_t kMaxStateSize = 1ULL << 30;

/// Returns a simulation's state as bytes, header included.
std::string saveParts(const SimulationParts& parts);
/// Returns the simulation that was saved; it goes on as the saved one would, to the bit.
/// \param like  a simulation of the same scene.
/// \throws StateError if the bytes are damaged, of another version or of another scene.
SimulationParts loadParts(const std::string& bytes, const SimulationParts& like);
/// Returns the simulation that was saved, but with the method of `like`, which starts without a
/// memory. \throws StateError as loadParts does; another method is no reason.
SimulationParts adoptParts(const std::string& bytes, const SimulationParts& like);

/// Puts a header before `payload`: magic word, version, length, and a hash of the payload.
std::string sealState(const std::string& payload);
/// Returns the payload that `sealState` was given.
/// \throws StateError if `sealed` is something else, of another version, cut short or damaged.
std::string unsealState(const std::string& sealed);

}  // namespace cloth_sim
