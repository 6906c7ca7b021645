#pragma once

#include <bit>
#include <cstdint>
#include <optional>
#include <string>

#include "shared/computer/hash/sha256.hpp"
#include "sim/physics/world.hpp"

namespace proleg::sim {

/// Hash of the states of a world after ticks. Two runs on any two machines had the same motion if their hashes are
/// equal.
class WorldHash {
 public:
  void append(const World& world) {
    for (const double number : world.state()) {
      has_states_ = true;
      const auto bits = std::bit_cast<std::uint64_t>(number);
      hash_.append(static_cast<std::int32_t>(bits));
      hash_.append(static_cast<std::int32_t>(bits >> 32U));
    }
  }

  /// As ValueHash::hex(); nothing if the engine does not give the same states on every machine.
  [[nodiscard]] std::optional<std::string> hex() const {
    return has_states_ ? std::optional(hash_.hex()) : std::nullopt;
  }

 private:
  ValueHash hash_;
  bool has_states_ = false;
};

}  // namespace proleg::sim
