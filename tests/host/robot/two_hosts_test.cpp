// Two hosts, each with an adapter of its own, start to drive one robot: exactly one of them gets it.

#include <gtest/gtest.h>

#include <iostream>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "driving_host.hpp"
#include "shipped.hpp"
#include "sim/loop/gait.hpp"

namespace proleg::test {
namespace {

using canopen::MasterState;

/// The bus of two hosts: each receives what the other sends.
class SharedBus {
 public:
  explicit SharedBus(const sim::Scenario& scenario) : robot_(scenario, options()) {}

  class Adapter final : public CanPort {
   public:
    Adapter(SharedBus& bus, std::uint32_t number) : bus_(bus), number_(number) {}
    bool send(const CanFrame& frame) override {
      sent_ += 1;
      return bus_.robot_.send(frame, number_);
    }
    [[nodiscard]] unsigned sent() const { return sent_; }

   private:
    SharedBus& bus_;
    std::uint32_t number_;
    unsigned sent_ = 0;
  };

  Adapter& adapter(unsigned number) { return adapters_[number]; }
  void attach(unsigned number, host::BusUser& user) { users_[number] = &user; }
  [[nodiscard]] Microseconds now() const { return robot_.now() / 1'000; }
  sim::LiveRobot& robot() { return robot_; }

  void run_until(Microseconds end) {
    while (now() < end) {
      Microseconds wake = end;
      for (host::BusUser* user : users_) {
        if (user != nullptr && user->next_deadline() <= now()) {
          user->poll(now());
        }
        wake = user != nullptr ? std::min(wake, user->next_deadline()) : wake;
      }
      if (events_.empty()) {
        robot_.advance_to(std::min(robot_.next_event(), std::max(wake, now() + 1) * 1'000));
      }
      for (const Event& event : std::exchange(events_, {})) {
        for (unsigned number = 0; number < users_.size(); ++number) {
          if (users_[number] == nullptr) {
            continue;
          }
          number == event.source ? users_[number]->transmitted(event.time, event.frame)
                                 : users_[number]->receive(event.time, event.frame);
        }
      }
    }
  }

 private:
  static constexpr std::uint32_t a_module = 99;
  struct Event {
    Microseconds time;
    CanFrame frame;
    std::uint32_t source;
  };
  sim::LiveRobotOptions options() {
    sim::LiveRobotOptions options;
    options.on_frame = [this](const sim::Transmission& transmission, bool is_own) {
      if (!is_own) {
        events_.push_back({transmission.end / 1'000, transmission.frame, a_module});
      }
    };
    options.on_sent = [this](sim::BusTime time, const CanFrame& frame, std::uint32_t source) {
      events_.push_back({time / 1'000, frame, source});
    };
    return options;
  }

  std::vector<Event> events_;
  std::vector<Adapter> adapters_{{*this, 0}, {*this, 1}};
  std::vector<host::BusUser*> users_{nullptr, nullptr};
  sim::LiveRobot robot_;
};

class Host {
 public:
  Host(SharedBus& bus, unsigned number, const sim::Scenario& scenario) : bus_(bus), input_(scenario) {
    canopen::MasterOptions options = host_options();
    options.session_token = 0x1000 + number;
    drive_ = std::make_unique<host::RobotDrive>(bus.adapter(number), input_.setup, options, input_.changes);
    bus.attach(number, *drive_);
  }
  void start() { master().start(bus_.now()); }
  [[nodiscard]] canopen::Master& master() { return drive_->master(); }
  [[nodiscard]] host::RobotDrive& drive() { return *drive_; }
  [[nodiscard]] bool runs() { return master().state() == MasterState::running; }
  /// It has left without having changed anything.
  [[nodiscard]] bool has_left() {
    const canopen::ProblemCode code = master().problem().code;
    return master().state() == MasterState::failed &&
           (code == canopen::ProblemCode::other_host || code == canopen::ProblemCode::lease_refused);
  }
  void stop() { master().stop(bus_.now()); }

 private:
  SharedBus& bus_;
  sim::MasterInput input_;
  std::unique_ptr<host::RobotDrive> drive_;
};

/// Whether the modules have computed the gait of this process, as far as the host has seen.
void expect_the_gait(host::RobotDrive& drive, const sim::Scenario& scenario) {
  sim::KernelChain chain(scenario.kernel, scenario.joint_limits, scenario.settings);
  const std::vector<std::uint8_t> no_contacts(5);
  unsigned compared = 0;
  while (const auto tick = drive.take_tick()) {
    chain.advance(no_contacts);
    for (unsigned joint = 0; joint < 5; ++joint) {
      ASSERT_TRUE(tick->frames[joint][0].has_value());
      const StateFrame& gait = chain.kernel(joint).frame(joint, 0);
      ASSERT_TRUE(std::equal(gait.bytes.begin(), gait.bytes.begin() + StateFrame::payload_size,
                             tick->frames[joint][0]->bytes.begin()));
      ++compared;
    }
  }
  EXPECT_GT(compared, 100U);
}

TEST(TwoHosts, ExactlyOneGetsTheRobotWheneverTheyStart) {
  const sim::Scenario scenario = sim::shipped("travelling_wave/uniform");
  constexpr std::uint32_t seed = 5;
  std::cout << "seed " << seed << "\n";
  std::mt19937 random(seed);
  // Close together, and up to 400 ms apart.
  for (unsigned run = 0; run < 24; ++run) {
    const Microseconds most = run < 4 ? 0 : run < 14 ? 4'000 : 400'000;
    const Microseconds offset = std::uniform_int_distribution<Microseconds>(0, most)(random);
    const unsigned first = random() % 2;
    SCOPED_TRACE("run " + std::to_string(run) + ", " + std::to_string(offset) + " us");
    SharedBus bus(scenario);
    bus.run_until(100'000);
    Host hosts[] = {{bus, 0, scenario}, {bus, 1, scenario}};
    hosts[first].start();
    bus.run_until(bus.now() + offset);
    hosts[1 - first].start();
    for (unsigned i = 0; i < 100 && !hosts[0].runs() && !hosts[1].runs(); ++i) {
      bus.run_until(bus.now() + second / 10);
      for (Host& host : hosts) {
        if (host.has_left()) {
          host.stop();
        }
      }
    }
    bus.run_until(bus.now() + second / 3);
    ASSERT_NE(hosts[0].runs(), hosts[1].runs())
        << describe(hosts[0].master().problem().code) << ", " << describe(hosts[1].master().problem().code);
    Host& winner = hosts[hosts[0].runs() ? 0 : 1];
    Host& other = hosts[hosts[0].runs() ? 1 : 0];
    EXPECT_EQ(other.master().state(), MasterState::stopped);
    EXPECT_LE(bus.adapter(hosts[0].runs() ? 1 : 0).sent(), 30U) << "requests for leases, and nothing else";
    expect_the_gait(winner.drive(), scenario);
  }
}

TEST(TwoHosts, TheSecondLeavesARobotThatMovesAsItIs) {
  const sim::Scenario scenario = sim::shipped("travelling_wave/uniform");
  SharedBus bus(scenario);
  bus.run_until(100'000);
  Host first(bus, 0, scenario);
  first.start();
  for (unsigned i = 0; i < 100 && !first.runs(); ++i) {
    bus.run_until(bus.now() + second / 10);
  }
  ASSERT_TRUE(first.runs());
  Host second_host(bus, 1, scenario);
  second_host.start();
  bus.run_until(bus.now() + second / 2);
  EXPECT_TRUE(second_host.has_left());
  EXPECT_EQ(bus.adapter(1).sent(), 0U);
  EXPECT_TRUE(first.runs());
  expect_the_gait(first.drive(), scenario);
}

TEST(TwoHosts, ARobotWhoseHostDiedIsFreeHalfASecondLater) {
  const sim::Scenario scenario = sim::shipped("travelling_wave/uniform");
  SharedBus bus(scenario);
  bus.run_until(100'000);
  auto first = std::make_unique<Host>(bus, 0, scenario);
  first->start();
  for (unsigned i = 0; i < 100 && !first->runs(); ++i) {
    bus.run_until(bus.now() + second / 10);
  }
  ASSERT_TRUE(first->runs());
  // It dies: nothing of it is sent any more.
  class Absent final : public host::BusUser {
    void receive(Microseconds /*now*/, const CanFrame& /*frame*/) override {}
  } absent;
  bus.attach(0, absent);
  Host heir(bus, 1, scenario);
  heir.start();
  for (unsigned i = 0; i < 100 && !heir.runs(); ++i) {
    ASSERT_NE(heir.master().state(), MasterState::failed) << describe(heir.master().problem().code);
    bus.run_until(bus.now() + second / 10);
  }
  EXPECT_TRUE(heir.runs()) << "it waits until the lease has ended";
}

}  // namespace
}  // namespace proleg::test
