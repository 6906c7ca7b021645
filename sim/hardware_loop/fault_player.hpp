#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "sim/bus/bus.hpp"
#include "sim/bus/controller.hpp"
#include "sim/fault/fault.hpp"
#include "sim/hardware_loop/hardware_options.hpp"
#include "sim/hardware_loop/host_node.hpp"
#include "sim/hardware_loop/module_rack.hpp"
#include "sim/loop/plant.hpp"
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

/// Plays a schedule: lets each fault begin and end at its time after the SYNC of its tick. (So native modules and
/// virtual chips meet it at the same place of the tick, whatever the producer's crystal.)
class FaultPlayer {
 public:
  /// What the faults act on. All must outlive the player.
  struct Stage {
    const Scenario& scenario;
    unsigned sync_producer;  ///< joint, for a second master
    FaultState& state;
    Bus& bus;
    ModuleRack& rack;
    Plant& plant;
    HostNode& host;
  };
  FaultPlayer(const FaultSchedule& schedule, const Stage& stage);
  ~FaultPlayer();
  FaultPlayer(const FaultPlayer&) = delete;
  FaultPlayer& operator=(const FaultPlayer&) = delete;

  void begin_tick(std::uint32_t tick, BusTime sync);
  [[nodiscard]] BusTime next_event() const;
  void advance_to(BusTime now);
  /// Whether a fault has begun.
  [[nodiscard]] bool has_begun() const { return has_begun_; }

 private:
  class Babbler;
  enum class Phase : std::uint8_t { begin, repeat, ramp, end };
  struct Action {
    const Fault* fault;
    Phase phase;
  };

  [[nodiscard]] BusTime next_action() const;
  void act(const Action& action, std::uint64_t time_us, BusTime now);
  void change_supply(const Fault& fault, std::uint32_t mv, std::uint64_t time_us, BusTime now);
  void ramp_supply(const Fault& fault, std::uint64_t time_us, BusTime now);
  void begin(const Fault& fault, BusTime now);
  void end(const Fault& fault, BusTime now);
  [[nodiscard]] JointModule& module_of(const Fault& fault) const { return stage_.rack.module(*fault.joint); }

  /// The supply of a module's chip, which falls and rises by and by.
  struct Supply {
    std::uint32_t mv = nominal_supply_mv;
    std::uint32_t wanted_mv = nominal_supply_mv;
    bool is_ramping = false;
  };
  static constexpr std::uint32_t nominal_supply_mv = 3'300;

  Stage stage_;
  std::vector<Supply> supplies_;                  ///< by joint
  std::multimap<std::uint64_t, Action> actions_;  ///< by time in microseconds
  std::uint32_t tick_ = 0;
  BusTime sync_ = 0;
  bool has_started_ = false;  ///< SYNC 0 was on the bus
  bool has_begun_ = false;
  // Other nodes, attached when a fault needs them.
  std::unique_ptr<Babbler> babbler_;
  std::unique_ptr<Injector> foreign_node_;
  std::vector<std::unique_ptr<HostNode>> masters_;  ///< one for each fault of this kind so far
};

}  // namespace proleg::sim
