// The master while the robot runs: changes in flight, modules that restart or are silent, the end.

#include <gtest/gtest.h>

#include <set>

#include "scripted_robot.hpp"
#include "shared/canopen/power_state.hpp"

namespace proleg::test {
namespace {

using namespace canopen;

/// Parameter `number` of slot 0 for joints 0 to count - 1.
std::vector<Setting> for_all(unsigned joints, std::uint8_t number, std::int32_t value) {
  std::vector<Setting> values;
  for (unsigned joint = 0; joint < joints; ++joint) {
    values.push_back({0, static_cast<std::uint8_t>(joint), number, false, value + static_cast<std::int32_t>(joint)});
  }
  return values;
}

Address in_force(std::uint8_t number, bool internal = false, std::uint8_t slot = 0) {
  const std::uint8_t id = algorithm(slot == 0 ? coupled : sinusoidal).declaration().id;
  return address_of({internal ? ValueKind::internal_value : ValueKind::parameter, id, number, slot});
}

std::uint32_t value_of(ScriptedRobot& robot, unsigned joint, std::uint8_t number) {
  return robot.module(joint).value(in_force(number));
}

/// The values that must take effect in a module by the plan.
std::vector<ScriptedModule::Effect> planned_effects(const ScriptedRobot& robot, unsigned joint) {
  std::vector<ScriptedModule::Effect> effects;
  for (std::size_t i = 0; i < robot.plan.size(); ++i) {
    for (const Setting& value : robot.plan[i].settings) {
      if (value.joint == joint && !robot.changes[i].dropped) {
        effects.push_back({robot.plan[i].tick, in_force(value.number, value.internal, value.slot), value.value});
      }
    }
  }
  return effects;
}

/// Checks each COMMIT on the bus: its number of repetitions, and the ticks from the SYNC before it until it takes
/// effect.
void check_commits(const ScriptedRobot& robot, std::uint32_t lead) {
  std::map<std::uint16_t, unsigned> copies;
  std::optional<std::uint32_t> tick;
  for (const sim::Transmission& transmission : robot.transmissions) {
    if (decode_sync(transmission.frame)) {
      tick = tick ? *tick + 1 : 0;
    }
    if (const auto commit = decode_commit(transmission.frame)) {
      ++copies[commit->transaction];
      EXPECT_GE(commit->tick, tick ? *tick + lead : 0) << commit->transaction;
      EXPECT_EQ(commit->tick, robot.changes[commit->transaction - 1U].tick);
      EXPECT_EQ(commit->robot, 1);
    }
  }
  for (const auto& [transaction, count] : copies) {
    EXPECT_EQ(count, 3U) << transaction;
  }
}

TEST(MasterChanges, ThoseThatFitAreCommittedBeforeTheStart) {
  std::vector<Change> plan;
  for (std::uint32_t i = 0; i < 35; ++i) {
    plan.push_back({i * 10, for_all(3, 0, static_cast<std::int32_t>(i))});
  }
  ScriptedRobot robot(3, plan);
  robot.start();
  ASSERT_TRUE(robot.run_until([&] { return robot.master().state() == MasterState::starting; }, 5'000'000));
  EXPECT_EQ(robot.master().changes_made(), 31U);
  for (unsigned joint = 0; joint < 3; ++joint) {
    ASSERT_EQ(robot.module(joint).committed().size(), 31U);
    EXPECT_EQ(robot.module(joint).committed()[30].number, 31);
    EXPECT_EQ(robot.module(joint).committed()[30].tick, 300U);
  }
  ASSERT_TRUE(robot.run_until_running());
  ASSERT_TRUE(robot.run_to_tick(400));
  for (unsigned joint = 0; joint < 3; ++joint) {
    EXPECT_EQ(robot.module(joint).effects, planned_effects(robot, joint));
  }
  EXPECT_EQ(robot.emergencies(), 0U);
  EXPECT_EQ(robot.master().problem().code, ProblemCode::none);
  check_commits(robot, 20);
}

TEST(MasterChanges, EveryModuleTakesPartAlsoWithoutValuesOfItsOwn) {
  ScriptedRobot robot(4, {{30, {{1, 2, 0, false, 77}}}});
  robot.start();
  ASSERT_TRUE(robot.run_until([&] { return robot.master().state() == MasterState::starting; }, 5'000'000));
  for (unsigned joint = 0; joint < 4; ++joint) {
    ASSERT_EQ(robot.module(joint).committed().size(), 1U);
    EXPECT_EQ(robot.module(joint).committed()[0].values.size(), joint == 2 ? 1U : 0U);
  }
}

TEST(MasterChanges, RandomChangesComeIntoForceInEveryModuleAtTheirTick) {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    const auto joints = static_cast<unsigned>(1 + random() % 6);
    std::vector<Change> plan;
    std::uint32_t tick = 0;
    for (int i = 0; i < 40; ++i) {
      plan.push_back({tick, {}});
      std::map<std::pair<unsigned, unsigned>, bool> seen;
      for (std::uint64_t n = random() % 12; n-- > 0;) {
        const auto joint = static_cast<std::uint8_t>(random() % joints);
        const bool internal = random() % 4 == 0;
        const auto number = static_cast<std::uint8_t>(random() % 3);
        if (seen.insert({{joint, number + (internal ? 8U : 0U)}, true}).second) {
          plan.back().settings.push_back({0, joint, number, internal, static_cast<std::int32_t>(random() % 1000)});
        }
      }
      tick += static_cast<std::uint32_t>(4 + random() % 12);
    }
    ScriptedRobot robot(joints, plan);
    robot.start();
    ASSERT_TRUE(robot.run_until_running());
    ASSERT_TRUE(robot.run_to_tick(tick + 5));
    EXPECT_EQ(robot.master().changes_made(), plan.size());
    EXPECT_EQ(robot.master().problem().code, ProblemCode::none);
    for (unsigned joint = 0; joint < joints; ++joint) {
      EXPECT_EQ(robot.module(joint).effects, planned_effects(robot, joint));
    }
    EXPECT_EQ(robot.emergencies(), 0U);
    check_commits(robot, 20);
  }
}

TEST(MasterChanges, AModuleNeverHasMoreValuesStagedThanItHasRoomFor) {
  std::vector<Change> plan;
  for (std::uint32_t i = 0; i < 10; ++i) {  // 20 values of joint 0 in each: six changes fill its 128 places
    plan.push_back({60 + i * 30, {}});
    for (std::uint8_t n = 0; n < 20; ++n) {
      plan.back().settings.push_back({0, 0, static_cast<std::uint8_t>(n % 5), false, n});
    }
  }
  ScriptedRobot robot(2, plan);
  robot.start();
  ASSERT_TRUE(robot.run_until([&] { return robot.master().state() == MasterState::starting; }, 5'000'000));
  EXPECT_EQ(robot.master().changes_made(), 6U);
  ASSERT_TRUE(robot.run_until_running());
  ASSERT_TRUE(robot.run_to_tick(400));
  EXPECT_EQ(robot.master().problem().code, ProblemCode::none);
  EXPECT_EQ(robot.module(0).effects.size(), 50U);
}

TEST(MasterChanges, OneThatComesTooLateIsReportedAndDroppedAndTheRobotGoesOn) {
  std::vector<Change> plan;
  for (std::uint32_t i = 0; i < 12; ++i) {  // one a tick, of 18 values of joint 0: seven of them fit at once
    plan.push_back({100 + i, for_all(2, 0, static_cast<std::int32_t>(i))});
    for (std::uint8_t n = 0; n < 17; ++n) {
      plan.back().settings.push_back({0, 0, 0, false, static_cast<std::int32_t>(i)});
    }
  }
  plan.push_back({300, for_all(2, 0, 1234)});
  ScriptedRobot robot(2, plan);
  robot.start();
  ASSERT_TRUE(robot.run_until_running());
  ASSERT_TRUE(robot.run_to_tick(320));
  EXPECT_EQ(robot.master().state(), MasterState::running);
  EXPECT_EQ(robot.master().problem().code, ProblemCode::commit_too_late);
  EXPECT_EQ(robot.master().problem().change, 7U);
  EXPECT_EQ(robot.master().problem().expected, 107U);
  EXPECT_GT(robot.master().problem().found, 107U - 20U);
  EXPECT_EQ(robot.count(EventKind::change_dropped), 5U);
  for (std::size_t i = 0; i < plan.size(); ++i) {
    EXPECT_EQ(robot.changes[i].dropped, i >= 7 && i < 12) << i;
  }
  EXPECT_EQ(robot.module(1).effects, planned_effects(robot, 1));
  EXPECT_EQ(value_of(robot, 0, 0), 1234U);
  EXPECT_EQ(value_of(robot, 1, 0), 1235U);
  EXPECT_EQ(robot.emergencies(), 0U);
  check_commits(robot, 20);
}

TEST(MasterChanges, OneThatAModuleRefusesInFlightIsDroppedForAll) {
  std::vector<Change> plan;
  for (std::uint32_t i = 0; i < 35; ++i) {
    plan.push_back({50 + i * 25, for_all(4, 0, static_cast<std::int32_t>(i))});
  }
  ScriptedRobot robot(4, plan);
  robot.module(2).refusal = [](Address address, bool, std::uint32_t value) {
    const Address staged{static_cast<std::uint16_t>(in_force(0).index + 0x1000), 1};
    return address == staged && value == 33 + 2 ? AbortCode::above_maximum : AbortCode::none;
  };
  robot.start();
  ASSERT_TRUE(robot.run_until_running());
  ASSERT_TRUE(robot.run_to_tick(950));
  const Problem& problem = robot.master().problem();
  EXPECT_EQ(problem.code, ProblemCode::change_refused);
  EXPECT_EQ(problem.joint, 2);
  EXPECT_EQ(problem.change, 33U);
  EXPECT_EQ(problem.abort_code, AbortCode::above_maximum);
  EXPECT_EQ(robot.master().state(), MasterState::running);
  for (unsigned joint = 0; joint < 4; ++joint) {
    EXPECT_EQ(robot.module(joint).effects, planned_effects(robot, joint));
    EXPECT_EQ(robot.module(joint).effects.size(), 34U);
  }
}

// Restarts.

std::vector<Change> steady_plan(unsigned joints, std::uint32_t ticks) {
  std::vector<Change> plan;
  for (std::uint32_t tick = 10; tick < ticks; tick += 15) {
    // Two parameters change all the time, a third one now and then.
    const auto number = static_cast<std::uint8_t>(tick % 100 == 10 ? 2 : tick % 2);
    plan.push_back({tick, for_all(joints, number, static_cast<std::int32_t>(tick))});
    plan.back().settings.push_back({0, 1, 0, true, static_cast<std::int32_t>(tick)});  // a distortion
  }
  return plan;
}

/// Checks that all parameters in force are those of the plan at the master's tick.
void expect_values_of_plan(ScriptedRobot& robot) {
  std::map<std::pair<unsigned, unsigned>, std::int32_t> values;
  for (std::size_t i = 0; i < robot.plan.size(); ++i) {
    if (robot.plan[i].tick <= robot.master().tick().value_or(0) && !robot.changes[i].dropped) {
      for (const Setting& value : robot.plan[i].settings) {
        if (!value.internal) {
          values[{value.joint, value.number}] = value.value;
        }
      }
    }
  }
  for (const auto& [key, value] : values) {
    EXPECT_EQ(robot.module(key.first).value(in_force(static_cast<std::uint8_t>(key.second))),
              static_cast<std::uint32_t>(value))
        << "joint " << key.first << " parameter " << key.second;
  }
}

TEST(MasterRestart, ARestartedModuleGetsItsSetupAndEverythingThatHasChanged) {
  for (const std::uint32_t at : {3U, 100U, 133U, 134U, 135U, 136U, 137U, 400U}) {
    SCOPED_TRACE("restart at tick " + std::to_string(at));
    ScriptedRobot robot(4, steady_plan(4, 600));
    robot.start();
    ASSERT_TRUE(robot.run_until_running());
    ASSERT_TRUE(robot.run_to_tick(at));
    robot.module(1).power_on(robot.now());
    ASSERT_TRUE(robot.run_until([&] { return robot.count(EventKind::rejoined) == 1; }, 2'000'000));
    EXPECT_EQ(robot.master().restarts(), 1U);
    EXPECT_EQ(robot.count(EventKind::restarted), 1U);
    EXPECT_EQ(robot.module(1).state(), NmtState::operational);
    EXPECT_EQ(robot.module(1).power(), PowerState::operation_enabled);
    for (const auto& [address, value] : robot.module(1).writes) {
      const auto kind = value_address(address);
      EXPECT_FALSE(kind && kind->kind == ValueKind::internal_value && value + 60 <= robot.master().tick().value_or(0))
          << "an old distortion";
    }
    robot.run_for(105'000);  // until it has received a TICK
    expect_values_of_plan(robot);
    ASSERT_TRUE(robot.run_to_tick(620));
    expect_values_of_plan(robot);
    EXPECT_EQ(robot.emergencies(), 0U);
    EXPECT_EQ(robot.master().problem().code, ProblemCode::none);
    EXPECT_EQ(robot.master().state(), MasterState::running);
    // The other modules have not noticed the restart.
    for (const unsigned joint : {0U, 2U, 3U}) {
      EXPECT_EQ(robot.module(joint).effects, planned_effects(robot, joint));
      EXPECT_EQ(robot.module(joint).boots, 1U);
    }
  }
}

TEST(MasterRestart, ChangesMayPassWhileAModuleIsSetUpAgain) {
  std::vector<Change> plan;
  for (std::uint32_t i = 0; i < 7; ++i) {
    plan.push_back({200 + i, for_all(4, static_cast<std::uint8_t>(i % 5), static_cast<std::int32_t>(i + 1))});
  }
  for (std::uint32_t at = 190; at < 208; ++at) {
    SCOPED_TRACE("restart at tick " + std::to_string(at));
    ScriptedRobot robot(4, plan);
    robot.start();
    ASSERT_TRUE(robot.run_until_running());
    ASSERT_TRUE(robot.run_to_tick(at));
    robot.module(2).answer_delay_us = at % 3 * 500;  // 100 answers take up to 10 ticks
    robot.module(2).power_on(robot.now());
    ASSERT_TRUE(robot.run_to_tick(280));
    EXPECT_EQ(robot.count(EventKind::rejoined), 1U);
    expect_values_of_plan(robot);
    EXPECT_EQ(robot.emergencies(), 0U);
    EXPECT_EQ(robot.module(2).power(), PowerState::operation_enabled);
  }
}

TEST(MasterRestart, WhatWasDroppedIsNotMadeByARestart) {
  std::vector<Change> plan;
  for (std::uint32_t i = 0; i < 9; ++i) {  // one a tick, of 18 values of joint 0: seven of them fit at once
    plan.push_back({100 + i, for_all(3, static_cast<std::uint8_t>(i % 3), static_cast<std::int32_t>(i + 50))});
    for (std::uint8_t n = 0; n < 17; ++n) {
      plan.back().settings.push_back({0, 0, 4, false, static_cast<std::int32_t>(i)});
    }
  }
  ScriptedRobot robot(3, plan);
  robot.start();
  ASSERT_TRUE(robot.run_until_running());
  ASSERT_TRUE(robot.run_to_tick(150));
  EXPECT_EQ(robot.count(EventKind::change_dropped), 2U);
  robot.module(1).power_on(robot.now());
  ASSERT_TRUE(robot.run_to_tick(200));
  EXPECT_EQ(robot.count(EventKind::rejoined), 1U);
  for (std::uint8_t number = 0; number < 3; ++number) {
    EXPECT_EQ(value_of(robot, 1, number), value_of(robot, 2, number) - 1);
  }
}

TEST(MasterRestart, SeveralModulesMayRestartAtAnyTime) {
  for (unsigned seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    ScriptedRobot robot(6, steady_plan(6, 1500));
    robot.start();
    ASSERT_TRUE(robot.run_until_running());
    std::uint32_t restarts = 0;
    for (int i = 0; i < 10; ++i) {
      robot.run_for(random() % 900'000);
      const auto joint = static_cast<unsigned>(1 + random() % 5);  // joint 0 produces SYNC
      if (robot.module(joint).state() != NmtState::boot_up) {
        robot.module(joint).power_on(robot.now());
        ++restarts;
      }
    }
    ASSERT_TRUE(robot.run_to_tick(1520));
    EXPECT_EQ(robot.master().restarts(), restarts);
    EXPECT_EQ(robot.master().state(), MasterState::running);
    EXPECT_EQ(robot.count(EventKind::rejoin_failed), 0U);
    expect_values_of_plan(robot);
    for (unsigned joint = 0; joint < 6; ++joint) {
      EXPECT_EQ(robot.module(joint).state(), NmtState::operational) << joint;
      EXPECT_EQ(robot.module(joint).power(), PowerState::operation_enabled) << joint;
    }
    EXPECT_EQ(robot.master().problem().code, ProblemCode::none) << describe(robot.master().problem().code);
  }
}

TEST(MasterRestart, WithoutItsSyncProducerTheRobotHasStopped) {
  ScriptedRobot robot(3);
  robot.start();
  ASSERT_TRUE(robot.run_until_running());
  robot.run_for(500'000);
  robot.module(0).power_on(robot.now());
  ASSERT_TRUE(robot.run_until([&] { return robot.settled() && robot.count(EventKind::restarted) == 1; }, 1'000'000));
  EXPECT_EQ(robot.master().state(), MasterState::failed);
  EXPECT_EQ(robot.master().problem().code, ProblemCode::sync_lost);
  EXPECT_EQ(robot.master().problem().joint, 0);
}

TEST(MasterRestart, WithoutSyncTheRobotHasStopped) {
  ScriptedRobot robot(3);
  robot.start();
  ASSERT_TRUE(robot.run_until_running());
  robot.run_for(500'000);
  robot.module(0).power_off();
  ASSERT_TRUE(robot.run_until([&] { return robot.master().state() == MasterState::failed; }, 1'000'000));
  EXPECT_EQ(robot.master().problem().code, ProblemCode::sync_lost);
}

TEST(MasterRestart, AModuleThatKeepsRestartingDoesNotBlockChanges) {
  ScriptedRobot robot(4, steady_plan(4, 900));
  robot.start();
  ASSERT_TRUE(robot.run_until_running());
  for (int i = 0; i < 250; ++i) {
    robot.module(3).power_on(robot.now());
    robot.run_for(25'000);
  }
  ASSERT_TRUE(robot.run_to_tick(920));
  EXPECT_EQ(robot.master().problem().code, ProblemCode::none) << describe(robot.master().problem().code);
  for (const unsigned joint : {0U, 1U, 2U}) {
    EXPECT_EQ(robot.module(joint).effects, planned_effects(robot, joint));
  }
  expect_values_of_plan(robot);
  EXPECT_GE(robot.master().restarts(), 240U);
  EXPECT_GT(robot.master().lost_events() + robot.events.size(), 240U);
}

TEST(MasterRestart, AModuleThatCannotBeSetUpAgainIsNamedAndLeftAlone) {
  ScriptedRobot robot(4, steady_plan(4, 600));
  robot.start();
  ASSERT_TRUE(robot.run_until_running());
  robot.run_for(500'000);
  robot.module(2).refusal = [](Address address, bool writes, std::uint32_t) {
    return writes && address == object::upper_limit.address ? AbortCode::general_error : AbortCode::none;
  };
  robot.module(2).power_on(robot.now());
  ASSERT_TRUE(robot.run_to_tick(620));
  EXPECT_EQ(robot.count(EventKind::rejoin_failed), 1U);
  EXPECT_EQ(robot.module(2).boots, 2U) << "it is reset once";
  EXPECT_EQ(robot.count(EventKind::heartbeat_returned), 0U) << "nor asked for anything";
  EXPECT_EQ(robot.master().state(), MasterState::running);
  for (const unsigned joint : {0U, 1U, 3U}) {
    EXPECT_EQ(robot.module(joint).effects, planned_effects(robot, joint));
  }
}

// Modules without answers or heartbeats.

TEST(MasterSilence, IsReportedOnceAndChangesAreMadeWithoutTheModule) {
  ScriptedRobot robot(4, steady_plan(4, 600));
  robot.start();
  ASSERT_TRUE(robot.run_until_running());
  robot.run_for(500'000);
  robot.module(3).power_off();
  ASSERT_TRUE(robot.run_to_tick(620));
  EXPECT_EQ(robot.count(EventKind::silent), 1U);
  EXPECT_EQ(robot.master().state(), MasterState::running);
  EXPECT_EQ(robot.master().problem().code, ProblemCode::none) << describe(robot.master().problem().code);
  for (const unsigned joint : {0U, 1U, 2U}) {
    EXPECT_EQ(robot.module(joint).effects, planned_effects(robot, joint));
  }
}

TEST(MasterSilence, AModuleThatHasMissedAChangeIsResetWhenItsHeartbeatReturns) {
  ScriptedRobot robot(4, steady_plan(4, 900));
  robot.start();
  ASSERT_TRUE(robot.run_until_running());
  robot.run_for(500'000);
  robot.module(3).silent = true;
  robot.module(3).ignores_sdo = true;
  ASSERT_TRUE(robot.run_to_tick(400));
  EXPECT_EQ(robot.count(EventKind::silent), 1U);
  robot.module(3).silent = false;
  robot.module(3).ignores_sdo = false;
  ASSERT_TRUE(robot.run_to_tick(920));
  EXPECT_EQ(robot.count(EventKind::heartbeat_returned), 1U);
  EXPECT_EQ(robot.module(3).boots, 2U);
  EXPECT_EQ(robot.count(EventKind::rejoined), 1U);
  expect_values_of_plan(robot);
  EXPECT_EQ(robot.module(3).power(), PowerState::operation_enabled);
}

TEST(MasterSilence, AModuleThatHasMissedNothingGoesOn) {
  ScriptedRobot robot(3);
  robot.start();
  ASSERT_TRUE(robot.run_until_running());
  robot.module(1).silent = true;
  robot.run_for(2'000'000);
  robot.module(1).silent = false;
  robot.run_for(500'000);
  EXPECT_EQ(robot.count(EventKind::silent), 1U);
  EXPECT_EQ(robot.count(EventKind::heartbeat_returned), 1U);
  EXPECT_EQ(robot.module(1).boots, 1U);
}

TEST(MasterEvents, EmergenciesAreKeptWithTheirMeaning) {
  ScriptedRobot robot(3);
  robot.start();
  ASSERT_TRUE(robot.run_until_running());
  robot.module(2).send(encode(Emergency{robot.module(2).node, EmergencyCode::over_current, 0x02, 350}));
  robot.run_for(10'000);
  ASSERT_EQ(robot.events.size(), 1U);
  EXPECT_EQ(robot.events[0].kind, EventKind::emergency);
  EXPECT_EQ(robot.events[0].node, robot.module(2).node);
  EXPECT_EQ(robot.events[0].code, EmergencyCode::over_current);
  EXPECT_EQ(robot.events[0].error_register, 0x02);
  EXPECT_EQ(robot.events[0].detail, 350U);
}

TEST(MasterEvents, AModuleThatLeavesOperationalAndAnUnknownNodeAreReported) {
  ScriptedRobot robot(3);
  ScriptedModule& unknown = robot.add_module(100);
  robot.master().start(robot.now());
  for (unsigned joint = 0; joint < 3; ++joint) {
    robot.module(joint).power_on(robot.now());
  }
  ASSERT_TRUE(robot.run_until_running());
  unknown.power_on(robot.now());
  robot.module(1).received(robot.now() * 1000, encode(NmtRequest{NmtCommand::stop, 0}));
  robot.run_for(300'000);
  EXPECT_EQ(robot.count(EventKind::unexpected_node), 1U);
  EXPECT_EQ(robot.count(EventKind::left_operational), 1U);
  EXPECT_EQ(robot.master().state(), MasterState::running);
}

TEST(MasterEvents, TheOldestAreKeptAndTheRestIsCounted) {
  EventLog log;
  for (std::uint32_t i = 0; i < EventLog::capacity + 5; ++i) {
    log.add({i, EventKind::silent, 1});
  }
  EXPECT_EQ(log.overflow(), 5U);
  for (std::uint32_t i = 0; i < EventLog::capacity; ++i) {
    EXPECT_EQ(log.take()->time, i);
  }
  EXPECT_FALSE(log.take().has_value());
}

TEST(MasterEvents, EveryProblemAndEventHasAPhrase) {
  for (unsigned code = 0; code <= static_cast<unsigned>(ProblemCode::cannot_send); ++code) {
    EXPECT_NE(describe(static_cast<ProblemCode>(code)), "unknown problem");
  }
  for (unsigned kind = 0; kind <= static_cast<unsigned>(EventKind::change_dropped); ++kind) {
    EXPECT_NE(describe(static_cast<EventKind>(kind)), "unknown event");
  }
  EXPECT_EQ(describe(static_cast<ProblemCode>(200)), "unknown problem");
  EXPECT_EQ(describe(static_cast<EventKind>(200)), "unknown event");
}

// The end.

TEST(MasterStop, TakesThePowerThenTheTicks) {
  ScriptedRobot robot(5);
  robot.start();
  ASSERT_TRUE(robot.run_until_running());
  robot.run_for(500'000);
  robot.master().stop(robot.now());
  ASSERT_TRUE(robot.run_until([&] { return robot.master().state() == MasterState::stopped; }, 1'000'000));
  robot.run_for(50'000);
  const std::size_t frames = robot.transmissions.size();
  for (unsigned joint = 0; joint < 5; ++joint) {
    EXPECT_EQ(robot.module(joint).power(), PowerState::switch_on_disabled);
    EXPECT_EQ(robot.module(joint).state(), NmtState::pre_operational);
    EXPECT_FALSE(robot.module(joint).produces_sync());
  }
  robot.run_for(1'000'000);
  for (std::size_t i = frames; i < robot.transmissions.size(); ++i) {
    EXPECT_EQ(robot.transmissions[i].frame.identifier & ~0x7FU, unsigned{identifier::heartbeat})
        << "heartbeats continue";
  }
  EXPECT_EQ(robot.emergencies(), 0U);
}

TEST(MasterStop, EveryJointGetsTheQuickStopAtOnceAlsoIfNoModuleAnswers) {
  constexpr unsigned joints = 20;  // more than the queue of the master has room for
  ScriptedRobot robot(joints);
  robot.options.ramps_down = true;
  robot.start();
  ASSERT_TRUE(robot.run_until_running());
  robot.run_for(100'000);
  const std::size_t before = robot.transmissions.size();
  for (unsigned joint = 0; joint < joints; ++joint) {
    robot.module(joint).ignores_sdo = true;
  }
  robot.master().stop(robot.now());
  robot.run_for(10'000);
  std::set<unsigned> stopped;
  for (std::size_t i = before; i < robot.transmissions.size(); ++i) {
    if (const auto command = canopen::decode_command(robot.transmissions[i].frame);
        command && identifier::base_of(robot.transmissions[i].frame.identifier) == identifier::command) {
      EXPECT_EQ(command->controlword, canopen::quick_stop_controlword);
      EXPECT_NE(check_range(canopen::object::target_position, static_cast<std::uint32_t>(command->target)),
                canopen::AbortCode::none)
          << "the module takes no target from the command";
      stopped.insert(command->node);
    }
  }
  EXPECT_EQ(stopped.size(), joints);
}

TEST(MasterStop, ASilentRobotIsNoticedIn400MillisecondsFromTheFirstPowerOn) {
  // The last SYNC is up to a tick older than the silence; the rest is for the frames on the bus.
  constexpr Microseconds at_most_us = 400'000 + 10'000;
  constexpr unsigned seed = 7;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937_64 random(seed);
  for (int round = 0; round < 20; ++round) {
    ScriptedRobot robot(20);
    robot.options.attempts = 8;  // with them the answers alone would take more than a second
    robot.start();
    ASSERT_TRUE(robot.run_until([&] { return robot.module(0).power() == PowerState::operation_enabled; }, 10'000'000));
    robot.run_for(pick(random, 30'000));
    robot.master_node().is_deaf = true;
    EXPECT_TRUE(robot.run_until([&] { return robot.master().state() == MasterState::failed; }, at_most_us)) << round;
  }
}

TEST(MasterStop, TheHeartbeatPausesWhileNothingComesFromTheRobot) {
  ScriptedRobot robot(3);
  robot.start();
  ASSERT_TRUE(robot.run_until_running());
  robot.run_for(500'000);
  robot.master_node().is_deaf = true;
  robot.run_for(Master::unanswered_us);
  const std::size_t before = robot.transmissions.size();
  robot.run_for(2'000'000);
  for (std::size_t i = before; i < robot.transmissions.size(); ++i) {
    EXPECT_NE(robot.transmissions[i].frame.identifier, identifier::heartbeat + canopen::host_node);
  }
}

TEST(MasterStop, TakesAFewSecondsIfNothingComesFromTheRobot) {
  ScriptedRobot robot(20);
  robot.options.ramps_down = true;
  robot.start();
  ASSERT_TRUE(robot.run_until_running());
  for (const auto& module : robot.modules) {
    module->power_off();
  }
  ASSERT_TRUE(robot.run_until([&] { return robot.master().state() == MasterState::failed; }, 1'000'000));
  robot.master().stop(robot.now());
  // Three rounds of eight joints, three times 100 ms each, and as long twice; 1.2 s for the ramp; 0.3 s for the SYNC
  // producer; 0.2 s three times, since no node acknowledges a frame.
  EXPECT_TRUE(robot.run_until([&] { return robot.master().state() == MasterState::stopped; }, 4'900'000));
}

TEST(MasterStop, EndsWhenEverItIsAskedForAndWhoeverIsGone) {
  constexpr unsigned seed = 33;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937_64 random(seed);
  for (int round = 0; round < 60; ++round) {
    ScriptedRobot robot(1 + pick(random, 10), steady_plan(2, 300));
    if (robot.modules.size() < 2) {
      continue;
    }
    robot.start();
    robot.run_for(random() % 2'000'000);
    if (round % 3 == 0) {
      robot.module(pick(random, static_cast<unsigned>(robot.modules.size()))).power_off();
    }
    robot.run_for(random() % 20'000);
    robot.master().stop(robot.now());
    ASSERT_TRUE(robot.run_until([&] { return robot.master().state() == MasterState::stopped; }, 1'500'000)) << round;
    robot.run_for(50'000);
    for (const auto& module : robot.modules) {
      EXPECT_NE(module->state(), NmtState::operational);
      EXPECT_FALSE(module->produces_sync());
      EXPECT_TRUE(module->power() == PowerState::switch_on_disabled || module->state() == NmtState::boot_up);
    }
  }
}

// Arbitrary frames on the bus.

TEST(MasterRobustness, RandomFramesNeverBreakIt) {
  for (unsigned seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    ScriptedRobot robot(4, steady_plan(4, 500));
    struct Rogue final : sim::BusListener {
      void received(sim::BusTime, const CanFrame&) override {}
      void transmitted(sim::BusTime, const CanFrame&) override {}
    } rogue;
    sim::Controller& controller = robot.bus.attach(rogue);
    robot.start();
    const std::uint64_t gentle = random() % 3;  // 0: from the start, else when it runs
    if (gentle != 0) {
      ASSERT_TRUE(robot.run_until_running());
    }
    for (int i = 0; i < 3000; ++i) {
      CanFrame frame;
      constexpr std::uint16_t bases[] = {0x000, 0x080, 0x180, 0x580, 0x600, 0x680, 0x700};
      const std::uint64_t draw = random();
      frame.identifier = draw % 4 == 0 ? static_cast<std::uint16_t>(draw >> 8U & 0x7FFU)
                                       : static_cast<std::uint16_t>(bases[(draw >> 8U) % 7] + (draw >> 16U) % 16);
      frame.length = static_cast<std::uint8_t>((draw >> 24U) % 2 == 0 ? 8 : (draw >> 25U) % 9);
      for (unsigned b = 0; b < frame.length; ++b) {
        frame.data[b] = static_cast<std::uint8_t>(random() % 3 == 0 ? random() : random() % 8);
      }
      static_cast<void>(controller.send(frame));
      robot.run_for(random() % 3'000);
    }
    robot.master().stop(robot.now());
    EXPECT_TRUE(robot.run_until([&] { return robot.master().state() == MasterState::stopped; }, 5'000'000));
  }
}

TEST(MasterRobustness, AnyOrderOfCallsIsBorne) {
  for (unsigned seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    struct Port final : CanPort {
      explicit Port(std::mt19937_64& source) : random(source) {}
      bool send(const CanFrame& frame) override {
        if (random() % 4 == 0) {
          return false;
        }
        last = frame;
        return true;
      }
      std::mt19937_64& random;
      CanFrame last;
    } port(random);
    ScriptedRobot robot(3, steady_plan(3, 200));
    Master master(port, robot.setup(), robot.options, robot.changes);
    Microseconds now = 0;
    for (int i = 0; i < 2000; ++i) {
      now += random() % 20'000;
      const std::uint8_t node = robot.setup().nodes[random() % 3];
      switch (random() % 8) {
        case 0:
          master.start(now);
          break;
        case 1:
          if (random() % 100 == 0) {
            master.stop(now);
          }
          break;
        case 2:
          master.receive(now, encode(Heartbeat{node, random() % 8 == 0 ? NmtState::boot_up : NmtState::operational}));
          break;
        case 3:
          master.transmitted(now, port.last);
          break;
        case 4:
        case 5: {  // an answer to the last request
          CanFrame answer = port.last;
          answer.identifier = static_cast<std::uint16_t>(identifier::sdo_answer + (answer.identifier & 0x7FU));
          answer.data[0] = (answer.data[0] & 0xE0U) == 0x20 ? 0x60 : 0x43;
          master.receive(now, answer);
          break;
        }
        default:
          master.poll(now);
          EXPECT_GT(master.next_deadline(), now);
          break;
      }
      static_cast<void>(master.take_event());
    }
  }
}

TEST(TickFollower, FollowsTheTickByAnnouncementsAndCounters) {
  TickFollower ticks;
  ticks.sync(5);
  EXPECT_FALSE(ticks.tick().has_value());
  ticks.announce(300);
  ticks.sync(0x2D);
  EXPECT_EQ(ticks.tick(), 300U);
  ticks.sync(0x2E);
  EXPECT_EQ(ticks.tick(), 301U);
  ticks.sync(0x2E);
  EXPECT_EQ(ticks.tick(), 301U) << "a repeated SYNC";
  ticks.sync(0x31);
  EXPECT_EQ(ticks.tick(), 304U) << "two were missed";
  ticks.announce(1000);
  ticks.sync(0x32);
  EXPECT_EQ(ticks.tick(), 305U) << "an announcement that does not fit its SYNC";
  for (std::uint32_t tick = 306; tick < 700; ++tick) {
    ticks.sync(static_cast<std::uint8_t>(tick % 128 + 1));
    ASSERT_EQ(ticks.tick(), tick);
  }
}

}  // namespace
}  // namespace proleg::test
