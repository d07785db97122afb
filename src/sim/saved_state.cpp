#include "cloth_sim/sim/saved_state.h"

#include <sstream>

#include "archive.h"
#include "cloth_sim/solver/solver.h"
#include "support/hash.h"

namespace cloth_sim {
namespace {

constexpr char kMagic[] = "cloth_sim state\n";
constexpr std::size_t kMagicLength = sizeof kMagic - 1;
constexpr std::size_t kMostHeader = 64;  ///< [bytes]

/// The header, which stands between the magic word and the payload.
struct Header {
  std::uint32_t version = 0;
  std::uint64_t length = 0;
  std::uint64_t hash = 0;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(version, length, hash);
  }
};

std::uint64_t hashOf(const std::string& bytes) {
  Hash hash;
  hash.add(bytes.data(), bytes.size());
  return hash.value();
}

}  // namespace

std::string sealState(const std::string& payload) {
  std::ostringstream out(std::ios::binary);
  out.write(kMagic, kMagicLength);
  StateWriter archive(out);
  archive(Header{kStateVersion, payload.size(), hashOf(payload)});
  return out.str() + payload;
}

std::string unsealState(const std::string& sealed) {
  if (sealed.compare(0, kMagicLength, kMagic) != 0) throw StateError("this is no saved state");
  Header header;
  std::size_t start = kMagicLength;  // of the payload
  try {
    StateReader archive(sealed.substr(kMagicLength, kMostHeader));
    archive(header);
    start += archive.position();
  } catch (const cereal::Exception&) {
    throw StateError("the saved state is cut short");
  }
  if (header.version != kStateVersion) {
    throw StateError("the saved state is of version " + std::to_string(header.version) +
                     " (expected " + std::to_string(kStateVersion) + ")");
  }
  std::string payload = sealed.substr(start);
  if (payload.size() < header.length) throw StateError("the saved state is cut short");
  if (payload.size() > header.length || hashOf(payload) != header.hash) {
    throw StateError("the saved state is damaged: its contents do not match their hash");
  }
  return payload;
}

}  // namespace cloth_sim
