#pragma once

// A simulated robot as the bus of host state machines, on virtual time.

#include <algorithm>
#include <cstdint>
#include <functional>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "host/robot/bus_user.hpp"
#include "sim/live/live_robot.hpp"
#include "slcan_line.hpp"

namespace proleg::test {

inline constexpr Microseconds second = 1'000'000;

class LiveBus final : public CanPort {
 public:
  explicit LiveBus(const sim::Scenario& scenario, sim::LiveRobotOptions options = {})
      : robot_(scenario, with_callbacks(std::move(options))) {}

  void attach(host::BusUser& user) { users_.push_back(&user); }
  void detach(host::BusUser& user) { std::erase(users_, &user); }
  sim::LiveRobot& robot() { return robot_; }
  [[nodiscard]] Microseconds now() const { return robot_.now() / 1'000; }

  /// Frames to and from the host vanish with this probability, between the host and its adapter.
  void lose(double probability, std::uint64_t seed) {
    loss_ = probability;
    random_.seed(seed);
  }

  /// Frames in one direction vanish from now on, between the host and its adapter.
  void cut_to_robot() { is_cut_to_robot_ = true; }
  /// confirms: the adapter still confirms the frames of the host.
  void cut_from_robot(bool confirms) {
    is_cut_from_robot_ = true;
    confirms_ = confirms;
  }

  /// From now on the frames go through a line and an slcan adapter.
  SlcanLine& connect_by_slcan() { return line_.emplace(robot_); }

  /// As many slcan adapters: a frame is confirmed while it waits for the bus. Beyond so many it is dropped.
  void confirm_at_once(std::size_t room) { room_ = room; }
  [[nodiscard]] std::uint64_t dropped_frames() const { return dropped_frames_; }

  bool send(const CanFrame& frame) override {
    ++sent_frames_;
    for (host::BusUser* user : std::vector(users_)) {
      user->requested(now(), frame);
    }
    if (line_) {
      return line_->send_by_host(frame);
    }
    if (is_cut_to_robot_ || is_lost()) {
      events_.push_back({robot_.now(), frame, true});
      return true;
    }
    if (room_ != 0 && robot_.waiting() >= room_) {
      ++dropped_frames_;
      return true;
    }
    if (room_ != 0) {
      events_.push_back({robot_.now(), frame, true});
    }
    return robot_.send(frame);
  }
  [[nodiscard]] std::uint64_t sent_frames() const { return sent_frames_; }

  bool run_until(Microseconds end, const std::function<bool()>& done) {
    for (;;) {
      for (host::BusUser* user : std::vector(users_)) {
        if (user->next_deadline() <= now()) {
          user->poll(now());
        }
      }
      if (done()) {
        return true;
      }
      if (now() >= end) {
        return false;
      }
      Microseconds wake = end;
      for (const host::BusUser* user : users_) {
        wake = std::min(wake, user->next_deadline());
      }
      if (line_) {
        wake = std::min(wake, line_->next_event());
      }
      if (events_.empty()) {
        robot_.advance_to(std::min(robot_.next_event(), std::max(wake, now() + 1) * 1'000));
      }
      if (line_) {
        line_->poll();
        for (const SlcanLine::Event& event : line_->take_events()) {
          events_.push_back({event.time * 1'000, event.frame, event.is_own});
        }
      }
      for (const Event& event : std::exchange(events_, {})) {
        for (host::BusUser* user : std::vector(users_)) {
          event.is_own ? user->transmitted(event.time / 1'000, event.frame)
                       : user->receive(event.time / 1'000, event.frame);
        }
      }
    }
  }
  void run_for(Microseconds duration) {
    run_until(now() + duration, [] { return false; });
  }

 private:
  struct Event {
    sim::BusTime time;
    CanFrame frame;
    bool is_own;
  };
  bool is_lost() { return loss_ > 0 && std::uniform_real_distribution<>()(random_) < loss_; }

  sim::LiveRobotOptions with_callbacks(sim::LiveRobotOptions options) {
    options.on_frame = [this](const sim::Transmission& transmission, bool is_own) {
      if (line_ && !is_own) {
        line_->received_from_bus(transmission.frame);
      } else if (!is_own && !is_cut_from_robot_ && !is_lost()) {
        events_.push_back({transmission.end, transmission.frame, false});
      }
    };
    options.on_sent = [this](sim::BusTime time, const CanFrame& frame, std::uint32_t /*source*/) {
      if (!line_ && room_ == 0 && confirms_) {
        events_.push_back({time, frame, true});
      }
    };
    return options;
  }

  std::vector<host::BusUser*> users_;
  std::vector<Event> events_;
  double loss_ = 0;
  bool is_cut_to_robot_ = false;
  bool is_cut_from_robot_ = false;
  bool confirms_ = true;
  std::mt19937_64 random_;
  std::uint64_t sent_frames_ = 0;
  std::size_t room_ = 0;
  std::uint64_t dropped_frames_ = 0;
  sim::LiveRobot robot_;
  std::optional<SlcanLine> line_;
};

}  // namespace proleg::test
