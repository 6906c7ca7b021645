#include "host/robot_control/robot_control.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <condition_variable>
#include <limits>
#include <memory>
#include <mutex>
#include <thread>

#include "scripted_plugin.hpp"
#include "tests/support/message_of.hpp"

namespace proleg::host {
namespace {

using test::plugin_of;
using test::PluginScript;
using test::setup_of;

std::string attach_error(PluginScript& script) {
  return message_of<RobotControlError>([&] { const RobotControl control(plugin_of(script), setup_of(2), {}); });
}

std::string position_error(const std::vector<double>& values, std::uint32_t count = UINT32_MAX) {
  PluginScript script;
  script.values = values;
  script.count = count;
  RobotControl control(plugin_of(script), setup_of(2), {});
  return message_of<RobotControlError>([&] { static_cast<void>(control.request_information("position")); });
}

TEST(RobotControl, CallsTheFunctionsOfItsPluginAndDetachesIt) {
  PluginScript script;
  std::vector<std::string> shown;
  {
    RobotControl control(plugin_of(script), setup_of(2), [&](const std::string& line) { shown.push_back(line); });
    EXPECT_EQ(control.description().topology, "chain");
    control.connect();
    control.enable_servos(true);
    const std::vector<double> goals{1.0, -2.5};
    control.send_goal_positions(goals);
    EXPECT_EQ(control.request_information("position"), (std::vector<double>{0.0, 0.0}));
    control.send_command_by_value("led", 1.0);
    control.test();
    control.reset_command_buffer();
    script.count = 3;
    EXPECT_EQ(control.request_all_information(), (std::vector<std::uint8_t>{'x', 'x', 'x'}));
    control.disconnect();
  }
  EXPECT_EQ(script.goals, (std::vector<std::vector<double>>{{1.0, -2.5}}));
  EXPECT_EQ(script.calls, (std::vector<std::string>{"connect", "power on", "goal_position", "position", "led", "test",
                                                    "reset", "all", "disconnect", "disconnect", "close"}));
  EXPECT_EQ(shown, (std::vector<std::string>{"scripted: opened"}));
}

TEST(RobotControl, ARobotThatDiffersFromItsFileIsRefused) {
  PluginScript script;
  script.joints = 3;
  EXPECT_EQ(attach_error(script),
            "plug-in 'scripted': found a robot with 3 joints, expected the 2 of robot.xml; correct the file or its "
            "parameters");
  EXPECT_EQ(script.calls, (std::vector<std::string>{"close"}));
  script = {};
  script.joints = UINT32_MAX;
  EXPECT_NE(attach_error(script).find("4294967295 joints"), std::string::npos);
  script = {};
  script.sensor_modules = 2;
  script.sensors_per_module = 2;
  EXPECT_EQ(attach_error(script),
            "plug-in 'scripted': found 2 sensor modules with 2 sensors, expected none, or 3 with 2");
  script = {};
  script.upper_deg = std::nan("");
  EXPECT_EQ(attach_error(script),
            "plug-in 'scripted': found the limits -90 and nan degrees for joint 'J1', expected -360 to 0 and 0 to 360");
  script = {};
  script.lower_deg = 1.0;
  EXPECT_FALSE(attach_error(script).empty());
}

TEST(RobotControl, ATopologyWithoutAnEndIsCut) {
  PluginScript script;
  script.topology = std::string(200, 't');
  const RobotControl control(plugin_of(script), setup_of(2), {});
  EXPECT_EQ(control.description().topology.size(), 63U);  // 60 characters and "..."
}

TEST(RobotControl, AFileThatThePluginRejectsIsNamedWithItsLine) {
  PluginScript script;
  script.open_result = PROLEG_FAILED;
  script.error = "found device '', expected a serial port";
  script.error_line = 9;
  EXPECT_EQ(attach_error(script), "robot.xml:9: found device '', expected a serial port (plug-in 'scripted')");
  script.error_line = 0;
  EXPECT_EQ(attach_error(script), "robot.xml:7: found device '', expected a serial port (plug-in 'scripted')");
  script.open_result = 77;
  script.error = "";
  EXPECT_EQ(attach_error(script),
            "robot.xml:7: found parameters that the plug-in rejects without a reason (plug-in 'scripted')");
}

TEST(RobotControl, AnOpenWithoutARobotIsRefused) {
  PluginScript script;
  script.opens_nothing = true;
  EXPECT_EQ(attach_error(script), "plug-in 'scripted': opened no robot; report this to the author of the plug-in");
}

TEST(RobotControl, ValuesThatNoRobotHasAreRefused) {
  EXPECT_EQ(position_error({0.0}),
            "plug-in 'scripted': returned 1 values of 'position', expected 2, one for each joint");
  EXPECT_EQ(position_error({0.0, 0.0}, 1'000'000),
            "plug-in 'scripted': returned 1000000 values of 'position', expected 2, one for each joint");
  EXPECT_EQ(position_error({0.0, std::nan("")}),
            "plug-in 'scripted': returned nan as position of joint 'J2', expected -360 to 360 degrees");
  EXPECT_EQ(position_error({std::numeric_limits<double>::infinity(), 0.0}),
            "plug-in 'scripted': returned inf as position of joint 'J1', expected -360 to 360 degrees");
  EXPECT_EQ(position_error({0.0, -360.5}),
            "plug-in 'scripted': returned -360.5 as position of joint 'J2', expected -360 to 360 degrees");
  EXPECT_EQ(position_error({0.0, 0.0}), "");
}

TEST(RobotControl, ContactsAreOneValueForEachSensor) {
  PluginScript script;
  script.sensor_modules = 3;
  script.sensors_per_module = 2;
  script.values = {0, 1, 0, 0, 1, 1};
  RobotControl control(plugin_of(script), setup_of(2), {});
  EXPECT_EQ(control.request_information("contact").size(), 6U);
  script.values[4] = 2.0;
  EXPECT_EQ(message_of<RobotControlError>([&] { static_cast<void>(control.request_information("contact")); }),
            "plug-in 'scripted': returned 2 as contact of sensor 4, expected 0 to 1");
}

TEST(RobotControl, AFailureIsOneLineWhateverThePluginWrites) {
  PluginScript script;
  RobotControl control(plugin_of(script), setup_of(2), {});
  script.result = PROLEG_FAILED;
  script.error = "two\nlines \xFF";
  EXPECT_EQ(message_of<RobotControlError>([&] { control.connect(); }), "plug-in 'scripted': two lines ?");
  script.error = std::string(5000, 'x');  // without an end
  EXPECT_EQ(message_of<RobotControlError>([&] { control.connect(); }).size(), 20U + sizeof proleg_error::text);
  script.error = "";
  EXPECT_EQ(message_of<RobotControlError>([&] { control.test(); }), "plug-in 'scripted': test failed without a reason");
  script.result = -5;
  EXPECT_FALSE(message_of<RobotControlError>([&] { control.test(); }).empty());
  script.result = PROLEG_UNSUPPORTED;
  EXPECT_EQ(message_of<RobotControlError>([&] { control.send_command_by_value("led", 1.0); }),
            "plug-in 'scripted': does not support the command 'led'");
}

TEST(RobotControl, APluginThatDoesNotReturnIsGivenUp) {
  std::mutex mutex;
  std::condition_variable changed;
  bool may_return = false;
  PluginScript script;
  script.on_call = [&](const std::string& call) {
    if (call == "connect") {
      std::unique_lock lock(mutex);
      changed.wait(lock, [&] { return may_return; });
    }
  };
  // What the plug-in may use lives until its call returns, and this with it.
  auto used_by_plugin = std::make_shared<int>();
  const std::weak_ptr<int> is_used = used_by_plugin;
  {
    using std::chrono::milliseconds;
    RobotControl control(plugin_of(script), setup_of(2), [used = std::move(used_by_plugin)](const std::string&) {},
                         {milliseconds(20), milliseconds(1000), milliseconds(80)});
    EXPECT_EQ(message_of<RobotControlError>([&] { control.connect(); }),
              "plug-in 'scripted': did not return from connect within 100 ms, expected an end in 20 ms; it is not "
              "called again: switch the robot off, then report this to the author of the plug-in");
    EXPECT_TRUE(control.is_lost());
    EXPECT_FALSE(message_of<RobotControlError>([&] { control.enable_servos(true); }).empty());
  }
  EXPECT_TRUE(script.calls.empty());  // neither enable_servos() nor close() beside the call that runs
  EXPECT_FALSE(is_used.expired());
  {
    const std::lock_guard lock(mutex);
    may_return = true;
    changed.notify_all();
  }
  const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(5);
  while (!is_used.expired() && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  ASSERT_TRUE(is_used.expired());  // the variables of this test are not used any more
  EXPECT_EQ(script.calls, (std::vector<std::string>{"connect"}));
}

}  // namespace
}  // namespace proleg::host
