#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim/bus/controller.hpp"
#include "sim/fault/fault.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// What is wrong with bus and sensors at the moment, as the rules of the bus and the modules' pins ask for it. Which
/// frames are hit follows from the scenario's seed, the tick, the identifier and the attempt, and not from the order of
/// calls: native and virtual modules meet the same faults.
class FaultState {
 public:
  explicit FaultState(const Scenario& scenario);

  void begin_tick(std::uint32_t tick);

  /// Probability, times 2^32, that a transmission is destroyed.
  void set_corruption(std::uint32_t threshold) { corruption_ = threshold; }
  void set_touch(unsigned joint, TouchFault touch) { modules_[joint].touch = touch; }
  void set_loss(unsigned joint, std::uint32_t threshold) { modules_[joint].loss = threshold; }
  void set_delay(unsigned joint, BusTime delay) { modules_[joint].delay = delay; }

  /// Whether the transmission of a frame that begins now is destroyed.
  [[nodiscard]] bool destroys(const CanFrame& frame);
  /// Whether a module does not get a frame that ends now. Controllers of the bus have the index of their joint.
  [[nodiscard]] bool loses(const CanFrame& frame, std::size_t receiver);
  /// How much later a module gets a frame.
  [[nodiscard]] BusTime delay(std::size_t receiver) const {
    return receiver < modules_.size() ? modules_[receiver].delay : 0;
  }
  /// What the touch sensors of a joint read, in the bits of firmware::ContactPort.
  [[nodiscard]] std::uint8_t sensors(unsigned joint, std::uint8_t contacts) const;

 private:
  struct Module {
    TouchFault touch = TouchFault::none;
    std::uint32_t loss = 0;
    BusTime delay = 0;
  };
  /// The first number of a stream of its own.
  [[nodiscard]] std::uint32_t draw(std::uint32_t use, std::uint32_t detail) const;

  const Scenario& scenario_;
  std::vector<Module> modules_;  ///< by joint
  std::uint32_t tick_ = 0;
  std::uint32_t corruption_ = 0;
  std::array<std::uint16_t, CanFrame::max_identifier + 1> attempts_{};  ///< by identifier, in this tick
};

}  // namespace proleg::sim
