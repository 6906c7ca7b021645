#pragma once

// The STOPs of viewers of a robot on a bus, from the request to the answer.

#include <chrono>
#include <deque>
#include <optional>
#include <vector>

#include "host/robot/bus_connection.hpp"
#include "host/robot/sdo_queue.hpp"
#include "sim/scenario/scenario.hpp"
#include "tools/proleg/ui/driven_robot.hpp"
#include "tools/proleg/ui/session_base.hpp"

namespace proleg::tools {

class RobotStops {
 public:
  /// A STOP is answered after this time, with the modules that have confirmed it by then.
  static constexpr std::chrono::milliseconds longest_confirmation{500};

  /// file, bus, output: must outlive this.
  RobotStops(const sim::Scenario& file, host::BusConnection& bus, host::SessionOutput& output);

  /// Stops all modules at once; several STOPs are one for them. robot: null if this program drives none, but another
  /// may.
  void give(const std::vector<SessionRequests::Stop>& stops, DrivenRobot* robot);
  /// Answers the STOPs that all modules have confirmed, and those that are older than longest_confirmation.
  void answer();
  /// The robot starts again: no module has a STOP.
  void clear();

  /// Whether the module of each joint has confirmed the last STOP; nothing: there was none since clear().
  [[nodiscard]] const std::vector<std::optional<bool>>& confirmed() const { return confirmed_; }

 private:
  using Clock = std::chrono::steady_clock;

  struct Pending {
    host::RequestId request;
    Clock::time_point since;
  };

  void confirm(unsigned joint);

  const sim::Scenario& file_;
  host::SessionOutput& output_;
  host::SdoQueue queue_;  ///< quick stops while this program drives nothing
  host::BusAttachment attachment_;
  std::deque<Pending> pending_;
  std::vector<std::optional<bool>> confirmed_;
  std::optional<Clock::time_point> last_confirmation_;
};

}  // namespace proleg::tools
