#include "tools/proleg/robot/gait_run.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shipped.hpp"
#include "sim/hardware_loop/master_input.hpp"
#include "sim/scenario/settings.hpp"

namespace proleg::tools {
namespace {

constexpr std::uint32_t soon = Change::soon;
constexpr std::uint32_t run_end = 10'000;

/// The changes of a robot with a tick of 10 ms: 3 s are 300 ticks.
class LiveChangesTest : public ::testing::Test {
 protected:
  static sim::Scenario planned(const std::vector<std::string>& words) {
    sim::Scenario scenario = sim::shipped("travelling_wave/uniform");
    for (const std::string& word : words) {
      sim::apply_setting(scenario, word);
    }
    return scenario;
  }
  static std::vector<std::uint32_t> ticks(LiveChanges& changes) {
    std::vector<std::uint32_t> ticks;
    for (const Change& change : changes.span()) {
      ticks.push_back(change.tick);
    }
    return ticks;
  }

  using Ticks = std::vector<std::uint32_t>;
};

TEST_F(LiveChangesTest, TheMasterGetsAPlannedChangeThreeSecondsBeforeItsTick) {
  const sim::Scenario scenario = planned({"amplitude=30@100", "frequency=0.7@6000"});
  LiveChanges changes(scenario, sim::MasterInput(scenario).changes);
  EXPECT_EQ(ticks(changes), Ticks({100}));
  EXPECT_FALSE(changes.release(5'699));
  EXPECT_TRUE(changes.release(5'700));
  EXPECT_EQ(ticks(changes), Ticks({100, 6'000}));
  EXPECT_FALSE(changes.release(5'700));
}

TEST_F(LiveChangesTest, OneWithoutATickDoesNotWaitForAPlannedOne) {
  const sim::Scenario scenario = planned({"frequency=0.7@6000"});
  const sim::MasterInput input(scenario);
  LiveChanges changes(scenario, input.changes);
  EXPECT_TRUE(changes.add("amplitude=30", 500, run_end));
  EXPECT_EQ(ticks(changes), Ticks({soon}));
  changes.span()[0].tick = 523;  // as the master decides
  const auto decided = changes.take_decided(600);
  ASSERT_EQ(decided.size(), 1U);
  EXPECT_EQ(decided[0].tick, 523U);
}

TEST_F(LiveChangesTest, ATypedChangeWithATickFindsItsPlace) {
  const sim::Scenario scenario = planned({"frequency=0.7@6000"});
  const sim::MasterInput input(scenario);
  LiveChanges changes(scenario, input.changes);
  EXPECT_FALSE(changes.add("amplitude=30@3000", 500, run_end));
  EXPECT_TRUE(changes.add("amplitude=35@600", 500, run_end));
  EXPECT_TRUE(changes.release(2'700));
  EXPECT_TRUE(changes.release(5'700));
  EXPECT_EQ(ticks(changes), Ticks({600, 3'000, 6'000}));
  EXPECT_THROW(static_cast<void>(changes.add("amplitude=30@5000", 5'000, run_end)), InputError);
}

TEST_F(LiveChangesTest, ATickHasOneChange) {
  const sim::Scenario scenario = planned({"frequency=0.7@6000"});
  const sim::MasterInput input(scenario);
  LiveChanges changes(scenario, input.changes);
  EXPECT_THROW(static_cast<void>(changes.add("amplitude=30@6000", 500, run_end)), InputError);
}

TEST_F(LiveChangesTest, APlannedChangeWaitsUntilTheTickOfTheOneBeforeItIsDecided) {
  const sim::Scenario scenario = planned({"frequency=0.7@6000"});
  const sim::MasterInput input(scenario);
  LiveChanges changes(scenario, input.changes);
  EXPECT_TRUE(changes.add("amplitude=30", 5'690, run_end));
  EXPECT_FALSE(changes.release(5'700));
  changes.span()[0].tick = 5'999;
  EXPECT_TRUE(changes.release(5'800));
  EXPECT_EQ(ticks(changes), Ticks({5'999, 6'000}));
}

TEST_F(LiveChangesTest, APlannedChangeWhoseTickHasPassedMeanwhileCountsAsDropped) {
  const sim::Scenario scenario = planned({"frequency=0.7@6000", "frequency=0.8@6100"});
  const sim::MasterInput input(scenario);
  LiveChanges changes(scenario, input.changes);
  EXPECT_TRUE(changes.add("amplitude=30", 5'690, run_end));
  changes.span()[0].tick = 6'000;
  EXPECT_TRUE(changes.release(5'990));
  EXPECT_EQ(ticks(changes), Ticks({6'000, 6'100}));
  EXPECT_EQ(changes.dropped(), 1U);
}

TEST_F(LiveChangesTest, OneWithoutATickThatTheEndOfTheRunOvertakesIsUnfinished) {
  const sim::Scenario scenario = planned({"frequency=0.7@6000"});
  const sim::MasterInput input(scenario);
  LiveChanges changes(scenario, input.changes);
  EXPECT_TRUE(changes.add("amplitude=30", 500, run_end));
  EXPECT_TRUE(changes.add("amplitude=40", 510, run_end));
  EXPECT_TRUE(changes.add("amplitude=50", 520, run_end));
  EXPECT_EQ(changes.unfinished(), 3U);
  changes.span()[0].tick = 523;
  changes.span()[1].tick = 540;
  EXPECT_EQ(changes.take_decided(530).size(), 1U);
  EXPECT_EQ(changes.unfinished(), 2U);
  changes.span()[1].dropped = true;
  EXPECT_EQ(changes.unfinished(), 1U) << "the master has reported the other one";
  changes.remove_last();
  EXPECT_EQ(changes.unfinished(), 0U) << "the planned change does not count: the user has ended the run";
}

TEST_F(LiveChangesTest, ATickBehindTheEndOfTheRunIsRefused) {
  const sim::Scenario scenario = planned({});
  LiveChanges changes(scenario, {});
  EXPECT_FALSE(changes.add("amplitude=30@9999", 500, run_end));
  EXPECT_THROW(static_cast<void>(changes.add("amplitude=30@10000", 500, run_end)), InputError);
}

/// A bus whose connection can be lost; nothing is received from it.
class LosableBus final : public host::Transport {
 public:
  [[nodiscard]] Microseconds now() const override { return now_; }
  [[nodiscard]] bool send(const CanFrame& /*frame*/) override { return state_.is_connected; }
  void run_until(Microseconds deadline) override { now_ = std::max(now_, deadline); }
  [[nodiscard]] const host::BusState& state() const override { return state_; }
  [[nodiscard]] host::Statistics statistics() const override { return {}; }
  [[nodiscard]] std::string description() const override { return "a bus that can be lost"; }

  void set_connected(bool is_connected) { state_.is_connected = is_connected; }

 private:
  Microseconds now_ = 0;
  host::BusState state_;
};

/// Seconds after which a stop ends, of which nothing is heard. connection: of each second, whether there is one.
int seconds_to_stop(const std::vector<bool>& connection) {
  const sim::Scenario scenario = sim::shipped("travelling_wave/uniform");
  LosableBus* transport = nullptr;
  host::BusConnection bus([&](host::TransportListener& /*listener*/) {
    auto made = std::make_unique<LosableBus>();
    transport = made.get();
    return made;
  });
  GaitRun gait(scenario, bus, {.end_tick = run_end});
  gait.stop();
  for (std::size_t second = 0; second < connection.size(); ++second) {
    transport->set_connected(connection[second]);
    if (gait.has_stopped()) {
      return static_cast<int>(second);
    }
    bus.run_until(bus.now() + 1'000'000, [] { return false; });
  }
  return -1;
}

TEST(GaitRun, AStopEndsSoonAfterTheConnectionIsLost) {
  EXPECT_EQ(seconds_to_stop(std::vector<bool>(30, true)), 20);
  EXPECT_EQ(seconds_to_stop(std::vector<bool>(30, false)), 2);
  std::vector<bool> lost_later(30, false);
  std::fill_n(lost_later.begin(), 5, true);
  EXPECT_EQ(seconds_to_stop(lost_later), 7);
}

}  // namespace
}  // namespace proleg::tools
