#pragma once

// Checks that modules and this computer have the same set-points, in all 32 bits: state frames carry only the upper
// bits of angles.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "shared/computer/master/master.hpp"
#include "shared/fixed/crc32.hpp"

namespace proleg::host {

class SetpointCheck {
 public:
  enum class Result : std::uint8_t {
    equal,
    different,
    // With the results below nothing was compared.
    no_checksum,   ///< the program of the module is older than these checksums
    no_answer,     ///< the module has not answered
    not_complete,  ///< the module has joined the robot late
    unknown_tick,  ///< this computer does not know the set-points up to the tick of the module
  };

  /// joints: number of joints of the robot.
  explicit SetpointCheck(std::size_t joints) : crcs_(joints), kept_(kept_ticks * joints) {}

  /// Adds the set-points of all joints that this computer has for the next tick, from tick 0 on.
  void add(std::span<const std::int32_t> setpoints);

  /// Compares the answer of the module of a joint, for one of the last kept_ticks ticks.
  [[nodiscard]] Result compare(unsigned joint, const canopen::Master::SetpointChecksum& found) const;

  /// Number of kept ticks: more than a robot takes to stop, also with a tick of 1 ms and several modules that do not
  /// answer.
  static constexpr std::uint32_t kept_ticks = 8'192;

 private:
  std::vector<Crc32> crcs_;
  std::vector<std::uint32_t> kept_;  ///< checksums of all joints, by tick modulo kept_ticks
  std::uint32_t ticks_ = 0;
};

/// The reason why nothing was compared, for people: "its module has joined late". Empty for the other results.
[[nodiscard]] std::string why_not_compared(SetpointCheck::Result result);

}  // namespace proleg::host
