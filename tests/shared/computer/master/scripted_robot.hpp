#pragma once

// A master and scripted modules on a simulated bus, moved event by event.

#include <gtest/gtest.h>

#include <deque>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "robot.hpp"
#include "scripted_module.hpp"
#include "shared/computer/master/master.hpp"

namespace proleg::test {

/// A random number, 0 to count - 1.
inline unsigned pick(std::mt19937_64& random, unsigned count) { return static_cast<unsigned>(random() % count); }

class MasterNode final : public sim::BusListener, private CanPort {
 public:
  MasterNode(sim::Bus& bus, const canopen::RobotSetup& setup, const canopen::MasterOptions& options,
             std::span<Change> changes)
      : controller(bus.attach(*this)), master(*this, setup, options, changes) {}

  void received(sim::BusTime time, const CanFrame& frame) override {
    if (late_us != 0) {
      late_frames.emplace_back(time / 1000 + late_us, frame);
    } else if (!is_deaf) {
      master.receive(time / 1000, frame);
    }
  }
  void transmitted(sim::BusTime time, const CanFrame& frame) override { master.transmitted(time / 1000, frame); }
  /// Hands over the late frames that are due.
  void take_late_frames(Microseconds now) {
    for (; !late_frames.empty() && late_frames.front().first <= now; late_frames.pop_front()) {
      master.receive(now, late_frames.front().second);
    }
  }

  sim::Controller& controller;
  /// Whether a frame is lost when it is sent.
  std::function<bool(const CanFrame&)> vanishes;
  bool is_deaf = false;      ///< no frame reaches the master
  Microseconds late_us = 0;  ///< how much later frames reach the master
  std::deque<std::pair<Microseconds, CanFrame>> late_frames;
  canopen::Master master;

 private:
  bool send(const CanFrame& frame) override { return (vanishes && vanishes(frame)) || controller.send(frame); }
};

class ScriptedRobot {
 public:
  static constexpr std::uint32_t fingerprint = 0xF1A9;

  explicit ScriptedRobot(unsigned joints, std::vector<Change> planned = {})
      : plan(std::move(planned)), changes(plan), setup_(joints) {
    options.core_fingerprint = fingerprint;
    for (unsigned joint = 0; joint < joints; ++joint) {
      add_module(setup_.nodes[joint]);
    }
    bus.set_frame_listener([this](const sim::Transmission& transmission) { transmissions.push_back(transmission); });
  }

  /// Adds a module with its own power switch.
  ScriptedModule& add_module(std::uint8_t node) {
    modules.push_back(std::make_unique<ScriptedModule>(bus, node));
    modules.back()->configuration_crc = canopen::configuration_crc(setup());
    return *modules.back();
  }

  [[nodiscard]] canopen::RobotSetup& setup() { return setup_.setup; }
  [[nodiscard]] ScriptedModule& module(unsigned joint) { return *modules[joint]; }
  [[nodiscard]] canopen::Master& master() { return master_node().master; }
  [[nodiscard]] MasterNode& master_node() {
    if (!master_) {
      master_ = std::make_unique<MasterNode>(bus, setup(), options, changes);
    }
    return *master_;
  }
  [[nodiscard]] Microseconds now() const { return now_; }

  /// Starts the master, then switches all modules on.
  void start() {
    master().start(now_);
    for (const auto& one : modules) {
      one->power_on(now_);
    }
  }

  /// Lets time pass until `done`, at most max_us; returns whether it is done.
  template <typename Done>
  bool run_until(Done done, Microseconds max_us) {
    const Microseconds end = now_ + max_us;
    while (!done()) {
      Microseconds next = master().next_deadline();
      for (const auto& one : modules) {
        next = std::min(next, one->next_deadline());
      }
      if (const auto& late = master_node().late_frames; !late.empty()) {
        next = std::min(next, late.front().first);
      }
      next = std::max(next, now_);
      const sim::BusTime bus_event = bus.next_event();
      const bool bus_first = bus_event != sim::never_on_bus && bus_event <= next * 1000;
      if ((bus_first ? bus_event / 1000 : next) > end) {
        now_ = end;
        bus.advance_to(end * 1000);
        return done();
      }
      if (bus_first) {
        bus.advance_to(bus_event);
        now_ = bus_event / 1000;
        take_events();
        continue;
      }
      now_ = next;
      bus.advance_to(now_ * 1000);
      for (const auto& one : modules) {
        one->poll(now_);
      }
      master_node().take_late_frames(now_);
      if (master().next_deadline() <= now_) {
        master().poll(now_);
        EXPECT_GT(master().next_deadline(), now_) << "a deadline that is polled is over";
      }
      take_events();
    }
    return true;
  }
  void run_for(Microseconds time_us) {
    run_until([] { return false; }, time_us);
  }
  bool run_until_running(Microseconds max_us = 10'000'000) {
    return run_until([this] { return settled(); }, max_us) && master().state() == canopen::MasterState::running;
  }
  bool run_to_tick(std::uint32_t tick) {
    return run_until([&] { return master().tick().value_or(0) >= tick; }, tick * 20'000ULL);
  }
  [[nodiscard]] bool settled() {
    return master().state() == canopen::MasterState::running || master().state() == canopen::MasterState::failed;
  }
  /// Runs until the start has failed, and returns the problem.
  canopen::Problem problem_of_start() {
    start();
    EXPECT_TRUE(run_until([this] { return settled(); }, 20'000'000)) << "the start does not end";
    EXPECT_EQ(master().state(), canopen::MasterState::failed);
    return master().problem();
  }

  [[nodiscard]] std::size_t count(canopen::EventKind kind) const {
    return static_cast<std::size_t>(std::ranges::count(events, kind, &canopen::Event::kind));
  }
  /// Number of EMCY messages of all modules.
  [[nodiscard]] std::size_t emergencies() const {
    std::size_t sum = 0;
    for (const auto& one : modules) {
      sum += one->emergencies.size();
    }
    return sum;
  }

  sim::Bus bus;
  std::vector<std::unique_ptr<ScriptedModule>> modules;  ///< modules by joint, then those that were added
  std::vector<Change> plan;
  std::vector<Change> changes;
  canopen::MasterOptions options;
  std::vector<sim::Transmission> transmissions;
  std::vector<canopen::Event> events;

 private:
  struct Setup {
    explicit Setup(unsigned joints) {
      setup.kernel = one_slot(algorithm(coupled), joints);
      setup.kernel.slots[1] = {&algorithm(sinusoidal), JointMask::first(joints)};
      for (unsigned joint = 0; joint < joints; ++joint) {
        nodes.push_back(static_cast<std::uint8_t>(joint * 2 + 3));
        limits.push_back({-(1 << 29), 1 << 29});
        starts.push_back({0, static_cast<std::uint8_t>(joint), 0, false, static_cast<std::int32_t>(joint) * 1000 + 7});
      }
      setup.nodes = nodes;
      setup.limits = limits;
      setup.start_values = starts;
    }
    std::vector<std::uint8_t> nodes;
    std::vector<AngleLimits> limits;
    std::vector<Setting> starts;
    canopen::RobotSetup setup;
  };

  void take_events() {
    while (const std::optional<canopen::Event> event = master().take_event()) {
      events.push_back(*event);
    }
  }

  Setup setup_;
  std::unique_ptr<MasterNode> master_;
  Microseconds now_ = 1'000;
};

}  // namespace proleg::test
