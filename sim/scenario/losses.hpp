#pragma once

// State frames that joints do not receive, chosen beforehand. The same losses give the same bits in a simulation in
// memory and with modules on a bus.

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "shared/kernel/kernel.hpp"
#include "sim/robot/robot_model.hpp"

namespace proleg::sim {

/// One state frame, of the state of a tick, that one joint does not receive. Joints in kernel order.
struct Loss {
  std::uint32_t tick;    ///< of the state; the frame is labelled with it modulo 256
  std::uint8_t sender;   ///< joint
  std::uint8_t channel;  ///< 0, or 1 for the frame of the joint's second broadcasting slot
  std::uint8_t receiver;
  int line = 0;  ///< of the file that lists it, from 1 on; 0: there is none
};

/// Each frame is lost for each receiver with the same probability. The result does not depend on the number of joints,
/// on the order of calls or on anything else: the noise is PCG32, seeded again for each frame.
struct RandomLosses {
  std::uint64_t seed = 0;
  std::uint32_t threshold = 0;  ///< probability times 2^32
  std::uint32_t first_tick = 0;
  std::uint32_t last_tick = std::numeric_limits<std::uint32_t>::max();
};

class Losses {
 public:
  /// No losses.
  Losses() = default;
  /// source: what errors name, such as the file of the list.
  explicit Losses(std::vector<Loss> list, std::string source = "--losses");
  explicit Losses(const RandomLosses& random) : random_(random) {}

  [[nodiscard]] bool any() const { return !list_.empty() || random_.threshold != 0; }
  /// The joints that do not receive a frame.
  [[nodiscard]] JointMask receivers_without(std::uint32_t tick, unsigned sender, unsigned channel) const;
  /// Throws InputError if a loss can have no effect in a run of that many ticks.
  void require_effect(std::uint32_t ticks, const KernelConfiguration& kernel) const;
  [[nodiscard]] bool lost(const Loss& loss) const {
    return receivers_without(loss.tick, loss.sender, loss.channel).contains(loss.receiver);
  }

 private:
  std::vector<Loss> list_;  ///< sorted
  std::string source_ = "--losses";
  RandomLosses random_;
};

/// Reads the value of --losses. It is SEED:RATE or SEED:RATE@FIRST-LAST, where RATE is a number up to 1 or a percentage
/// ("7:5%") and FIRST and LAST are ticks. Or it names a file with a line "TICK SENDER RECEIVER [CHANNEL]" for each
/// loss: joints by their names, "*" for all receivers, channel 1 (the default) or 2; # starts a comment. Throws
/// InputError.
[[nodiscard]] Losses read_losses(const std::string& argument, const RobotModel& robot);

}  // namespace proleg::sim
