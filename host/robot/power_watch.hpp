#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "host/robot/bus_user.hpp"
#include "host/robot/sdo_queue.hpp"
#include "shared/canopen/messages.hpp"

namespace proleg::host {

/// Whether the joints of a robot that moves still follow its gait: none of them is in a fault, without power, or on its
/// way to the safe pose. A fault is in the state frames of the module; for the rest the statuswords are read, one
/// module after the other, each of them every 0.8 s or more often (60 modules: every 1.2 s), with 20 ms between two
/// requests at least: TICK has its gaps.
class PowerWatch final : public BusUser {
 public:
  /// What was found.
  struct Loss {
    std::uint8_t node;
    std::uint16_t statusword;          ///< 0x6041
    canopen::EmergencyCode emergency;  ///< the last error that the module has reported; `none`: none
  };

  /// port: must outlive this. nodes: of the robot, kernel order.
  PowerWatch(CanPort& port, std::vector<std::uint8_t> nodes);
  PowerWatch(const PowerWatch&) = delete;
  PowerWatch& operator=(const PowerWatch&) = delete;

  /// From now on the joints should have power. Before, and after stop(), it sends nothing.
  void start(Microseconds now);
  void stop() { next_reading_ = never; }
  /// A module that has restarted is left alone until the master has set it up again, or has failed to do so.
  void return_to_gait(std::uint8_t node);

  /// The first joint that does not follow.
  [[nodiscard]] const std::optional<Loss>& loss() const { return loss_; }

  void receive(Microseconds now, const CanFrame& frame) override;
  void transmitted(Microseconds now, const CanFrame& frame) override { readings_.transmitted(now, frame); }
  void poll(Microseconds now) override;
  [[nodiscard]] Microseconds next_deadline() const override;

 private:
  struct Module {
    std::uint8_t node;
    bool is_away = false;  ///< it has booted
    canopen::EmergencyCode emergency = canopen::EmergencyCode::none;
  };
  [[nodiscard]] Module* module_of(std::uint8_t node);
  void read(std::uint8_t node);
  void judge(const Module& module, std::uint16_t statusword);

  std::vector<Module> modules_;
  SdoQueue readings_;
  Microseconds period_us_;
  Microseconds next_reading_ = never;
  std::size_t next_module_ = 0;
  std::optional<Loss> loss_;
};

}  // namespace proleg::host
