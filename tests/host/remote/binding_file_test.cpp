#include "host/remote/binding.hpp"

#include <gtest/gtest.h>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/output/output.hpp"
#include "tests/support/files.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/temporary_folder.hpp"

namespace proleg::host {
namespace {

const std::vector<Binding> stop_button{{"Pad", "BTN_EAST", RemoteAction::stop}};

class Store : public testing::Test {
 protected:
  const TemporaryFolder folder;
  const std::filesystem::path path = folder / "robot.remote.json";
};

TEST_F(Store, BeginsWithoutAFile) {
  const BindingStore store(path);
  EXPECT_TRUE(store.read_bindings().empty());
  EXPECT_TRUE(store.has({}));
  EXPECT_FALSE(store.has(stop_button));
}

TEST_F(Store, KeepsBindingsForTheNextStart) {
  BindingStore store(path);
  store.save(stop_button);
  EXPECT_TRUE(store.has(stop_button));
  const BindingStore next(path);
  EXPECT_TRUE(next.has(stop_button));
  EXPECT_EQ(folder.names(), std::vector<std::string>{"robot.remote.json"});
}

TEST_F(Store, WritesNothingOverAFileThatSomebodyElseHasChanged) {
  BindingStore store(path);
  write_file(path, "mine");
  EXPECT_EQ(message_of<std::runtime_error>([&] { store.save(stop_button); }),
            path.string() + ": somebody has changed the file meanwhile; nothing was written");
  EXPECT_EQ(file_contents(path), "mine");
}

TEST_F(Store, RefusesAFileThatIsNone) {
  write_file(path, "mine");
  EXPECT_EQ(message_of<InputError>([&] { const BindingStore store(path); }),
            path.string() + ":1: found text that is not JSON, expected an object in JSON");
  EXPECT_NE(message_of<InputError>([&] { const BindingStore store(folder.path()); }), "");
}

TEST_F(Store, SavesNothingWithoutAScenario) {
  BindingStore store;
  EXPECT_NE(message_of<std::runtime_error>([&] { store.save(stop_button); }), "");
}

constexpr const char* pad = R"({"version": 1, "bindings": [
  {"device": "Pad", "element": "ABS_Y", "parameters": ["amplitude", "2.frequency:J2"], "method": "linear",
   "lower": 50, "upper": 10, "step": 0.5, "dead_zone": 0.1, "curve": 2, "take_up": false},
  {"device": "Pad", "element": "BTN_SOUTH", "action": "hold_to_run"}]})";

std::string refusal(const std::string& text) {
  return message_of<InputError>([&] { static_cast<void>(read_bindings(text, "a.remote.json")); });
}

/// A file with one binding, with a field replaced or added.
std::string with(const std::string& name, const nlohmann::json& value) {
  nlohmann::json binding{{"device", "Pad"}, {"element", "ABS_X"}, {"parameters", {"amplitude"}},
                         {"lower", 0},      {"upper", 50},        {"step", 1}};
  binding[name] = value;
  return nlohmann::json{{"version", 1}, {"bindings", {binding}}}.dump();
}

TEST(BindingFile, HasBindingsToParametersAndToActions) {
  const std::vector<Binding> bindings = read_bindings(pad, "pad");
  ASSERT_EQ(bindings.size(), 2U);
  EXPECT_EQ(bindings[0].device, "Pad");
  EXPECT_EQ(bindings[0].element, "ABS_Y");
  const auto& target = std::get<ParameterBinding>(bindings[0].target);
  EXPECT_EQ(target.parameters, (std::vector<std::string>{"amplitude", "2.frequency:J2"}));
  EXPECT_EQ(target.lower, 50);
  EXPECT_EQ(target.upper, 10);
  EXPECT_EQ(target.step, 0.5);
  EXPECT_EQ(target.dead_zone, 0.1);
  EXPECT_EQ(target.curve, 2);
  EXPECT_FALSE(target.take_up);
  EXPECT_EQ(std::get<RemoteAction>(bindings[1].target), RemoteAction::hold_to_run);
}

TEST(BindingFile, IsReadAsItWasWritten) {
  const std::string text = bindings_text(read_bindings(pad, "pad"));
  EXPECT_EQ(bindings_text(read_bindings(text, "again")), text);
}

TEST(BindingFile, LeavesOutWhatIsUsual) {
  const auto target = std::get<ParameterBinding>(read_bindings(with("step", 5), "pad")[0].target);
  EXPECT_EQ(target.dead_zone, 0);
  EXPECT_EQ(target.curve, 1);
  EXPECT_TRUE(target.take_up);
}

TEST(BindingFile, NamesTheLineOfBrokenText) {
  EXPECT_EQ(refusal("{\"version\": 1,\n\"bindings\": [}"),
            "a.remote.json:2: found text that is not JSON, expected an object in JSON");
}

TEST(BindingFile, NamesTheBindingAndWhatWasFound) {
  EXPECT_EQ(refusal(with("curve", 9)), "a.remote.json: binding 1: found 9, expected 0.2 to 5 in 'curve'");
  EXPECT_EQ(
      refusal(with("speed", 9)),
      "a.remote.json: binding 1: found field 'speed', expected some of device, element, action, parameters, method, "
      "lower, upper, step, dead_zone, curve, take_up");
  EXPECT_EQ(refusal(with("method", "cubic")), "a.remote.json: binding 1: found method 'cubic', expected linear");
  EXPECT_EQ(refusal(R"({"version": 1, "bindings": [{"device": "Pad", "element": "BTN_A", "action": "fly"}]})"),
            "a.remote.json: binding 1: found action 'fly', expected run, pause, step, restart, stop or hold_to_run");
}

TEST(BindingFile, RefusesValuesThatMeanNothing) {
  EXPECT_NE(refusal(with("step", 0)), "");
  EXPECT_NE(refusal(with("step", -1)), "");
  EXPECT_NE(refusal(with("step", 51)), "");
  EXPECT_NE(refusal(with("step", 1e-9)), "");
  EXPECT_NE(refusal(with("lower", 50)), "");
  EXPECT_NE(refusal(with("upper", 1e308)), "");
  EXPECT_NE(refusal(with("upper", "50")), "");
  EXPECT_NE(refusal(with("dead_zone", 1)), "");
  EXPECT_NE(refusal(with("take_up", 1)), "");
  EXPECT_NE(refusal(with("parameters", nlohmann::json::array())), "");
  EXPECT_NE(refusal(with("parameters", {"amplitude", "amplitude"})), "");
  EXPECT_NE(refusal(with("parameters", {"amplitude=3"})), "");
  EXPECT_NE(refusal(with("element", "")), "");
  EXPECT_NE(refusal(R"({"version": 2, "bindings": []})"), "");
  EXPECT_NE(refusal(R"({"bindings": []})"), "");
  EXPECT_NE(refusal(R"([])"), "");
  EXPECT_NE(refusal(""), "");
}

TEST(BindingFile, IsBesideTheScenario) {
  EXPECT_EQ(binding_file_of("runs/snake.simulation.xml"), "runs/snake.remote.json");
  EXPECT_EQ(binding_file_of("other.xml"), "other.xml.remote.json");
}

}  // namespace
}  // namespace proleg::host
