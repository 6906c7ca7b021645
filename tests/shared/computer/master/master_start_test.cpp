// The start of a robot: the requests of the master, their order, and the name of every possible problem.

#include <gtest/gtest.h>

#include "scripted_robot.hpp"
#include "sim/bus/frame_bits.hpp"

namespace proleg::test {
namespace {

using namespace canopen;

TEST(MasterStart, BringsUpEveryModuleAndThenTheTicks) {
  ScriptedRobot robot(5);
  robot.start();
  ASSERT_TRUE(robot.run_until_running());
  EXPECT_EQ(robot.master().problem().code, ProblemCode::none);
  for (unsigned joint = 0; joint < 5; ++joint) {
    ScriptedModule& module = robot.module(joint);
    EXPECT_EQ(module.state(), NmtState::operational);
    EXPECT_EQ(module.power(), PowerState::operation_enabled);
    EXPECT_EQ(module.produces_sync(), joint == 0);
    const SetupList list(robot.setup(), joint);
    ASSERT_GT(module.writes.size(), list.size());
    for (std::size_t i = 0; i < list.size(); ++i) {
      EXPECT_EQ(module.writes[i].first, list.at(i).address);
      EXPECT_EQ(module.value(list.at(i).address), list.at(i).value) << i;
    }
    EXPECT_EQ(robot.master().identity(joint).serial, module.serial);
    EXPECT_EQ(robot.master().identity(joint).vendor, placeholder_vendor);
  }
  EXPECT_FALSE(robot.master().tick().has_value());
  robot.run_for(995'000);
  EXPECT_EQ(robot.master().tick(), 99U);
  EXPECT_EQ(robot.master().state(), MasterState::running);
  EXPECT_EQ(robot.emergencies(), 0U);
  EXPECT_TRUE(robot.events.empty());
}

TEST(MasterStart, AnotherModuleCanProduceSync) {
  ScriptedRobot robot(4);
  robot.options.sync_producer = 2;
  robot.start();
  ASSERT_TRUE(robot.run_until_running());
  for (unsigned joint = 0; joint < 4; ++joint) {
    EXPECT_EQ(robot.module(joint).produces_sync(), joint == 2);
  }
}

TEST(MasterStart, TheHostSendsAHeartbeatEvery100MsFromTheStartOn) {
  ScriptedRobot robot(2);
  robot.start();
  robot.run_for(3'050'000);
  std::vector<sim::BusTime> times;
  for (const sim::Transmission& transmission : robot.transmissions) {
    if (transmission.frame.identifier == 0x77F) {
      EXPECT_EQ(transmission.frame.data[0], 0x05);
      times.push_back(transmission.start);
    }
  }
  EXPECT_EQ(times.size(), 31U);
  for (std::size_t i = 1; i < times.size(); ++i) {
    EXPECT_NEAR(static_cast<double>(times[i] - times[i - 1]), 100e6, 2e6);
  }
}

TEST(MasterStart, NothingIsSentBeforeIt) {
  ScriptedRobot robot(2);
  EXPECT_EQ(robot.master().next_deadline(), never);
  robot.modules[0]->power_on(0);
  robot.run_for(1'000'000);
  EXPECT_EQ(robot.transmissions.size(), 1U);  // the module's boot-up
  EXPECT_EQ(robot.master().state(), MasterState::idle);
}

TEST(MasterStart, SixtyModulesRunAfterTwoSecondsOfBusTime) {
  ScriptedRobot robot(60);
  robot.setup().kernel.slots[1] = {};
  for (const auto& module : robot.modules) {
    module->configuration_crc = configuration_crc(robot.setup());
  }
  robot.start();
  ASSERT_TRUE(robot.run_until_running());
  sim::BusTime busy = 0;
  std::size_t sdo_frames = 0;
  for (const sim::Transmission& transmission : robot.transmissions) {
    busy += (sim::frame_bits(transmission.frame) + sim::interframe_bits) * 1000;
    const unsigned function = transmission.frame.identifier & ~0x7FU;
    sdo_frames += function == identifier::sdo_request || function == identifier::sdo_answer ? 1U : 0U;
  }
  RecordProperty("sdo_transfers", static_cast<int>(sdo_frames / 2));
  RecordProperty("bus_time_ms", static_cast<int>(busy / 1'000'000));
  EXPECT_LT(busy, 2'000'000'000U);
  EXPECT_LT(robot.now() * 1000, busy + 300'000'000) << "the bus is hardly ever idle";
}

// Problems.

void expect_nothing_sent(ScriptedRobot& robot, ProblemCode code) {
  robot.master().start(robot.now());
  EXPECT_EQ(robot.master().problem().code, code);
  EXPECT_EQ(robot.master().state(), MasterState::failed);
  robot.run_for(1'000'000);
  EXPECT_TRUE(robot.transmissions.empty());
}

TEST(MasterProblem, ASetupThatCannotBeIsFoundBeforeAnythingIsSent) {
  const auto broken = [](auto change) {
    ScriptedRobot robot(3);
    change(robot);
    expect_nothing_sent(robot, ProblemCode::bad_setup);
    return robot.master().problem();
  };
  static std::array<std::uint8_t, 3> nodes{};
  nodes = {7, 8, 7};
  const Problem twice = broken([](ScriptedRobot& robot) { robot.setup().nodes = nodes; });
  EXPECT_EQ(twice.node, 7);
  EXPECT_EQ(twice.joint, 2);
  nodes = {7, 0, 9};
  EXPECT_EQ(broken([](ScriptedRobot& robot) { robot.setup().nodes = nodes; }).joint, 1);
  nodes = {7, 127, 9};
  EXPECT_EQ(broken([](ScriptedRobot& robot) { robot.setup().nodes = nodes; }).joint, 1);
  broken([](ScriptedRobot& robot) { robot.setup().nodes = robot.setup().nodes.first(2); });
  broken([](ScriptedRobot& robot) { robot.setup().limits = robot.setup().limits.first(2); });
  broken([](ScriptedRobot& robot) { robot.setup().kernel.joint_count = 0; });
  broken([](ScriptedRobot& robot) { robot.setup().kernel.joint_count = 65; });
  broken([](ScriptedRobot& robot) { robot.options.sync_producer = 3; });
  static constexpr std::array<std::uint32_t, 2> serials{};
  broken([](ScriptedRobot& robot) { robot.options.serials = serials; });
}

// 135 bits a state frame at most: 60 of them take 81 % of a tick of 10 ms, and those of two slots 162 %.
TEST(MasterProblem, ARobotThatCouldFillTheBusIsRefusedBeforeAnythingIsSent) {
  ScriptedRobot robot(60);
  expect_nothing_sent(robot, ProblemCode::bus_too_small);
  EXPECT_EQ(robot.master().problem().found, 1635U);
  EXPECT_EQ(robot.master().problem().expected, 850U);
}

TEST(MasterProblem, AChangeThatCannotBeIsFoundBeforeAnythingIsSent) {
  const auto bad_change = [](std::vector<Change> plan) {
    ScriptedRobot robot(3, std::move(plan));
    expect_nothing_sent(robot, ProblemCode::bad_change);
    return robot.master().problem().change;
  };
  const Setting good{0, 2, 0, false, 5};
  EXPECT_EQ(bad_change({{10, {good}}, {20, {{0, 3, 0, false, 5}}}}), 1U) << "joint";
  EXPECT_EQ(bad_change({{10, {{2, 0, 0, false, 5}}}}), 0U) << "slot without algorithm";
  EXPECT_EQ(bad_change({{10, {{4, 0, 0, false, 5}}}}), 0U) << "slot";
  EXPECT_EQ(bad_change({{10, {{0, 0, 30, false, 5}}}}), 0U) << "parameter";
  EXPECT_EQ(bad_change({{10, {{0, 0, 30, true, 5}}}}), 0U) << "internal value";
  EXPECT_EQ(bad_change({{10, {good}}, {10, {good}}}), 1U) << "tick";
  EXPECT_EQ(bad_change({{10, std::vector<Setting>(129, good)}}), 0U) << "too many values of a joint";
}

TEST(MasterProblem, AMissingModuleIsNamedAfterASecond) {
  ScriptedRobot robot(4);
  robot.module(2).boot_delay_us = 5'000'000;
  const Problem problem = robot.problem_of_start();
  EXPECT_EQ(problem.code, ProblemCode::missing_module);
  EXPECT_EQ(problem.joint, 2);
  EXPECT_EQ(problem.node, robot.module(2).node);
  EXPECT_EQ(robot.now(), 1'001'000U);
  EXPECT_EQ(robot.master().booted(), JointMask(0b1011));
}

TEST(MasterProblem, TwoModulesWithOneNodeIdAreNamed) {
  ScriptedRobot robot(3);
  robot.add_module(robot.module(1).node).boot_delay_us = 11'000;
  robot.module(1).boot_delay_us = 4'000;
  const Problem problem = robot.problem_of_start();
  EXPECT_EQ(problem.code, ProblemCode::duplicate_node);
  EXPECT_EQ(problem.joint, 1);
}

TEST(MasterProblem, TwoModulesWithOneNodeIdThatBootInOneInstantAreNamed) {
  ScriptedRobot robot(3);
  // Their boot-up messages become one, and so do their answers until the master asks for their serial numbers.
  robot.add_module(robot.module(1).node).serial = 0x777;
  const Problem problem = robot.problem_of_start();
  EXPECT_EQ(problem.code, ProblemCode::duplicate_node);
  EXPECT_EQ(problem.joint, 1);
}

TEST(MasterProblem, AModuleThatDoesNotBelongToTheRobotIsNamed) {
  for (const Microseconds delay : {1'000U, 40'000U}) {
    ScriptedRobot robot(3);
    robot.add_module(99).boot_delay_us = delay;
    const Problem problem = robot.problem_of_start();
    EXPECT_EQ(problem.code, ProblemCode::unexpected_node);
    EXPECT_EQ(problem.node, 99);
    EXPECT_EQ(problem.joint, Problem::no_joint);
  }
}

TEST(MasterProblem, AForeignModuleIsNamedWithWhatWasFoundAndExpected) {
  {
    ScriptedRobot robot(3);
    robot.module(1).fingerprint = 0xBAD;
    const Problem problem = robot.problem_of_start();
    EXPECT_EQ(problem.code, ProblemCode::wrong_fingerprint);
    EXPECT_EQ(problem.joint, 1);
    EXPECT_EQ(problem.found, 0xBADU);
    EXPECT_EQ(problem.expected, ScriptedRobot::fingerprint);
  }
  {
    ScriptedRobot robot(3);
    robot.module(2).configuration_crc ^= 1;
    const Problem problem = robot.problem_of_start();
    EXPECT_EQ(problem.code, ProblemCode::wrong_configuration);
    EXPECT_EQ(problem.joint, 2);
    EXPECT_EQ(problem.expected, configuration_crc(robot.setup()));
  }
  const std::array<std::uint32_t, 3> serials{0, 0x5E41A1, 0x77};
  ScriptedRobot robot(3);
  robot.options.serials = serials;
  const Problem problem = robot.problem_of_start();
  EXPECT_EQ(problem.code, ProblemCode::wrong_serial);
  EXPECT_EQ(problem.joint, 2);
  EXPECT_EQ(problem.found, 0x5E41A1U);
  EXPECT_EQ(problem.expected, 0x77U);
}

TEST(MasterProblem, AnotherVersionOfTheProtocolIsNamed) {
  // The version is a constant of the module's dictionary, so another one must be put into its answer.
  const RobotSetup* setup = nullptr;
  ScriptedRobot robot(1);
  setup = &robot.setup();
  struct Port final : CanPort {
    bool send(const CanFrame& frame) override {
      frames.push_back(frame);
      return true;
    }
    std::vector<CanFrame> frames;
  } port;
  Master master(port, *setup, {});
  master.start(0);
  const std::uint8_t node = setup->nodes[0];
  master.receive(1'000, encode(Heartbeat{node, NmtState::boot_up}));
  master.poll(100'000);
  for (int i = 0; i < 10 && master.state() != MasterState::failed; ++i) {
    const CanFrame request = port.frames.back();
    port.frames.clear();
    master.transmitted(101'000, request);
    CanFrame answer = request;
    answer.identifier = static_cast<std::uint16_t>(identifier::sdo_answer + node);
    answer.data[0] = 0x43;
    answer.data[4] = request.data[1] == 0x00 ? 0x42 : 0;
    master.receive(102'000, answer);
  }
  EXPECT_EQ(master.problem().code, ProblemCode::wrong_protocol);
  EXPECT_EQ(master.problem().found, 0x42U);
  EXPECT_EQ(master.problem().expected, protocol_version);
}

TEST(MasterProblem, ARefusedWriteIsNamedWithItsAddressAndAbortCode) {
  ScriptedRobot robot(5);
  robot.module(3).refusal = [](Address address, bool writes, std::uint32_t) {
    return writes && address == object::activate.address ? AbortCode::refused_by_application : AbortCode::none;
  };
  const Problem problem = robot.problem_of_start();
  EXPECT_EQ(problem.code, ProblemCode::refused);
  EXPECT_EQ(problem.joint, 3);
  EXPECT_EQ(problem.node, robot.module(3).node);
  EXPECT_EQ(problem.address, object::activate.address);
  EXPECT_EQ(problem.abort_code, AbortCode::refused_by_application);
}

TEST(MasterProblem, AModuleWithoutAnswersIsNamed) {
  ScriptedRobot robot(5);
  robot.module(4).ignores_sdo = true;
  const Problem problem = robot.problem_of_start();
  EXPECT_EQ(problem.code, ProblemCode::no_answer);
  EXPECT_EQ(problem.joint, 4);
  EXPECT_EQ(problem.abort_code, AbortCode::timeout);
}

TEST(MasterProblem, AModuleThatDoesNotBecomeOperationalIsNamed) {
  ScriptedRobot robot(5);
  robot.module(1).never_starts = true;
  const Problem problem = robot.problem_of_start();
  EXPECT_EQ(problem.code, ProblemCode::not_operational);
  EXPECT_EQ(problem.joint, 1);
}

TEST(MasterProblem, AModuleThatRestartsDuringTheStartIsNamed) {
  ScriptedRobot robot(5);
  robot.start();
  ASSERT_TRUE(robot.run_until([&] { return robot.master().state() == MasterState::setting_up; }, 2'000'000));
  robot.run_for(5'000);
  robot.module(2).power_on(robot.now());
  ASSERT_TRUE(robot.run_until([&] { return robot.settled(); }, 5'000'000));
  EXPECT_EQ(robot.master().problem().code, ProblemCode::duplicate_node);
  EXPECT_EQ(robot.master().problem().joint, 2);
}

TEST(MasterProblem, ABusThatTakesNothingIsNamed) {
  ScriptedRobot robot(2, {{50, {{0, 0, 0, false, 5}}}});
  robot.master_node().vanishes = [](const CanFrame& frame) { return frame.identifier == identifier::commit; };
  EXPECT_EQ(robot.problem_of_start().code, ProblemCode::cannot_send);
}

TEST(MasterProblem, EveryStartEndsWithAnyBrokenModule) {
  constexpr unsigned seed = 21;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937_64 random(seed);
  for (int round = 0; round < 60; ++round) {
    ScriptedRobot robot(1 + pick(random, 8), {{5, {{0, 0, 0, false, 5}}}, {400, {{0, 0, 1, true, 5}}}});
    bool broken = false;
    for (const auto& module : robot.modules) {
      const std::uint64_t draw = random() % 30;
      broken = broken || draw < 6;
      module->ignores_sdo = draw == 0;
      module->silent = draw == 1;
      module->never_starts = draw == 2;
      module->fingerprint += draw == 3 ? 1 : 0;
      module->boot_delay_us = draw == 4 ? 2'000'000 : random() % 16'000;
      if (draw == 5) {
        const std::uint64_t rare = 20 + random() % 100;
        module->refusal = [rare, count = std::uint64_t{0}](Address, bool, std::uint32_t) mutable {
          return ++count == rare ? AbortCode::general_error : AbortCode::none;
        };
      }
    }
    robot.start();
    ASSERT_TRUE(robot.run_until([&] { return robot.settled(); }, 10'000'000)) << round;
    if (!broken) {
      EXPECT_EQ(robot.master().state(), MasterState::running) << describe(robot.master().problem().code);
    }
    EXPECT_EQ(robot.master().state() == MasterState::failed, robot.master().problem().code != ProblemCode::none);
  }
}

TEST(MasterStart, AConnectionThatIsLateGivesTheServosNoPowerAndIsNamed) {
  for (const Microseconds late_us : {350'000U, 600'000U}) {
    ScriptedRobot robot(5);
    robot.options.resets_modules = true;
    robot.options.answer_timeout_us = 150'000;
    robot.options.attempts = 8;
    robot.start();
    ASSERT_TRUE(robot.run_until([&] { return robot.master().state() == MasterState::setting_up; }, 5'000'000));
    robot.master_node().late_us = late_us;
    ASSERT_TRUE(robot.run_until([&] { return robot.settled(); }, 20'000'000));
    const Problem problem = robot.master().problem();
    EXPECT_EQ(problem.code, ProblemCode::late_answers) << describe(problem.code);
    EXPECT_NEAR(problem.found, static_cast<double>(late_us) / 1e3, 30) << "beside the time on the bus";
    EXPECT_EQ(problem_text(problem, [](std::uint8_t) { return std::string(); }),
              "the modules answer too late for a robot that must be stopped in time: found answers after " +
                  std::to_string(problem.found) +
                  " ms, expected at most 300 ms; the servos get no power: check the connection");
    for (const auto& module : robot.modules) {
      EXPECT_EQ(module->power(), PowerState::switch_on_disabled);
    }
  }
}

}  // namespace
}  // namespace proleg::test
