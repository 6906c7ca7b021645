#pragma once

// The simulation of a robot beside the real one, in a thread of its own: however long it computes, the bus goes on.

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "sim/record/recorder.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::tools {

class Ghost {
 public:
  /// State of the simulated robot at a tick.
  struct State {
    std::vector<sim::Pose> link_poses;
    std::vector<double> joint_angles;    ///< rad
    std::vector<double> motor_torques;   ///< Nm
    std::vector<double> contact_forces;  ///< N, of each link
  };

  /// scenario: must outlive this.
  explicit Ghost(const sim::Scenario& scenario);
  ~Ghost();
  Ghost(const Ghost&) = delete;
  Ghost& operator=(const Ghost&) = delete;

  /// The next tick of the robot: its servos have got these pulses. Before tick 0 the simulated joints go to where the
  /// first pulses have them.
  void follow(std::uint32_t tick, std::vector<sim::ServoPulse> pulses);
  /// The last state that is known; nothing before the first, and after a failure.
  [[nodiscard]] std::optional<State> state() const;
  /// Why there is no simulation any more, once: it has failed, or this computer is too slow for it.
  [[nodiscard]] std::optional<std::string> take_failure();

 private:
  /// A simulation that is so far behind the robot is given up.
  static constexpr std::size_t max_waiting = 500;

  struct Tick {
    std::uint32_t tick;
    std::vector<sim::ServoPulse> pulses;
  };
  void run();
  [[nodiscard]] std::optional<Tick> next();
  void fail(const std::string& why);

  const sim::Scenario& scenario_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<Tick> ticks_;
  std::optional<State> state_;
  std::optional<std::string> failure_;
  bool has_failed_ = false;
  bool ends_ = false;
  std::thread thread_;  ///< the last to begin
};

}  // namespace proleg::tools
