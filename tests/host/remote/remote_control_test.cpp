#include "host/remote/remote_control.hpp"

#include <gtest/gtest.h>

#include "host/remote/binding.hpp"
#include "obedient_robot.hpp"

namespace proleg::host {
namespace {

using nlohmann::json;

TEST(RemoteDocument, ListsDevicesBindingsAndProblems) {
  ObedientRobot robot;
  RemoteControl remote(robot);
  const json binding = json::parse(R"({"device": "Pad", "element": "ABS_X", "parameters": ["amplitude"],
    "method": "linear", "lower": 0, "upper": 100, "step": 1, "dead_zone": 0, "curve": 1, "take_up": true})");
  remote.set_bindings({read_binding(binding, "test")});
  remote.plugged({7, "Pad", {{"ABS_X", ElementKind::axis}, {"BTN_SOUTH", ElementKind::button}}, {0.5, 0}});
  remote.problems_changed({"a line"});
  remote.set_allowed(true);
  EXPECT_EQ(
      remote_document(remote),
      (json{{"devices",
             {{{"id", 7},
               {"name", "Pad"},
               {"elements", {{{"name", "ABS_X"}, {"kind", "axis"}}, {{"name", "BTN_SOUTH"}, {"kind", "button"}}}}}}},
            {"bindings", {binding}},
            {"problems", {"a line"}},
            {"learning", false},
            {"active", true}}));
  EXPECT_EQ(remote_values_document(remote), json::parse(R"({"devices": [{"id": 7, "positions": [0.5, 0.0]}],
                            "bindings": [{"value": 75.0, "taken": [false]}]})"));
}

TEST(RemoteDocument, HasNoValueOfABindingWithoutItsDevice) {
  ObedientRobot robot;
  RemoteControl remote(robot);
  remote.set_bindings({{"Pad", "ABS_X", ParameterBinding{{"amplitude"}, 0, 100, 1, 0, 1, true}}});
  EXPECT_EQ(remote_values_document(remote), json::parse(R"({"devices": [], "bindings": [null]})"));
}

constexpr RemoteTime tick{20};

class Remote : public testing::Test {
 protected:
  enum : std::size_t { x, y, south, east };

  Remote() {
    robot.values = {{"amplitude", 50}, {"frequency", 1}};
    remote.set_bindings(bindings(R"(
      {"device": "Pad", "element": "ABS_X", "parameters": ["amplitude"], "lower": 0, "upper": 100, "step": 1},
      {"device": "Pad", "element": "ABS_Y", "parameters": ["frequency"], "lower": 0, "upper": 2, "step": 0.1},
      {"device": "Pad", "element": "BTN_SOUTH", "action": "hold_to_run"},
      {"device": "Pad", "element": "BTN_EAST", "action": "stop"})"));
    remote.plugged(pad(1));
    remote.set_allowed(true);
    remote.advance(now);
  }

  static std::vector<Binding> bindings(const std::string& list) {
    return read_bindings(R"({"version": 1, "bindings": [)" + list + "]}", "pad");
  }
  static InputDevice pad(DeviceId id) {
    return {id,
            "Pad",
            {{"ABS_X", ElementKind::axis},
             {"ABS_Y", ElementKind::axis},
             {"BTN_SOUTH", ElementKind::button},
             {"BTN_EAST", ElementKind::button}},
            {0, 0, 0, 0}};
  }
  void pass(RemoteTime time) { remote.advance(now += time); }
  void move(std::size_t element, double position, DeviceId device = 1) { remote.moved({device, element}, position); }

  RemoteTime now{1000};
  ObedientRobot robot;
  RemoteControl remote{robot};
};

TEST_F(Remote, SetsWhatAnElementIsBoundTo) {
  move(x, 0.2);
  pass(RemoteTime{0});
  ASSERT_EQ(robot.sets.size(), 1U);
  EXPECT_EQ(robot.sets[0], std::vector<std::string>{"amplitude=60"});
}

TEST_F(Remote, SetsAtMostFiftyTimesASecondWithTheNewestValues) {
  for (int i = 0; i < 1000; ++i) {
    move(x, i % 2 == 0 ? 0.5 : -0.5);
    move(y, i % 2 == 0 ? 0.5 : -0.5);
    pass(RemoteTime{1});
    remote.set_answered("");
  }
  EXPECT_LE(robot.sets.size(), 50U);
  EXPECT_GE(robot.sets.size(), 45U);
  EXPECT_EQ(robot.sets.back().size(), 2U);
}

TEST_F(Remote, WaitsForARobotThatIsSlowAndThenSendsTheNewestValue) {
  for (int i = 1; i <= 10; ++i) {
    move(x, i / 20.0);
    pass(tick);
  }
  EXPECT_EQ(robot.sets.size(), 1U);
  remote.set_answered("");
  pass(tick);
  ASSERT_EQ(robot.sets.size(), 2U);
  EXPECT_EQ(robot.sets[1], std::vector<std::string>{"amplitude=75"});
}

TEST_F(Remote, GoesOnAfterASecondWithoutAnAnswer) {
  move(x, 0.2);
  pass(tick);
  move(x, 0.4);
  pass(ParameterChanges::answer_timeout);
  EXPECT_EQ(robot.sets.size(), 2U);
}

TEST_F(Remote, HasOneGestureWhileAnElementMoves) {
  for (const double position : {0.2, 0.4, 0.6}) {
    move(x, position);
    pass(tick);
    robot.values["amplitude"] = 50 + 50 * position;
    remote.set_answered("");
  }
  pass(ParameterChanges::gesture_pause);
  move(x, 0.8);
  pass(tick);
  ASSERT_EQ(robot.gestures.size(), 4U);
  EXPECT_EQ(robot.gestures[0], robot.gestures[2]);
  EXPECT_NE(robot.gestures[2], robot.gestures[3]);
}

TEST_F(Remote, HasNoEffectWhenNobodyHasControl) {
  remote.set_allowed(false);
  move(x, 0.9);
  move(south, 1);
  move(south, 0);
  pass(tick);
  EXPECT_TRUE(robot.sets.empty());
  EXPECT_EQ(robot.log, "");
}

TEST_F(Remote, MovesNothingWhenSomebodyTakesControl) {
  remote.set_allowed(false);
  move(x, 0.9);
  move(south, 1);
  remote.set_allowed(true);
  pass(tick);
  EXPECT_TRUE(robot.sets.empty());
  EXPECT_EQ(robot.log, "");
  move(x, 0.95);  // it has to pass the present value first
  pass(tick);
  EXPECT_TRUE(robot.sets.empty());
}

TEST_F(Remote, StopsAlwaysAlsoWithoutControlAndWhileItLearns) {
  remote.set_allowed(false);
  move(east, 1);
  move(east, 0);
  remote.set_allowed(true);
  remote.learn([](const auto& /*learned*/) {});
  move(east, 1);
  EXPECT_EQ(robot.log, "stop(Pad) stop(Pad) ");
}

TEST_F(Remote, RunsWhileAButtonIsHeld) {
  move(south, 1);
  EXPECT_EQ(robot.log, "run ");
  move(south, 0);
  EXPECT_EQ(robot.log, "run pause ");
}

TEST_F(Remote, PausesWhenTheHeldDeviceIsUnplugged) {
  move(south, 1);
  remote.unplugged(1);
  EXPECT_EQ(robot.log, "run pause ");
}

TEST_F(Remote, PausesWhenTheDriverGoesAway) {
  move(south, 1);
  remote.set_allowed(false);
  EXPECT_EQ(robot.log, "run pause ");
}

TEST_F(Remote, RunsAsLongAsOneOfTwoIsHeld) {
  remote.plugged(pad(2));
  move(south, 1);
  move(south, 1, 2);
  move(south, 0);
  EXPECT_EQ(robot.log, "run ");
  remote.unplugged(2);
  EXPECT_EQ(robot.log, "run pause ");
}

TEST_F(Remote, StopsARobotThatDoesNotPause) {
  move(south, 1);
  move(south, 0);
  remote.command_answered(RobotCommand::pause, false);
  EXPECT_EQ(robot.log, "run pause stop(hold-to-run: the robot has not paused) ");
}

TEST_F(Remote, StopsARobotThatDoesNotAnswer) {
  move(south, 1);
  move(south, 0);
  pass(RemoteButtons::pause_timeout);
  EXPECT_EQ(robot.log, "run pause stop(hold-to-run: the robot has not paused) ");
}

TEST_F(Remote, StopsNothingThatHasPaused) {
  move(south, 1);
  move(south, 0);
  remote.command_answered(RobotCommand::pause, true);
  pass(RemoteButtons::pause_timeout);
  EXPECT_EQ(robot.log, "run pause ");
}

TEST_F(Remote, LeavesARobotStoppedWhenAHeldButtonIsReleased) {
  move(south, 1);
  remote.robot_stopped();
  move(south, 0);
  EXPECT_EQ(robot.log, "run ");
  move(south, 1);
  EXPECT_EQ(robot.log, "run run ");
}

TEST_F(Remote, PausesARobotThatRunsAllTheSameAfterAStopThatCameWithThePress) {
  move(south, 1);
  remote.robot_stopped();
  robot.runs = true;
  remote.unplugged(1);
  EXPECT_EQ(robot.log, "run pause ");
}

TEST_F(Remote, RunsARobotOnTheTableOnlyWhileAButtonIsHeld) {
  remote.set_bindings(bindings(R"(
    {"device": "Pad", "element": "BTN_EAST", "action": "run"},
    {"device": "Pad", "element": "BTN_SOUTH", "action": "hold_to_run"})"));
  remote.require_hold(true);
  move(east, 1);
  EXPECT_EQ(robot.log, "");
  move(south, 1);
  EXPECT_EQ(robot.log, "run ");
}

TEST_F(Remote, RepeatsNothingOfADeviceThatHasGone) {
  move(x, 0.5);
  remote.unplugged(1);
  pass(tick);
  pass(ParameterChanges::answer_timeout);
  EXPECT_TRUE(robot.sets.empty());
  EXPECT_TRUE(remote.devices().empty());
}

TEST_F(Remote, HasNoEffectWhereADeviceIsWhenItComes) {
  InputDevice held = pad(2);
  held.positions = {1, 1, 1, 1};
  remote.plugged(held);
  pass(tick);
  EXPECT_TRUE(robot.sets.empty());
  EXPECT_EQ(robot.log, "");
  move(south, 0, 2);
  move(south, 1, 2);
  EXPECT_EQ(robot.log, "run ");
}

TEST_F(Remote, LearnsTheElementThatMovesClearly) {
  std::optional<RemoteControl::Learned> learned;
  remote.learn([&](const auto& element) { learned = element; });
  move(x, 0.3);
  EXPECT_FALSE(learned);
  move(y, -0.6);
  ASSERT_TRUE(learned);
  EXPECT_EQ(learned->device, "Pad");
  EXPECT_EQ(learned->element.name, "ABS_Y");
  EXPECT_FALSE(remote.is_learning());
}

TEST_F(Remote, LearnsAButtonByItsPress) {
  std::optional<RemoteControl::Learned> learned;
  remote.learn([&](const auto& element) { learned = element; });
  move(south, 1);
  ASSERT_TRUE(learned);
  EXPECT_EQ(learned->element.name, "BTN_SOUTH");
  EXPECT_EQ(robot.log, "");
}

TEST_F(Remote, DrivesNothingWhileItLearns) {
  remote.learn([](const auto& /*learned*/) {});
  move(x, 0.4);
  pass(tick);
  EXPECT_TRUE(robot.sets.empty());
}

TEST_F(Remote, LearnsForTenSecondsAtMost) {
  int answers = 0;
  remote.learn([&](const auto& learned) { answers += learned ? 100 : 1; });
  pass(ElementLearning::time_limit);
  EXPECT_EQ(answers, 1);
  move(x, 1);
  EXPECT_EQ(answers, 1);
}

TEST_F(Remote, LearnsOneAfterAnother) {
  int first = 0;
  int second = 0;
  remote.learn([&](const auto& learned) { first += learned ? 100 : 1; });
  remote.learn([&](const auto& learned) { second += learned ? 100 : 1; });
  move(x, 1);
  EXPECT_EQ(first, 1);
  EXPECT_EQ(second, 100);
}

TEST_F(Remote, ShowsWhyASetWasRefused) {
  remote.set_answered("amplitude=70: found 70, expected 0 to 60");
  EXPECT_EQ(remote.problems(), std::vector<std::string>{"amplitude=70: found 70, expected 0 to 60"});
  remote.set_answered("");
  EXPECT_TRUE(remote.problems().empty());
}

TEST_F(Remote, LetsGoOfABindingThatIsRemoved) {
  move(south, 1);
  remote.set_bindings({});
  EXPECT_EQ(robot.log, "run pause ");
}

TEST_F(Remote, HasAnAxisAsAButton) {
  remote.set_bindings(bindings(R"({"device": "Pad", "element": "ABS_Y", "action": "hold_to_run"})"));
  move(y, 0.6);
  move(y, 0.45);  // still held
  EXPECT_EQ(robot.log, "run ");
  move(y, 0.3);
  EXPECT_EQ(robot.log, "run pause ");
}

}  // namespace
}  // namespace proleg::host
