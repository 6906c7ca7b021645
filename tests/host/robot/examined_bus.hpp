#pragma once

// A simulated robot, and an adapter with a controller of its own on its bus: what a person has who examines the bus.
// All on virtual time.

#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "host/robot/bus_examination.hpp"
#include "host/robot/findings.hpp"
#include "host/robot/robot_drive.hpp"
#include "shared/kernel/fingerprint.hpp"
#include "sim/hardware_loop/master_input.hpp"
#include "sim/live/live_robot.hpp"

#include "live_bus.hpp"

namespace proleg::test {
/// An adapter between a program and the bus: queues frames, and reports what its controller sees, as SocketCAN does.
class BusAdapter final : public CanPort, private sim::BusListener {
 public:
  explicit BusAdapter(sim::Bus& bus) : controller_(bus.attach(*this)) {
    controller_.set_order(sim::Controller::Order::request);
    own_.state.is_connected = true;
  }
  BusAdapter(const BusAdapter&) = delete;
  BusAdapter& operator=(const BusAdapter&) = delete;

  bool send(const CanFrame& frame) override {
    constexpr std::size_t longest_queue = 1'000;
    if (queue_.size() >= longest_queue) {
      ++own_.statistics.dropped_out;
      return false;
    }
    queue_.push_back(frame);
    fill();
    return true;
  }
  [[nodiscard]] const host::OwnEnd& own_end() const { return own_; }
  [[nodiscard]] sim::Controller& controller() { return controller_; }

  struct Event {
    sim::BusTime time;
    CanFrame frame;
    bool is_own;
  };
  std::vector<Event> take_events() { return std::exchange(events_, {}); }
  [[nodiscard]] bool has_events() const { return !events_.empty(); }
  /// Changes a frame of another node on its way to the program.
  std::function<CanFrame(const CanFrame&)> change = [](const CanFrame& frame) { return frame; };

 private:
  void received(sim::BusTime time, const CanFrame& frame) override {
    ++own_.statistics.received;
    events_.push_back({time, change(frame), false});
  }
  void transmitted(sim::BusTime time, const CanFrame& frame) override {
    ++own_.statistics.transmitted;
    events_.push_back({time, frame, true});
    fill();
  }
  void error_seen(sim::BusTime /*time*/, bool /*was_sending*/) override {
    static constexpr std::array kinds{CanErrorKind::stuff,           CanErrorKind::form,
                                      CanErrorKind::acknowledgement, CanErrorKind::bit_recessive,
                                      CanErrorKind::bit_dominant,    CanErrorKind::crc};
    const auto error = static_cast<std::size_t>(controller_.last_error());
    if (error >= 1 && error <= kinds.size()) {
      own_.state.errors.add(kinds.at(error - 1));
    }
    ++own_.state.bus_errors;
    note_state();
  }
  void error_state_changed(sim::BusTime /*time*/) override { note_state(); }
  void note_state() {
    CanStatus& status = own_.state.controller;
    status.transmit_errors = static_cast<std::uint16_t>(controller_.transmit_errors());
    status.receive_errors = static_cast<std::uint16_t>(controller_.receive_errors());
    status.state = controller_.error_state() == sim::ErrorState::bus_off   ? CanState::bus_off
                   : controller_.error_state() == sim::ErrorState::passive ? CanState::error_passive
                                                                           : CanState::error_active;
  }
  void fill() {
    while (!queue_.empty() && controller_.send(queue_.front())) {
      queue_.pop_front();
    }
  }

  sim::Controller& controller_;
  std::deque<CanFrame> queue_;
  std::vector<Event> events_;
  host::OwnEnd own_;
};

/// A node that sends frames by itself: each again after its period.
class Sender final : private sim::BusListener {
 public:
  explicit Sender(sim::Bus& bus) : bus_(bus), controller_(bus.attach(*this)) {}
  Sender(const Sender&) = delete;
  Sender& operator=(const Sender&) = delete;

  /// next: makes the n-th frame, n from 0. period: 0: as soon as the one before was sent.
  void repeat(sim::BusTime period, std::function<CanFrame(unsigned n)> next) {
    period_ = period;
    next_ = std::move(next);
    due_ = bus_.now();
  }
  [[nodiscard]] sim::BusTime next_event() const { return due_; }
  void advance_to(sim::BusTime now) {
    if (due_ > now) {
      return;
    }
    const bool is_taken = controller_.send(next_(count_));
    count_ += is_taken ? 1U : 0U;
    due_ = period_ == 0 ? sim::never_on_bus : now + period_;
  }

 private:
  void received(sim::BusTime /*time*/, const CanFrame& /*frame*/) override {}
  void transmitted(sim::BusTime /*time*/, const CanFrame& /*frame*/) override {
    if (period_ == 0 && next_) {
      (void)controller_.send(next_(count_++));
    }
  }

  sim::Bus& bus_;
  sim::Controller& controller_;
  sim::BusTime period_ = 0;
  sim::BusTime due_ = sim::never_on_bus;
  unsigned count_ = 0;
  std::function<CanFrame(unsigned)> next_;
};

class ExaminedBus {
 public:
  explicit ExaminedBus(const sim::Scenario& scenario, sim::LiveRobotOptions options = {})
      : scenario_(scenario),
        robot_(scenario, std::move(options)),
        adapter_(robot_.bus()),
        second_adapter_(robot_.bus()) {
    // The controller that comes with the robot stands for no node here.
    robot_.bus().controller(robot_.adapter().index()).unplug();
  }
  ExaminedBus(const ExaminedBus&) = delete;
  ExaminedBus& operator=(const ExaminedBus&) = delete;

  sim::LiveRobot& robot() { return robot_; }
  sim::Bus& bus() { return robot_.bus(); }
  BusAdapter& adapter() { return adapter_; }
  [[nodiscard]] Microseconds now() const { return robot_.now() / 1'000; }
  /// A node that was not there, from now on.
  Sender& add_sender() { return *senders_.emplace_back(std::make_unique<Sender>(robot_.bus())); }
  /// Takes the wires of all modules off the bus.
  void unplug_modules() {
    for (unsigned joint = 0; joint < robot_.joint_count(); ++joint) {
      bus().controller(robot_.module(joint).controller()).unplug();
    }
    bus().controller(second_adapter_.controller().index()).unplug();
  }
  /// Called at a time, once.
  void at(Microseconds time, std::function<void()> action) { actions_.emplace_back(time, std::move(action)); }

  /// Another computer sets the robot up and drives it from now on. False if it does not start.
  bool drive() {
    canopen::MasterOptions options;
    options.core_fingerprint = core_fingerprint;
    options.resets_modules = true;
    options.answer_timeout_us = 150'000;
    options.attempts = 8;
    input_ = std::make_unique<sim::MasterInput>(scenario_);
    drive_ = std::make_unique<host::RobotDrive>(second_adapter_, input_->setup, options, input_->changes);
    drive_->master().start(now());
    const auto state = [this] { return drive_->master().state(); };
    run_until(now() + 20 * second,
              [&] { return state() == canopen::MasterState::running || state() == canopen::MasterState::failed; });
    return state() == canopen::MasterState::running;
  }
  /// That computer is switched off.
  void end_host() { drive_.reset(); }
  [[nodiscard]] const host::RobotDrive& host() const { return *drive_; }

  host::BusObservations examine() {
    host::BusExamination examination(adapter_, [this] { return adapter_.own_end(); });
    examination_ = &examination;
    examination.start(now());
    constexpr Microseconds longest = 60 * second;
    is_done_ = run_until(now() + longest, [&] { return examination.is_done(); });
    examination_ = nullptr;
    return examination.observations();
  }
  /// Whether the last examination has ended by itself.
  [[nodiscard]] bool is_done() const { return is_done_; }

  void run_for(Microseconds duration) {
    run_until(now() + duration, [] { return false; });
  }

 private:
  bool run_until(Microseconds end, const std::function<bool()>& done) {
    for (;;) {
      act();
      if (done()) {
        return true;
      }
      if (now() >= end) {
        return false;
      }
      if (!adapter_.has_events() && !second_adapter_.has_events()) {
        const Microseconds wake = std::max(std::min(end, next_wake()), now() + 1) * 1'000;
        sim::BusTime next = std::min(robot_.next_event(), wake);
        for (const auto& sender : senders_) {
          next = std::min(next, std::max(sender->next_event(), robot_.now()));
        }
        robot_.advance_to(next);
        for (const auto& sender : senders_) {
          sender->advance_to(robot_.now());
        }
      }
      deliver(adapter_, examination_);
      deliver(second_adapter_, drive_.get());
    }
  }
  void act() {
    for (auto& [time, action] : actions_) {
      if (action && time <= now()) {
        std::exchange(action, nullptr)();
      }
    }
    for (host::BusUser* user : {static_cast<host::BusUser*>(examination_), static_cast<host::BusUser*>(drive_.get())}) {
      if (user != nullptr && user->next_deadline() <= now()) {
        user->poll(now());
      }
    }
  }
  [[nodiscard]] Microseconds next_wake() const {
    Microseconds wake = never;
    for (const auto& [time, action] : actions_) {
      wake = action ? std::min(wake, time) : wake;
    }
    wake = examination_ != nullptr ? std::min(wake, examination_->next_deadline()) : wake;
    return drive_ ? std::min(wake, drive_->next_deadline()) : wake;
  }
  static void deliver(BusAdapter& adapter, host::BusUser* user) {
    for (const BusAdapter::Event& event : adapter.take_events()) {
      if (user != nullptr) {
        event.is_own ? user->transmitted(event.time / 1'000, event.frame)
                     : user->receive(event.time / 1'000, event.frame);
      }
    }
  }

  const sim::Scenario& scenario_;
  sim::LiveRobot robot_;
  BusAdapter adapter_;
  BusAdapter second_adapter_;  ///< of the computer that drives the robot
  std::vector<std::unique_ptr<Sender>> senders_;
  std::vector<std::pair<Microseconds, std::function<void()>>> actions_;
  std::unique_ptr<sim::MasterInput> input_;
  std::unique_ptr<host::RobotDrive> drive_;
  host::BusExamination* examination_ = nullptr;
  bool is_done_ = false;
};

}  // namespace proleg::test
