#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "sim/bus/bus.hpp"
#include "sim/fault/fault.hpp"
#include "sim/hardware_loop/fault_state.hpp"
#include "sim/hardware_loop/host_node.hpp"
#include "sim/hardware_loop/injector.hpp"
#include "sim/hardware_loop/module_rack.hpp"
#include "sim/loop/plant.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

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
  enum class Phase : std::uint8_t { begin, repeat, end };
  struct Action {
    const Fault* fault;
    Phase phase;
  };

  [[nodiscard]] BusTime next_action() const;
  void act(const Action& action, std::uint64_t time_us, BusTime now);
  void begin(const Fault& fault, BusTime now);
  void end(const Fault& fault, BusTime now);
  [[nodiscard]] JointModule& module_of(const Fault& fault) const { return stage_.rack.module(*fault.joint); }

  Stage stage_;
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
