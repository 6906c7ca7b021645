#include "host/dynamixel/chain_settings.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

namespace proleg::host {
namespace {

struct Parameter {
  const char* name;
  const char* value;
  std::uint32_t joint = PROLEG_ALL_JOINTS;
};

ChainSettings read(std::vector<Parameter> entries, std::uint32_t tick_us = 10'000) {
  const std::vector<proleg_joint> joints{{"J2", -90.0, 90.0, 300.0}, {"J1", -45.0, 60.0, 300.0}};
  std::vector<proleg_parameter> parameters;
  for (const Parameter& entry : entries) {
    parameters.push_back({entry.name, entry.value, entry.joint, static_cast<std::uint32_t>(parameters.size() + 10)});
  }
  proleg_setup setup{};
  setup.size = sizeof setup;
  setup.tick_us = tick_us;
  setup.joint_count = 2;
  setup.joints = joints.data();
  setup.parameter_count = static_cast<std::uint32_t>(parameters.size());
  setup.parameters = parameters.data();
  return read_chain_settings(setup);
}

/// "LINE: found ..., expected ..."
std::string error_of(const std::vector<Parameter>& entries, std::uint32_t tick_us = 10'000) {
  try {
    static_cast<void>(read(entries, tick_us));
  } catch (const SettingError& error) {
    return std::to_string(error.line()) + ": " + error.what();
  }
  return {};
}

const Parameter device{"device", "/dev/ttyUSB0"};

TEST(ChainSettings, HaveDefaults) {
  const ChainSettings settings = read({device}, 20'000);
  EXPECT_EQ(settings.device, "/dev/ttyUSB0");
  EXPECT_EQ(settings.rate, 57'600U);
  EXPECT_EQ(settings.watchdog, 10U);
  EXPECT_EQ(settings.servos[0].joint, "J2");
  EXPECT_EQ(settings.servos[0].id, 1);
  EXPECT_EQ(settings.servos[1].id, 2);
  EXPECT_EQ(settings.servos[1].lower_limit_deg, -45.0);
}

TEST(ChainSettings, AValueOfAJointReplacesThatOfAllJoints) {
  const ChainSettings settings = read({device,
                                       {"offset", "3.5", 1},
                                       {"offset", "-2"},
                                       {"id", "252", 0},
                                       {"direction", "-1"},
                                       {"lower_limit", "-50"},
                                       {"watchdog", "101"},
                                       {"baud", "4000000"}});
  EXPECT_EQ(settings.servos[0].offset_deg, -2.0);
  EXPECT_EQ(settings.servos[1].offset_deg, 3.5);
  EXPECT_EQ(settings.servos[0].id, 252);
  EXPECT_TRUE(settings.servos[1].is_reversed);
  EXPECT_EQ(settings.servos[0].lower_limit_deg, -50.0);
  EXPECT_EQ(settings.servos[1].lower_limit_deg, -45.0);  // that of the joint is narrower
  EXPECT_EQ(settings.watchdog, 6U);                      // 120 ms
  EXPECT_EQ(settings.rate, 4'000'000U);
}

TEST(ChainSettings, ThatAreWrongAreNamedWithTheirLine) {
  EXPECT_EQ(error_of({}), "0: found no parameter 'device', expected a serial port such as /dev/ttyUSB0");
  EXPECT_EQ(error_of({{"device", ""}}), "10: found device '', expected a serial port such as /dev/ttyUSB0");
  EXPECT_EQ(error_of({device, {"bauds", "1"}}),
            "11: found unknown parameter 'bauds', expected baud, device, direction, id, lower_limit, offset, "
            "upper_limit or watchdog");
  EXPECT_EQ(error_of({device, {"baud", "38400"}}),
            "11: found baud '38400', expected one of 9600, 57600, 115200, 1000000, 2000000, 3000000, 4000000, as in "
            "Baud Rate(8) of the servos");
  EXPECT_EQ(error_of({device, {"baud", "57600", 0}}), "11: found baud of one joint, expected one for the whole robot");
  EXPECT_EQ(error_of({device, {"id", "253", 0}}), "11: found id '253', expected a whole number from 0 to 252");
  EXPECT_EQ(error_of({device, {"id", "3"}}),
            "11: found an id for all joints, expected an attribute 'joint', because each servo has its own");
  EXPECT_EQ(error_of({device, {"id", "1", 1}}),
            "0: found id 1 for the joints J2 and J1, expected another id for each joint");
  EXPECT_EQ(error_of({device, {"direction", "2"}}),
            "11: found direction '2', expected 1, or -1 if the servo turns the joint the other way");
  EXPECT_EQ(error_of({device, {"offset", "nan"}}),
            "11: found offset 'nan', expected a number from -180 to 180 degrees");
  EXPECT_EQ(error_of({device, {"watchdog", "0"}}),
            "11: found watchdog '0', expected a whole number from 20 to 2540 ms");
  EXPECT_EQ(
      error_of({device, {"offset", "120", 0}}),
      "0: found joint J2 with the limit 90 and the offset 120 degrees, which is position 4437, expected 0 to 4095: "
      "mount the horn so that the offset is near 0");
}

TEST(ChainSettings, ALineThatIsTooSlowIsNamedWithARateThatIsNot) {
  // Two goal positions are 24 bytes and an answer is 46 bytes with its request: 12.2 ms at 57600 baud.
  EXPECT_EQ(error_of({device}, 5'000),
            "0: found 57600 baud for 2 servos in a tick of 5 ms, expected at least 1000000 baud (Baud Rate(8) of the "
            "servos and the parameter 'baud'), or a longer tick");
}

TEST(ServoSettings, TurnAnglesIntoPositions) {
  ServoSettings servo;
  EXPECT_EQ(servo.position_of(0.0), 2048);
  EXPECT_EQ(servo.position_of(90.0), 3072);
  EXPECT_EQ(servo.position_of(-90.0), 1024);
  EXPECT_EQ(servo.position_of(0.5 * 90.0 / 1024.0), 2049);   // half a step: up
  EXPECT_EQ(servo.position_of(-0.5 * 90.0 / 1024.0), 2048);  // half a step: up
  servo.is_reversed = true;
  EXPECT_EQ(servo.position_of(90.0), 1024);
  servo.offset_deg = 45.0;
  EXPECT_EQ(servo.position_of(90.0), 1536);
  EXPECT_EQ(servo.angle_of(1536), 90.0);
}

}  // namespace
}  // namespace proleg::host
