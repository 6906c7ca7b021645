// A simulated robot without a host of its own: a program outside sends frames, and the world moves on by itself.

#include "sim/live/live_robot.hpp"

#include <gtest/gtest.h>

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "gateway_bench.hpp"
#include "shared/computer/master/master.hpp"
#include "shared/kernel/fingerprint.hpp"
#include "shipped.hpp"
#include "sim/fault/fault.hpp"
#include "sim/hardware_loop/master_input.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/scenario/reader.hpp"

namespace proleg::sim {
namespace {

constexpr BusTime millisecond = 1'000'000;
constexpr BusTime second = 1'000 * millisecond;

/// A host program outside of the simulation: the master, with the clock of the bus.
class OutsideHost final : private CanPort {
 public:
  explicit OutsideHost(const Scenario& scenario, LiveRobotOptions options = {})
      : input_(scenario), robot_(scenario, with_callbacks(std::move(options))) {
    replace();
  }

  /// Another program takes its place.
  void replace() { emplace(master_, *this); }

  LiveRobot& robot() { return robot_; }
  canopen::Master& master() { return *master_; }
  [[nodiscard]] const std::vector<CanFrame>& received() const { return received_; }

  void start() { master_->start(robot_.now() / 1'000); }
  void stop() { master_->stop(robot_.now() / 1'000); }

  void run_to(BusTime end) {
    while (robot_.now() < end) {
      const Microseconds deadline =
          std::min(master_->next_deadline(), second_ != nullptr ? second_->next_deadline() : never);
      const BusTime wake = deadline == never ? never_on_bus : deadline * 1'000;
      robot_.advance_to(std::min({std::max(robot_.next_event(), robot_.now()), wake, end}));
      for (const Event& event : std::exchange(events_, {})) {
        event.is_own ? master_->transmitted(event.time / 1'000, event.frame)
                     : master_->receive(event.time / 1'000, event.frame);
        if (second_ != nullptr) {
          second_->receive(event.time / 1'000, event.frame);
        }
      }
      for (canopen::Master* master : {&*master_, second_}) {
        if (master != nullptr && master->next_deadline() <= robot_.now() / 1'000) {
          master->poll(robot_.now() / 1'000);
        }
      }
    }
  }
  bool run_until_running() {
    while (master_->state() != canopen::MasterState::running && master_->state() != canopen::MasterState::failed &&
           robot_.now() < 20 * second) {
      run_to(robot_.now() + millisecond);
    }
    return master_->state() == canopen::MasterState::running;
  }
  bool send(const CanFrame& frame) override { return robot_.send(frame); }

  /// Another host, which hears the first one and the modules. What it would send is counted only.
  class Second final : private CanPort {
   public:
    explicit Second(OutsideHost& first) : first_(first) {
      first_.emplace(master_, *this);
      first_.second_ = &*master_;
    }
    Second(const Second&) = delete;
    Second& operator=(const Second&) = delete;
    ~Second() { first_.second_ = nullptr; }
    void start() { master_->start(first_.robot_.now() / 1'000); }
    canopen::Master& master() { return *master_; }
    [[nodiscard]] unsigned sent() const { return sent_; }

   private:
    bool send(const CanFrame& /*frame*/) override {
      ++sent_;
      return true;
    }
    OutsideHost& first_;
    std::optional<canopen::Master> master_;
    unsigned sent_ = 0;
  };

 private:
  struct Event {
    BusTime time;
    CanFrame frame;
    bool is_own;
  };
  LiveRobotOptions with_callbacks(LiveRobotOptions options) {
    options.on_frame = [this](const Transmission& transmission, bool is_own) {
      if (!is_own) {
        received_.push_back(transmission.frame);
        events_.push_back({transmission.end, transmission.frame, false});
      }
    };
    options.on_sent = [this](BusTime time, const CanFrame& frame, std::uint32_t /*source*/) {
      events_.push_back({time, frame, true});
    };
    return options;
  }

  void emplace(std::optional<canopen::Master>& master, CanPort& port) {
    const canopen::MasterOptions options{
        .core_fingerprint = core_fingerprint, .resets_modules = true, .ramps_down = true};
    master.emplace(port, input_.setup, options, input_.changes);
  }

  MasterInput input_;
  std::optional<canopen::Master> master_;
  canopen::Master* second_ = nullptr;
  std::vector<CanFrame> received_;
  std::vector<Event> events_;
  LiveRobot robot_;
};

CanFrame frame(const char* text) { return parse_frame(text).value(); }

TEST(LiveRobot, AnswersAnyProgramAsTheModulesDo) {
  const Scenario scenario = shipped("travelling_wave/uniform");
  OutsideHost host(scenario);
  host.run_to(100 * millisecond);
  ASSERT_TRUE(host.send(frame("603#4000100000000000")));
  host.run_to(110 * millisecond);
  ASSERT_FALSE(host.received().empty());
  EXPECT_EQ(host.received().back(), frame("583#4300100092010200"));
}

TEST(LiveRobot, BootsEveryModuleAndDoesNotMoveByItself) {
  const Scenario scenario = shipped("travelling_wave/uniform");
  OutsideHost host(scenario);
  host.run_to(second);
  std::map<unsigned, unsigned> boots;
  for (const CanFrame& one : host.received()) {
    EXPECT_EQ(one.identifier & 0x780U, 0x700U);
    ++boots[one.identifier & 0x7FU];
  }
  EXPECT_EQ(boots.size(), 5U);
  for (unsigned joint = 0; joint < 5; ++joint) {
    EXPECT_FALSE(host.robot().module(joint).pulse().has_value());
  }
  EXPECT_EQ(host.robot().ticks(), 100U) << "the world moves on without SYNC";
}

TEST(LiveRobot, ComputesUnderAHostOutsideTheSetpointsOfTheSimulation) {
  const Scenario scenario = shipped("travelling_wave/uniform");
  OutsideHost host(scenario);
  host.run_to(777 * millisecond + 123);  // any phase
  host.start();
  ASSERT_TRUE(host.run_until_running());
  Simulation simulation(scenario);
  for (std::uint32_t tick = 0; tick < 500; ++tick) {
    simulation.advance();
    const TickSample sample = simulation.sample();
    while (host.master().tick().value_or(0) < tick + 1 && host.robot().now() < 30 * second) {
      host.run_to(host.robot().now() + millisecond / 2);
    }
    for (unsigned joint = 0; joint < 5; ++joint) {
      const firmware::TickRecord record = host.robot().module(joint).last_tick();
      if (record.tick == tick) {
        ASSERT_EQ(record.setpoint, sample.setpoints[joint]) << "tick " << tick << ", joint " << joint;
      } else {
        ASSERT_EQ(record.tick, tick + 1);
      }
    }
  }
  EXPECT_GT(host.robot().plant().displacement(), 0.1) << "it crawls";
}

TEST(LiveRobot, MovesOnWithoutSyncAndRampsToItsSafePoseWhenItsHostLeaves) {
  const Scenario scenario = shipped("travelling_wave/uniform");
  OutsideHost host(scenario);
  host.start();
  ASSERT_TRUE(host.run_until_running());
  host.run_to(host.robot().now() + second);
  // The host is gone: no heartbeat any more.
  const BusTime gone = host.robot().now();
  host.robot().advance_to(gone + 1'500 * millisecond);
  for (unsigned joint = 0; joint < 5; ++joint) {
    EXPECT_EQ(host.robot().module(joint).power(), canopen::PowerState::quick_stop_active);
    EXPECT_EQ(host.robot().module(joint).pulse(), 18'000);
  }
  host.robot().advance_to(gone + 2 * second);
  for (const double angle : host.robot().plant().joint_angles()) {
    EXPECT_NEAR(angle, 0.0, 0.1) << "rad: the servos of the simulated robot followed the ramp";
  }
}

TEST(LiveRobot, StopsWithARampAndThenWithoutPower) {
  const Scenario scenario = shipped("travelling_wave/uniform");
  OutsideHost host(scenario);
  host.start();
  ASSERT_TRUE(host.run_until_running());
  host.run_to(host.robot().now() + second);
  host.stop();
  host.run_to(host.robot().now() + 1'100 * millisecond);
  for (unsigned joint = 0; joint < 5; ++joint) {
    EXPECT_EQ(host.robot().module(joint).power(), canopen::PowerState::quick_stop_active);
  }
  host.run_to(host.robot().now() + 300 * millisecond);
  EXPECT_EQ(host.master().state(), canopen::MasterState::stopped);
  for (unsigned joint = 0; joint < 5; ++joint) {
    EXPECT_EQ(host.robot().module(joint).power(), canopen::PowerState::switch_on_disabled);
    EXPECT_FALSE(host.robot().module(joint).pulse().has_value());
  }
}

TEST(LiveRobot, IsTakenOverByTheNextHostInWhateverStateItIs) {
  const Scenario scenario = shipped("travelling_wave/uniform");
  OutsideHost host(scenario);
  host.start();
  ASSERT_TRUE(host.run_until_running());
  host.run_to(host.robot().now() + second);

  host.replace();  // the first one was killed
  host.start();
  ASSERT_TRUE(host.run_until_running()) << describe(host.master().problem().code);
  host.run_to(host.robot().now() + second);
  EXPECT_EQ(host.master().state(), canopen::MasterState::running);
  EXPECT_NEAR(host.robot().module(0).last_tick().tick, 100.0, 2.0) << "the gait begins at tick 0 again";
}

TEST(LiveRobot, RefusesASecondHostWhileTheFirstOneDrives) {
  const Scenario scenario = shipped("travelling_wave/uniform");
  OutsideHost host(scenario);
  host.start();
  ASSERT_TRUE(host.run_until_running());
  const BusTime begin = host.robot().now();
  OutsideHost::Second second_host(host);
  second_host.start();
  host.run_to(begin + second);
  EXPECT_EQ(second_host.master().state(), canopen::MasterState::failed);
  EXPECT_EQ(second_host.master().problem().code, canopen::ProblemCode::other_host);
  EXPECT_EQ(host.master().state(), canopen::MasterState::running);
  second_host.master().stop(host.robot().now() / 1'000);
  host.run_to(begin + 2 * second);
  EXPECT_EQ(second_host.master().state(), canopen::MasterState::stopped);
  EXPECT_EQ(second_host.sent(), 0U) << "it only listened";
}

TEST(LiveRobot, RefusesFramesWhenTooManyWait) {
  const Scenario scenario = shipped("travelling_wave/uniform");
  OutsideHost host(scenario);
  host.run_to(100 * millisecond);
  unsigned taken = 0;
  while (host.send(frame("7FF#00"))) {
    ++taken;
  }
  EXPECT_EQ(taken, LiveRobot::max_waiting);
  host.run_to(400 * millisecond);
  EXPECT_EQ(host.robot().waiting(), 0U) << "all of them were sent";
}

TEST(LiveRobot, ThatLiesStillStaysAsItIsWhileItsTimeGoesOn) {
  const Scenario scenario = shipped("travelling_wave/uniform");
  LiveRobot robot(scenario, {});
  robot.advance_to(2 * second);
  const Eigen::Vector3d before = robot.plant().world().center_of_mass();
  const double force = robot.plant().world().contact_force(2);
  const std::uint32_t ticks = robot.ticks();
  robot.advance_to(4 * second);
  EXPECT_EQ(robot.plant().world().center_of_mass(), before) << "to the last bit: no step was made";
  EXPECT_EQ(robot.plant().world().contact_force(2), force);
  EXPECT_GT(force, 0.0);
  EXPECT_NEAR(robot.ticks() - ticks, 200, 1);
}

TEST(LiveRobot, ThatFallsDoesNotRest) {
  Scenario scenario = shipped("travelling_wave/uniform");
  scenario.environment.robot_pose.position.z() += 0.5;
  LiveRobot robot(scenario, {});
  const double start = robot.plant().world().center_of_mass().z();
  robot.advance_to(200 * millisecond);
  EXPECT_NEAR(start - robot.plant().world().center_of_mass().z(), 0.5 * 9.81 * 0.2 * 0.2, 0.01);
}

// 0x1000 of a module: 0x00020192 (docs/objects.md). The gateway is node 3 of the caterpillar.
TEST(LiveRobot, AHostOnTheSerialLineOfAModuleReachesItAndTheOthers) {
  const Scenario scenario = shipped("travelling_wave/coupled");
  ScriptedHost host;
  LiveRobotOptions options;
  options.gateway = {2, &host};
  LiveRobot robot(scenario, std::move(options));
  robot.advance_to(100 * millisecond);
  const auto ask = [&](std::string_view text) {
    static_cast<void>(host.take_text());
    host.sender.send(robot.now() + millisecond, text);
    robot.advance_to(robot.now() + 10 * millisecond);
    return host.take_text();
  };
  EXPECT_EQ(ask("\r\rC\rS8\rO\r"), "\r\r\r");
  ASSERT_EQ(scenario.modules[2].node, 3);
  EXPECT_EQ(ask("t60384000100000000000\r"), "z\rt58384300100092010200\r");
  EXPECT_EQ(ask("t60484000100000000000\r"), "z\rt58484300100092010200\r");
}

}  // namespace
}  // namespace proleg::sim
