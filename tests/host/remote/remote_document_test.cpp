#include "host/remote/remote_document.hpp"

#include <gtest/gtest.h>

#include "obedient_robot.hpp"

#include "host/remote/binding_file.hpp"

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

}  // namespace
}  // namespace proleg::host
