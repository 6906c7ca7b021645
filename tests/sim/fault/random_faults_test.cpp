#include "sim/fault/fault.hpp"

#include <gtest/gtest.h>

#include <map>
#include <stdexcept>

#include "sim/scenario/reader.hpp"
#include "tests/support/files.hpp"

namespace proleg::sim {
namespace {

Scenario caterpillar() {
  DiskFiles files;
  return read_scenario(source_path("/sim/scenarios/travelling_wave/uniform.simulation.xml"), files);
}

TEST(RandomFaults, FollowFromTheSeedAlone) {
  const Scenario scenario = caterpillar();
  EXPECT_EQ(random_faults({7, 5'000'000, true}, scenario), random_faults({7, 5'000'000, true}, scenario));
  EXPECT_NE(random_faults({7, 5'000'000, true}, scenario), random_faults({8, 5'000'000, true}, scenario));
}

TEST(RandomFaults, AreOfEveryKindAndAtEveryJoint) {
  const Scenario scenario = caterpillar();
  std::map<FaultKind, unsigned> kinds;
  std::map<unsigned, unsigned> joints;
  for (std::uint64_t seed = 0; seed < 1'000; ++seed) {
    for (const Fault& fault : random_faults({seed, 5'000'000, true}, scenario)) {
      ++kinds[fault.kind];
      if (fault.joint) {
        ++joints[*fault.joint];
      }
    }
  }
  EXPECT_EQ(kinds.size(), fault_declarations().size());
  EXPECT_EQ(joints.size(), scenario.robot.joints.size());
  for (const auto& [kind, count] : kinds) {
    EXPECT_GT(count, 50U) << declaration_of(kind).name;
  }
}

TEST(RandomFaults, AreOverTwoSecondsBeforeTheEnd) {
  const Scenario scenario = caterpillar();
  for (const std::uint64_t run_us : {min_random_run_us, std::uint64_t{5'000'000}, std::uint64_t{60'000'000}}) {
    for (std::uint64_t seed = 0; seed < 1'000; ++seed) {
      for (const Fault& fault : random_faults({seed, run_us, true}, scenario)) {
        EXPECT_LE(fault.start_us + fault.duration_us.value_or(0), run_us - rest_after_faults_us);
      }
    }
  }
}

TEST(RandomFaults, OfNativeModulesAreThoseThatTheyCanPlay) {
  const Scenario scenario = caterpillar();
  for (std::uint64_t seed = 0; seed < 1'000; ++seed) {
    for (const Fault& fault : random_faults({seed, 5'000'000, false}, scenario)) {
      EXPECT_FALSE(declaration_of(fault.kind).needs_chip);
    }
  }
}

TEST(RandomFaults, ThatActAtTicksBeginAndEndBetweenSyncs) {
  const Scenario scenario = caterpillar();
  const std::uint32_t tick_us = scenario.kernel.tick_period_us;
  for (std::uint64_t seed = 1; seed <= 500; ++seed) {
    SCOPED_TRACE(seed);
    RandomFaults settings;
    settings.seed = seed;
    settings.only_at_ticks = true;
    const FaultSchedule schedule = random_faults(settings, scenario);
    EXPECT_TRUE(act_at_ticks(schedule, tick_us));
    for (const Fault& fault : schedule) {
      for (const std::uint64_t time : {fault.start_us, fault.start_us + fault.duration_us.value_or(0)}) {
        EXPECT_GE(time % tick_us, 1'000U) << "a module reads its sensors";
        EXPECT_LE(time % tick_us, tick_us - 200U);
        EXPECT_LE(time + rest_after_faults_us, settings.run_us);
      }
    }
  }
}

TEST(RandomFaults, NeedARunWithRoomForThem) {
  EXPECT_THROW(static_cast<void>(random_faults({1, min_random_run_us - 1, false}, caterpillar())),
               std::invalid_argument);
}

}  // namespace
}  // namespace proleg::sim
