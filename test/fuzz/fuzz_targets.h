#pragma once
/// \file Functions that take arbitrary bytes. The tests of this folder and the programs of
/// libFuzzer (libfuzzer/) share these functions: each returns if the program behaves, and throws
/// Misbehaviour, crashes or hangs if it does not.

#include <stdexcept>
#include <string>
#include <vector>

namespace cloth_sim::fuzz {

/// The program did with some bytes what it promises never to do (docs/reliability.md).
class Misbehaviour : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

/// A kind of input.
struct Target {
  const char* name;
  /// Feeds the program with bytes. \return whether it accepted them.
  bool (*feed)(const std::string& bytes);
  /// Returns good inputs, of which others are made.
  std::vector<std::string> (*seeds)();
};

/// state, scene, obj, surface, stroke, command.
const std::vector<Target>& targets();
/// \throws std::invalid_argument if there is no such target.
const Target& findTarget(const std::string& name);

}  // namespace cloth_sim::fuzz
