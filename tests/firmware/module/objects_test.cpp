// The object dictionary as the module keeps it.

#include <random>

#include "firmware/module/device_objects.hpp"
#include "test_robot.hpp"

namespace proleg {
namespace {

namespace object = canopen::object;
using canopen::AbortCode;
using canopen::NmtCommand;
using canopen::NmtState;
using canopen::ValueKind;
using test::node;

KernelConfiguration two_slots(std::uint32_t tick_us = 7'000) {
  KernelConfiguration configuration = test::one_slot(test::algorithm(test::coupled), 5, tick_us, 0xFEDC'BA98'7654'3210);
  configuration.slots[2] = {&test::algorithm(test::extended), JointMask(0b00011)};
  return configuration;
}

TEST(Objects, EveryEntryOfTheDictionaryCanBeRead) {
  test::TestModule robot(two_slots());
  robot.set_up_and_start();
  robot.run(3);
  unsigned count = 0;
  canopen::for_each_object([&](const canopen::Object& entry) {
    std::uint32_t value = 0;
    std::string text;
    const AbortCode code = is_long(entry.type) ? robot.bus.read_text(node, entry.address, text)
                                               : robot.bus.read(node, entry.address, value);
    if (entry.address.index == 0x1003 && entry.address.sub > 0) {
      EXPECT_EQ(code, AbortCode::no_data) << "no error so far";
      return;
    }
    const auto range = canopen::value_address(entry.address);
    if (range && robot.kernel().configuration().slots[range->slot].algorithm != find_algorithm(range->algorithm)) {
      EXPECT_EQ(code, AbortCode::no_such_sub_index);
      return;
    }
    EXPECT_EQ(code, AbortCode::none) << std::hex << entry.address.index << ':' << int{entry.address.sub};
    ++count;
  });
  EXPECT_GT(count, 500U);
}

TEST(Objects, HaveTheIdentityOfTheModule) {
  test::TestModule robot;
  robot.boot();
  EXPECT_EQ(robot.bus.value(node, object::product), 1U);
  EXPECT_EQ(robot.bus.value(node, object::board_id), 1U);
  EXPECT_EQ(robot.bus.value(node, object::core_fingerprint), 0xC0DEC0DEU);
  EXPECT_EQ(robot.bus.value(node, object::unique_id.address(0)), 1U);
  EXPECT_EQ(robot.bus.value(node, object::unique_id.address(1)), 0x12345678U);
  EXPECT_EQ(robot.bus.value(node, object::unique_id.address(2)), 0x9ABCDEF0U);
  // CRC-32 of 01 00 00 00 78 56 34 12 F0 DE BC 9A, by zlib.
  EXPECT_EQ(robot.bus.value(node, object::serial), 0x03D0C882U);
  EXPECT_EQ(robot.bus.value(node, object::capabilities), 0U);
  EXPECT_EQ(robot.bus.value(node, object::error_register), 0U);
  EXPECT_EQ(robot.bus.value(node, object::sync_identifier), 0x80U);
}

TEST(Objects, HaveTheNamesAndVersionsOfTheModuleAsTexts) {
  test::TestModule robot;
  robot.boot();
  // Values are read in segments, and as a block if they are long enough.
  for (const auto largest_segmented : std::to_array<std::uint8_t>({255, 21, 4})) {
    canopen::SdoTransferOptions options;
    options.largest_segmented = largest_segmented;
    std::string text;
    EXPECT_EQ(robot.bus.read_text(node, {0x1008, 0}, text, options), AbortCode::none);
    EXPECT_EQ(text, "Proleg joint module");
    EXPECT_EQ(robot.bus.read_text(node, {0x1009, 0}, text, options), AbortCode::none);
    EXPECT_EQ(text, "board 1");
    EXPECT_EQ(robot.bus.read_text(node, {0x100A, 0}, text, options), AbortCode::none);
    EXPECT_EQ(text, "protocol 1.0, core C0DEC0DE");
  }
  std::string text;
  EXPECT_EQ(robot.bus.read_text(node, {0x100B, 0}, text), AbortCode::no_such_object);
}

TEST(Objects, ATransferThatTheHostDoesNotContinueIsAborted) {
  test::TestModule robot;
  robot.boot();
  const auto begin = [&] {
    robot.bus.deliver({0x605, 8, {0x40, 0x08, 0x10, 0x00}});
    robot.bus.run_for(1'000);
    ASSERT_EQ(robot.bus.log.back().frame, (CanFrame{0x585, 8, {0x41, 0x08, 0x10, 0x00, 19, 0, 0, 0}}));
  };
  begin();
  const std::size_t from = robot.bus.log.size();
  robot.bus.run_for(990'000);
  EXPECT_EQ(robot.bus.log.size(), from);
  robot.bus.run_for(20'000);
  ASSERT_EQ(robot.bus.log.size(), from + 1);
  EXPECT_EQ(robot.bus.log.back().frame, (CanFrame{0x585, 8, {0x80, 0x08, 0x10, 0x00, 0x00, 0x00, 0x04, 0x05}}));
  // The transfer ends without a frame if the module is stopped or reset meanwhile.
  for (const NmtCommand command : {NmtCommand::stop, NmtCommand::reset_node}) {
    begin();
    robot.command(command);
    robot.bus.run_for(20'000);
    robot.command(NmtCommand::enter_pre_operational);
    const std::size_t after = robot.bus.log.size();
    robot.bus.run_for(2'000'000);
    EXPECT_EQ(robot.bus.log.size(), after);
  }
}

TEST(Objects, ABlockDoesNotFillTheQueue) {
  test::TestModule robot;
  robot.set_up_and_start();
  robot.bus.deliver({0x605, 8, {0xA0, 0x0A, 0x10, 0x00, 127}});
  robot.bus.deliver({0x605, 8, {0xA3}});
  robot.bus.run_for(100'000);
  EXPECT_EQ(robot.bus.sent(0x585).back().frame.data[0], 4U | 0x80U) << "all four segments";
  EXPECT_EQ(robot.module().dropped_frames(), 0U);
}

TEST(Objects, ReadBackWhatTheSetUpWrites) {
  test::TestModule robot(two_slots());
  const Setting values[] = {{0, 0, 1, false, test::degrees(12)}, {2, 0, 2, false, test::hertz(0.25)}};
  robot.setup.start_values = values;
  robot.limit(0, test::degrees(-20), test::degrees(50));
  robot.boot();
  robot.configure(0);
  const canopen::SetupList list(robot.setup, 0);
  for (std::size_t i = 0; i < list.size(); ++i) {
    const canopen::SdoRequest write = list.at(i);
    EXPECT_EQ(robot.bus.value(node, write.address), write.value) << std::hex << write.address.index;
  }
  EXPECT_EQ(robot.bus.value(node, object::configuration_crc), robot.crc());
}

TEST(Objects, TheConfigurationCrcIsTheSameInAllModulesOfARobotOnly) {
  test::TestRobot robot(two_slots());
  robot.set_up();
  const std::uint32_t crc = canopen::configuration_crc(robot.setup);
  for (unsigned joint = 0; joint < robot.joints(); ++joint) {
    EXPECT_EQ(robot.bus.value(robot.node(joint), object::configuration_crc), crc);
  }
  robot.setup.kernel.seed ^= 1;
  robot.configure(3);
  EXPECT_NE(robot.bus.value(robot.node(3), object::configuration_crc), crc);
}

TEST(Objects, AnEntryThatDoesNotExistIsRejected) {
  test::TestModule robot;
  robot.set_up_and_start();
  std::uint32_t value = 0;
  EXPECT_EQ(robot.bus.read(node, {0x1002, 0}, value), AbortCode::no_such_object);
  EXPECT_EQ(robot.bus.read(node, {0x2001, 99}, value), AbortCode::no_such_sub_index);
  EXPECT_EQ(robot.bus.write(node, {0x3FFF, 1}, 4, 0), AbortCode::no_such_object);
  // docs/protocol.md has the answer for node 3.
  robot.bus.deliver({0x605, 8, {0x23, 0x80, 0x4F, 0x01, 0x8E, 0xE3, 0x38, 0x0E}});
  robot.bus.run_for(1'000);
  EXPECT_EQ(robot.bus.log.back().frame, (CanFrame{0x585, 8, {0x80, 0x80, 0x4F, 0x01, 0x00, 0x00, 0x02, 0x06}}));
}

TEST(Objects, AValueOutOfRangeIsRejectedAndChangesNothing) {
  test::TestModule robot;
  robot.boot();
  EXPECT_EQ(robot.bus.write(node, object::tick_period, 999), AbortCode::below_minimum);
  EXPECT_EQ(robot.bus.write(node, object::joint_count, 65), AbortCode::above_maximum);
  EXPECT_EQ(robot.bus.value(node, object::tick_period), 10'000U);
  EXPECT_EQ(robot.bus.write(node, object::slot_algorithm.address(0), 1, 127), AbortCode::out_of_range);
  EXPECT_EQ(robot.bus.value(node, object::slot_algorithm.address(0)), 0U);
  robot.configure(0);
  const canopen::Address amplitude = test::parameter_address(robot.kernel(), 0, "amplitude");
  EXPECT_EQ(robot.bus.write(node, amplitude, 4, static_cast<std::uint32_t>(test::degrees(-1))),
            AbortCode::below_minimum);
  EXPECT_EQ(robot.bus.write(node, amplitude, 2, 0), AbortCode::wrong_length);
}

/// Settings that the kernel rejects, and for each the write that makes a good set-up wrong.
struct Refusal {
  canopen::Address address;
  std::uint8_t size;
  std::uint32_t value;
  AbortCode code;
  Status status;
};
class Refused : public testing::TestWithParam<Refusal> {};
INSTANTIATE_TEST_SUITE_P(
    Settings, Refused,
    testing::Values(
        Refusal{object::joint_index.address, 1, 5, AbortCode::refused_by_application, Status::bad_local_joints},
        Refusal{object::slot_group_low.address(0), 4, 0x3F, AbortCode::refused_by_application, Status::bad_group},
        Refusal{object::slot_algorithm.address(3), 1, 2, AbortCode::refused_by_application,
                Status::too_many_broadcasts},
        Refusal{object::state_frame_identifier[0].address(1), 4, canopen::identifier::state_frame + 9U,
                AbortCode::general_incompatibility, Status::ok},
        Refusal{object::state_frame_identifier[0].address(1), 4, canopen::identifier::state_frame + node,
                AbortCode::general_incompatibility, Status::ok}));

TEST_P(Refused, LeavesTheModuleUnconfigured) {
  KernelConfiguration three = two_slots();
  three.slots[3] = {&test::algorithm(test::direct), JointMask(0b00001)};
  test::TestModule robot(three);
  robot.boot();
  robot.configure(0);
  ASSERT_EQ(robot.bus.write(node, GetParam().address, GetParam().size, GetParam().value), AbortCode::none);
  EXPECT_EQ(robot.bus.value(node, object::activate), 1U);  // the value has no effect yet
  EXPECT_EQ(robot.bus.write(node, object::activate, 1), GetParam().code);
  EXPECT_EQ(robot.bus.value(node, object::activate), 0U);
  EXPECT_EQ(robot.bus.value(node, object::refusal), static_cast<std::uint32_t>(GetParam().status));
  EXPECT_EQ(robot.bus.value(node, object::configuration_crc), 0U);
  robot.command(NmtCommand::start);
  robot.bus.run_for(1'000);
  EXPECT_EQ(robot.module().state(), NmtState::pre_operational);
  ASSERT_EQ(robot.emergencies().size(), 1U);
  EXPECT_EQ(robot.emergencies()[0].code, canopen::EmergencyCode::not_configured);
  EXPECT_EQ(robot.emergencies()[0].detail, static_cast<std::uint32_t>(GetParam().status));
  // A good set-up configures the module again.
  robot.configure(0);
  robot.command(NmtCommand::start);
  EXPECT_EQ(robot.module().state(), NmtState::operational);
}

TEST(Objects, EveryRefusalOfTheKernelHasAnAbortCode) {
  using firmware::abort_code_of;
  EXPECT_EQ(abort_code_of(Status::ok), AbortCode::none);
  for (unsigned status = 1; status <= static_cast<unsigned>(Status::commit_in_the_past); ++status) {
    EXPECT_NE(abort_code_of(static_cast<Status>(status)), AbortCode::none);
  }
  EXPECT_EQ(abort_code_of(Status::bad_tick_period), AbortCode::refused_by_application);
  EXPECT_EQ(abort_code_of(Status::unknown_parameter), AbortCode::no_such_object);
  EXPECT_EQ(abort_code_of(Status::unknown_joint), AbortCode::no_such_sub_index);
  EXPECT_EQ(abort_code_of(Status::out_of_range), AbortCode::out_of_range);
  EXPECT_EQ(abort_code_of(Status::staging_closed), AbortCode::refused_by_state);
}

TEST(Objects, ActivateZeroLeavesTheModuleUnconfigured) {
  test::TestModule robot;
  robot.boot();
  robot.configure(0);
  EXPECT_EQ(robot.bus.write(node, object::activate, 0), AbortCode::none);
  robot.command(NmtCommand::start);
  EXPECT_EQ(robot.module().state(), NmtState::pre_operational);
}

TEST(Objects, TheConfigurationOfTheRobotIsWritableInPreOperationalOnly) {
  test::TestModule robot(two_slots());
  const Setting values[] = {{0, 0, 1, false, test::degrees(12)}};
  robot.setup.start_values = values;
  robot.set_up_and_start();
  const canopen::SetupList list(robot.setup, 0);
  unsigned refused = 0;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const canopen::SdoRequest write = list.at(i);
    const AbortCode code = robot.bus.write(node, write.address, write.size, write.value);
    const bool always = write.address == object::host_heartbeat.address ||
                        write.address == object::heartbeat_period.address ||
                        write.address == object::sync_counter_overflow.address;
    EXPECT_EQ(code, always ? AbortCode::none : AbortCode::refused_by_state) << std::hex << write.address.index;
    refused += always ? 0 : 1;
  }
  EXPECT_EQ(refused, list.size() - 3);
}

TEST(Objects, ParametersAndLimitsNeedAConfiguration) {
  test::TestModule robot;
  robot.boot();
  const canopen::Address parameter = canopen::address_of({ValueKind::parameter, 2, 0, 0});
  std::uint32_t value = 0;
  EXPECT_EQ(robot.bus.write(node, parameter, 4, 0), AbortCode::refused_by_state);
  EXPECT_EQ(robot.bus.read(node, parameter, value), AbortCode::refused_by_state);
  EXPECT_EQ(robot.bus.write(node, object::lower_limit, 0), AbortCode::refused_by_state);
  EXPECT_EQ(robot.bus.write(node, object::transaction, 1), AbortCode::refused_by_state);
}

TEST(Objects, ParametersOfAnAlgorithmThatIsNotInTheSlotDoNotExist) {
  test::TestModule robot(two_slots());
  robot.boot();
  robot.configure(0);
  const std::uint8_t sine = test::algorithm(test::sinusoidal).declaration().id;
  const std::uint8_t coupled = test::algorithm(test::coupled).declaration().id;
  for (const ValueKind kind : {ValueKind::parameter, ValueKind::staged_parameter, ValueKind::internal_value}) {
    EXPECT_EQ(robot.bus.write(node, canopen::address_of({kind, sine, 0, 0}), 4, 0), AbortCode::no_such_sub_index);
    EXPECT_EQ(robot.bus.write(node, canopen::address_of({kind, coupled, 0, 1}), 4, 0), AbortCode::no_such_sub_index);
  }
  EXPECT_EQ(robot.bus.value(node, object::refusal), static_cast<std::uint32_t>(Status::unknown_slot));
}

TEST(Objects, LimitsOutOfOrderAreRejected) {
  test::TestModule robot;
  robot.boot();
  robot.configure(0);
  EXPECT_EQ(robot.bus.write(node, object::upper_limit, static_cast<std::uint32_t>(test::degrees(-10))),
            AbortCode::none);
  EXPECT_EQ(robot.bus.write(node, object::lower_limit, 0), AbortCode::general_incompatibility);
  EXPECT_EQ(robot.bus.value(node, object::refusal), static_cast<std::uint32_t>(Status::bad_limits));
  EXPECT_EQ(robot.bus.value(node, object::lower_limit), static_cast<std::uint32_t>(-quarter_turn));
}

TEST(Objects, AnotherConfigurationHasNoLimitsAndDefaultParameters) {
  test::TestModule robot;
  robot.boot();
  robot.configure(0);
  const canopen::Address offset = test::parameter_address(robot.kernel(), 0, "offset");
  ASSERT_EQ(robot.bus.write(node, offset, 4, 77), AbortCode::none);
  ASSERT_EQ(robot.bus.write(node, object::lower_limit, 0), AbortCode::none);
  ASSERT_EQ(robot.bus.write(node, object::activate, 1), AbortCode::none);
  EXPECT_EQ(robot.bus.value(node, object::lower_limit), static_cast<std::uint32_t>(-quarter_turn));
  EXPECT_EQ(robot.bus.value(node, offset), 0U);
}

TEST(Objects, StateZeroFollowsFromTheParametersWritten) {
  test::TestModule robot;
  robot.boot();
  robot.configure(0);
  ASSERT_EQ(robot.bus.write(node, test::parameter_address(robot.kernel(), 0, "offset"), 4,
                            static_cast<std::uint32_t>(test::degrees(15))),
            AbortCode::none);
  KernelOf<1> expected;
  ASSERT_EQ(expected.configure(robot.setup.kernel, 0), Status::ok);
  test::set(expected, 0, 0, "offset", test::degrees(15));
  expected.reset();
  robot.command(NmtCommand::start);
  EXPECT_EQ(robot.kernel().setpoint(0), expected.setpoint(0));
  EXPECT_EQ(robot.kernel().frame(0, 0), std::as_const(expected).frame(0, 0));
}

TEST(Objects, ShowTheStateAndTheFrames) {
  test::TestRobot robot(two_slots(100'000));
  robot.drive();
  robot.run_to(20);
  robot.bus.run_for(10'000);
  const Kernel& kernel = robot.kernel(0);
  const auto word = [](const StateFrame& frame, unsigned half) {
    std::uint32_t value = 0;
    for (unsigned byte = 0; byte < 4; ++byte) {
      value |= std::uint32_t{frame.bytes[half * 4 + byte]} << (8 * byte);
    }
    return value;
  };
  EXPECT_EQ(robot.bus.value(node, object::current_tick), 21U);
  for (unsigned half = 0; half < 2; ++half) {
    EXPECT_EQ(robot.bus.value(node, object::own_frame[0][half]), word(kernel.frame(0, 0), half));
    EXPECT_EQ(robot.bus.value(node, object::own_frame[1][half]), word(kernel.frame(0, 1), half));
    EXPECT_EQ(robot.bus.value(node, object::received_frame[0][half].address(1)),
              word(std::as_const(robot.kernel(1)).frame(1, 0), half));
    EXPECT_EQ(robot.bus.value(node, object::received_frame[0][half].address(4)), 0U) << "nothing depends on joint 4";
    EXPECT_EQ(robot.bus.value(node, object::received_frame[1][half].address(1)),
              word(std::as_const(robot.kernel(1)).frame(1, 1), half));
  }
  EXPECT_EQ(robot.bus.value(node, test::parameter_address(kernel, 0, "current_phase", ValueKind::internal_value)),
            static_cast<std::uint32_t>(kernel.internal_value(0, 0, 0)));
}

}  // namespace
}  // namespace proleg
