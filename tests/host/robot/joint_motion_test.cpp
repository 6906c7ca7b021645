// One joint of simulated modules moves, so that a person sees which one it is; then the modules get other node ids.

#include "host/robot/joint_motion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>

#include "host/robot/bus_user.hpp"
#include "live_bus.hpp"
#include "shared/computer/master/lss_master.hpp"
#include "shared/computer/master/lss_renumbering.hpp"
#include "shipped.hpp"

namespace proleg::test {
namespace {

namespace object = canopen::object;
using State = host::JointMotion::State;
constexpr std::int32_t degree = (1 << 30) / 90;
/// Steps of a pulse (1/12 us): 24000 are 180 degrees.
constexpr std::int32_t pulse_of_degrees(double degrees) {
  return static_cast<std::int32_t>(18'000 + degrees * 24'000 / 180);
}

/// Lets a machine work on the bus until it has ended; at most until the deadline.
template <typename Machine>
void work(LiveBus& bus, Machine& machine, Microseconds deadline) {
  host::MachineUser<Machine> user(machine);
  bus.attach(user);
  machine.start(bus.now());
  EXPECT_TRUE(bus.run_until(deadline, [&] { return machine.state() != Machine::State::working; }));
  bus.detach(user);
}

class Moving {
 public:
  Moving(LiveBus& bus, std::uint8_t node, const host::JointMotionOptions& options = {})
      : bus_(bus), motion(bus, node, options) {
    bus_.attach(motion);
    motion.start(bus_.now());
    bus_.run_until(bus_.now() + 20 * second,
                   [this] { return motion.state() == State::moving || motion.state() == State::failed; });
  }
  ~Moving() { bus_.detach(motion); }
  Moving(const Moving&) = delete;
  Moving& operator=(const Moving&) = delete;

  bool stop() {
    motion.stop(bus_.now());
    return bus_.run_until(bus_.now() + 10 * second, [this] { return motion.state() == State::stopped; });
  }
  /// The smallest and the largest pulse of a joint in some time; `has_others`: other joints had pulses.
  struct Range {
    std::int32_t lowest = 1 << 20;
    std::int32_t highest = 0;
    bool has_others = false;
  };
  Range watch(unsigned joint, Microseconds duration) {
    Range range;
    bus_.run_until(bus_.now() + duration, [&] {
      for (unsigned other = 0; other < bus_.robot().joint_count(); ++other) {
        const auto pulse = bus_.robot().module(other).pulse();
        if (pulse && other == joint) {
          range.lowest = std::min(range.lowest, *pulse);
          range.highest = std::max(range.highest, *pulse);
        }
        range.has_others = range.has_others || (pulse && other != joint);
      }
      return false;
    });
    return range;
  }

 private:
  LiveBus& bus_;

 public:
  host::JointMotion motion;
};

TEST(JointMotion, MovesTheJointOfThatModuleByThatAngleAndNoOther) {
  const sim::Scenario scenario = sim::shipped("travelling_wave/uniform");
  LiveBus bus(scenario);
  bus.run_for(100'000);
  for (unsigned joint = 0; joint < 5; ++joint) {
    SCOPED_TRACE(joint);
    Moving moving(bus, scenario.modules[joint].node);
    ASSERT_EQ(moving.motion.state(), State::moving) << describe(moving.motion.problem().code);
    const Moving::Range range = moving.watch(joint, 3 * second);
    EXPECT_NEAR(range.lowest, pulse_of_degrees(-5), 2);
    EXPECT_NEAR(range.highest, pulse_of_degrees(5), 2);
    EXPECT_FALSE(range.has_others);
    ASSERT_TRUE(moving.stop());
    bus.run_for(100'000);
    EXPECT_FALSE(bus.robot().module(joint).pulse().has_value());
  }
}

TEST(JointMotion, StaysWithinTheLimits) {
  const sim::Scenario scenario = sim::shipped("travelling_wave/uniform");
  LiveBus bus(scenario);
  bus.run_for(100'000);
  host::JointMotionOptions options;
  options.amplitude = 20 * degree;
  options.limits = {10 * degree, 40 * degree};
  Moving moving(bus, 2, options);
  ASSERT_EQ(moving.motion.state(), State::moving) << describe(moving.motion.problem().code);
  EXPECT_EQ(moving.motion.amplitude(), 15 * degree) << "half of the limits' distance";
  unsigned joint = 0;
  while (scenario.modules[joint].node != 2) {
    ++joint;
  }
  const Moving::Range range = moving.watch(joint, 3 * second);
  EXPECT_GE(range.lowest, pulse_of_degrees(10) - 1);
  EXPECT_LE(range.highest, pulse_of_degrees(40) + 1);
  EXPECT_GT(range.highest - range.lowest, pulse_of_degrees(28) - 18'000);
  EXPECT_TRUE(moving.stop());
}

TEST(JointMotion, ANodeThatIsNotThereIsNamedAndNothingMoves) {
  const sim::Scenario scenario = sim::shipped("travelling_wave/uniform");
  LiveBus bus(scenario);
  bus.run_for(100'000);
  Moving moving(bus, 42);
  EXPECT_EQ(moving.motion.state(), State::failed);
  EXPECT_EQ(moving.motion.problem().code, canopen::ProblemCode::no_answer);
  EXPECT_EQ(moving.motion.problem().node, 42);
  EXPECT_TRUE(moving.stop());
  for (unsigned joint = 0; joint < 5; ++joint) {
    EXPECT_FALSE(bus.robot().module(joint).pulse().has_value());
  }
}

TEST(JointMotion, TheJointStopsByItselfIfTheHostDies) {
  const sim::Scenario scenario = sim::shipped("travelling_wave/uniform");
  LiveBus bus(scenario);
  bus.run_for(100'000);
  {
    const Moving moving(bus, scenario.modules[1].node);
    ASSERT_EQ(moving.motion.state(), State::moving);
    bus.run_for(second);
  }
  bus.run_for(1'500'000);
  const auto before = bus.robot().module(1).pulse();
  bus.run_for(500'000);
  EXPECT_EQ(bus.robot().module(1).pulse(), before) << "it holds its safe pose";
}

TEST(JointMotion, AndTheModulesGetOtherNodeIdsAlthoughOneFrameInTwentyIsLost) {
  const sim::Scenario scenario = sim::shipped("travelling_wave/uniform");
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE(seed);
    std::vector<canopen::RenumberedModule> modules;
    sim::LiveRobotOptions options;
    options.change_identity = [&](unsigned joint, const firmware::ModuleIdentity& identity) {
      modules.push_back({{object::vendor.default_value, identity.board_id, object::revision.default_value,
                          firmware::serial_number(identity)},
                         scenario.modules[(joint + 2) % 5].node});
    };
    LiveBus bus(scenario, options);
    bus.run_for(100'000);
    ASSERT_EQ(modules.size(), 5U);
    bus.lose(0.05, seed);
    canopen::LssRenumbering renumbering(bus, modules);
    work(bus, renumbering, bus.now() + 60 * second);
    EXPECT_EQ(renumbering.state(), canopen::LssRenumbering::State::done) << describe(renumbering.problem());
    bus.lose(0, 0);
    const Moving moving(bus, scenario.modules[2].node);
    ASSERT_EQ(moving.motion.state(), State::moving);
    bus.run_for(100'000);
    EXPECT_TRUE(bus.robot().module(0).pulse().has_value()) << "joint 0 has the node id of joint 2";
  }
}

TEST(JointMotion, ThreeFreshModulesGetTheirNodeIdsInTwoSeconds) {
  const sim::Scenario scenario = sim::shipped("travelling_wave/uniform");
  sim::LiveRobotOptions options;
  options.change_identity = [](unsigned joint, firmware::ModuleIdentity& identity) {
    identity.node = joint < 3 ? 0 : identity.node;
  };
  LiveBus bus(scenario, options);
  bus.run_for(100'000);
  std::vector<canopen::LssModule> modules{{1}, {2}, {3}};
  canopen::LssMaster master(bus, modules);
  const Microseconds begin = bus.now();
  work(bus, master, begin + 2 * second);
  EXPECT_EQ(master.assigned(), 3U);
  std::cout << "three fresh modules: " << static_cast<double>(bus.now() - begin) * 1e-6 << " s\n";
}

}  // namespace
}  // namespace proleg::test
