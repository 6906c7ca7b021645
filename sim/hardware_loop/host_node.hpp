#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "shared/computer/master/master.hpp"
#include "sim/bus/bus.hpp"
#include "sim/hardware_loop/crystal.hpp"
#include "sim/hardware_loop/master_input.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// The host on the simulated bus: node 127 with the master that sets the modules up and changes their parameters, on an
/// exact clock.
class HostNode final : private BusListener {
 public:
  /// Attaches to the bus. scenario: must outlive the node. sync_producer: joint whose module produces the SYNC.
  HostNode(Bus& bus, const Scenario& scenario, unsigned sync_producer);
  HostNode(const HostNode&) = delete;
  HostNode& operator=(const HostNode&) = delete;

  void start(BusTime now);
  [[nodiscard]] BusTime next_event() const { return next_event_; }
  void advance_to(BusTime now);

  /// The host does nothing until resume(), which handles what was received meanwhile.
  void stall() {
    is_stalled_ = true;
    update_deadline();
  }
  void resume(BusTime now);
  /// The host is gone for ever.
  void die();

  [[nodiscard]] canopen::MasterState state() const { return master_.state(); }
  /// Whether the modules have a change of the scenario, by its position; final from the tick of the change on. (The
  /// master drops a change that is not committed long before its tick.)
  [[nodiscard]] bool has_made_change(std::size_t position) const {
    return position < master_.changes_made() && !input_.changes[position].dropped;
  }
  /// Why the start failed, or the first problem while the robot moves, as one line; returned once.
  [[nodiscard]] std::optional<std::string> take_problem();
  /// The oldest event that this function has not returned yet, as one line for a person.
  [[nodiscard]] std::optional<std::string> take_event();

 private:
  void received(BusTime time, const CanFrame& frame) override;
  void transmitted(BusTime time, const CanFrame& frame) override;
  void update_deadline() { next_event_ = is_stalled_ ? never_on_bus : clock_.when(master_.next_deadline()); }

  const Scenario& scenario_;
  MasterInput input_;
  Crystal clock_;
  Controller& controller_;
  canopen::Master master_;
  bool problem_taken_ = false;
  bool is_stalled_ = false;
  bool is_dead_ = false;
  struct Missed {
    CanFrame frame;
    bool was_sent;
  };
  std::vector<Missed> missed_;  ///< while it was stalled
  BusTime next_event_ = never_on_bus;
};

}  // namespace proleg::sim
