#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host/dynamixel/chain_settings.hpp"
#include "host/dynamixel/servo_chain.hpp"
#include "tests/host/dynamixel/emulated_line.hpp"
#include "tests/support/message_of.hpp"

namespace proleg::test {

/// Settings of joints J1, J2, ... with ids 1, 2, ... on a fast line.
inline host::ChainSettings chain_settings(unsigned joints) {
  host::ChainSettings settings;
  settings.device = "/dev/servos";
  settings.rate = 1'000'000;
  for (unsigned joint = 1; joint <= joints; ++joint) {
    host::ServoSettings servo;
    servo.joint = "J" + std::to_string(joint);
    servo.id = static_cast<std::uint8_t>(joint);
    settings.servos.push_back(servo);
  }
  return settings;
}

/// A chain of emulated servos on virtual time.
class ChainRig {
 public:
  explicit ChainRig(unsigned joints) : ChainRig(chain_settings(joints)) {}
  explicit ChainRig(const host::ChainSettings& settings)
      : servos(static_cast<unsigned>(settings.servos.size())),
        line(servos, now_us, settings.rate),
        chain(line, settings, [this](const std::string& text) { shown.push_back(text); }) {}

  void connect() { chain.connect(now_us + 10'000'000); }
  void switch_on() { chain.switch_on(now_us + 1'000'000); }
  /// A tick with the same angle for all joints; the clock moves to its end.
  void tick(double angle_deg) {
    const std::uint64_t end_us = now_us + chain.settings().tick_us;
    const std::vector<double> angles(chain.settings().servos.size(), angle_deg);
    try {
      chain.send_goals(angles, now_us + 1'000'000);
    } catch (const host::ServoError&) {
      overrun_us = now_us > end_us ? now_us - end_us : 0;
      now_us = std::max(now_us, end_us);
      throw;
    }
    overrun_us = now_us > end_us ? now_us - end_us : 0;
    now_us = std::max(now_us, end_us);
  }
  template <typename Action>
  static std::string error_of(const Action& action) {
    return message_of<host::ServoError>(action);
  }

  ServoEmulator servos;
  std::uint64_t now_us = 0;
  std::uint64_t overrun_us = 0;  ///< of the last tick
  std::vector<std::string> shown;
  EmulatedLine line;
  host::ServoChain chain;
};

}  // namespace proleg::test
