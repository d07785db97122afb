#pragma once
/// \file Saved states of a simulation: their frame, and files of them.
///
/// A saved state is a header, then everything that the future of a simulation depends on:
/// topology, springs, masses, positions and velocities, clamps, obstacles, phases, tears, what was
/// counted and what solvers keep. All numbers are little-endian, so files go from machine to
/// machine.

#include <cstdint>
#include <stdexcept>
#include <string>

namespace cloth_sim {

/// Why a state cannot be saved or loaded, in one line.
class StateError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Raised whenever what is kept changes.
constexpr std::uint32_t kStateVersion = 4;

/// Puts a header before `payload`: what it is, version, length and a hash of it.
std::string sealState(const std::string& payload);
/// What `sealState` was given.
/// \throws StateError if `sealed` is something else, of another version, cut short or damaged.
std::string unsealState(const std::string& sealed);

/// Writes a file whole or not at all: under another name first, flushed to the disk, then renamed.
/// A link of that name is replaced, not followed.
/// \throws StateError with what the system says.
void writeFileWhole(const std::string& path, const std::string& bytes);
/// Reads a file; no link, no directory, no device.
/// \throws StateError
std::string readRegularFile(const std::string& path);

}  // namespace cloth_sim
