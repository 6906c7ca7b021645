#include "tools/proleg/ui/parameter_words.hpp"

#include <gtest/gtest.h>

#include "shared/computer/errors/input_error.hpp"
#include "tests/support/message_of.hpp"

namespace proleg::tools {
namespace {

using nlohmann::json;

json parameter(unsigned slot, const char* name, const std::vector<unsigned>& joints, const std::vector<int>& wanted) {
  return {{"slot", slot},   {"name", name},   {"internal", false}, {"scale", 0.5},    {"minimum", 0},
          {"maximum", 180}, {"wraps", false}, {"joints", joints},  {"wanted", wanted}};
}

class Words : public testing::Test {
 protected:
  Words() {
    words.set_robot({{"joints", {{{"name", "J1"}}, {{"name", "J2"}}, {{"name", "J3"}}}},
                     {"slots", {{{"number", 1}, {"algorithm", "sine"}}, {{"number", 2}, {"algorithm", "kick"}}}}});
    json state = parameter(1, "phase", {0, 1}, {});
    state["internal"] = true;
    words.set_parameters({parameter(1, "amplitude", {0, 1}, {40, 60}), parameter(2, "amplitude", {2}, {80}),
                          parameter(2, "delay", {2}, {4}), state});
  }
  std::string refusal(const std::string& name) {
    return message_of<InputError>([&] { static_cast<void>(words.find(name)); });
  }

  ParameterWords words;
};

TEST_F(Words, MeanAParameterOfAModuleAndAJoint) {
  EXPECT_EQ(words.find("delay").wanted, 2);
  EXPECT_EQ(words.find("1.amplitude").wanted, 20);
  EXPECT_EQ(words.find("kick.amplitude").wanted, 40);
  EXPECT_EQ(words.find("1.amplitude:J2").wanted, 30);
  EXPECT_EQ(words.find("amplitude:J3").wanted, 40);
  EXPECT_EQ(words.find("delay").minimum, 0);
  EXPECT_EQ(words.find("delay").maximum, 90);
}

TEST_F(Words, AreRefusedWithWhatIsThere) {
  EXPECT_EQ(refusal("speed"), "speed: found no such parameter, expected one of 1.amplitude, 2.amplitude, 2.delay");
  EXPECT_EQ(refusal("amplitude"),
            "amplitude: found a name in several modules, expected one of 1.amplitude, 2.amplitude");
  EXPECT_EQ(refusal("1.amplitude:J3"), "1.amplitude:J3: found joint 'J3', expected one that the module drives");
  EXPECT_EQ(refusal("1.amplitude:J9"), "1.amplitude:J9: found joint 'J9', expected one that the module drives");
  EXPECT_NE(refusal("phase"), "");
  EXPECT_NE(refusal(""), "");
}

TEST_F(Words, OfABindingMustBeThereWithItsLimits) {
  const auto message = [&](const std::string& name, double upper) {
    return message_of<InputError>([&] {
      check_binding({"Pad", "ABS_X", host::ParameterBinding{{name}, 0, upper, 1, 0, 1, true}}, words, "binding 3");
    });
  };
  EXPECT_EQ(message("delay", 90), "");
  EXPECT_EQ(message("delay", 91), "binding 3: delay: found limit 91, expected 0 to 90");
  EXPECT_EQ(message("speed", 1),
            "binding 3: speed: found no such parameter, expected one of 1.amplitude, 2.amplitude, 2.delay");
  check_binding({"Pad", "BTN_EAST", host::RemoteAction::stop}, words, "binding 4");
}

TEST(WordsWithoutARobot, MeanNothing) {
  EXPECT_NE(message_of<InputError>([] { static_cast<void>(ParameterWords{}.find("amplitude:J1")); }), "");
}

}  // namespace
}  // namespace proleg::tools
