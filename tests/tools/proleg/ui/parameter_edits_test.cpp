#include "tools/proleg/ui/parameter_edits.hpp"

#include <gtest/gtest.h>

#include "shared/computer/errors/input_error.hpp"
#include "shipped.hpp"
#include "sim/scenario/settings.hpp"
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

class ParameterEditsTest : public ::testing::Test {
 protected:
  /// As wanted, of every place.
  std::vector<std::int32_t> wanted() const {
    std::vector<std::int32_t> values;
    for (const ParameterPlace& place : edits.parameters().places()) {
      values.push_back(edits.parameters().at(place).wanted);
    }
    return values;
  }

  sim::Scenario file = sim::shipped("travelling_wave/uniform");
  ParameterEdits edits{file, file};
  const std::vector<std::int32_t> of_file = wanted();
};

TEST_F(ParameterEditsTest, AreUndoneAndRedone) {
  EXPECT_FALSE(edits.undo());
  edits.set({"amplitude=30"}, {});
  edits.set({"amplitude:J2=20", "offset:J3=5"}, {});
  const std::vector<std::int32_t> last = wanted();
  EXPECT_TRUE(edits.differs_from_file());
  EXPECT_TRUE(edits.undo());
  EXPECT_TRUE(edits.undo());
  EXPECT_FALSE(edits.undo());
  EXPECT_EQ(wanted(), of_file);
  EXPECT_FALSE(edits.differs_from_file());
  EXPECT_TRUE(edits.redo());
  EXPECT_TRUE(edits.redo());
  EXPECT_EQ(wanted(), last);
}

TEST_F(ParameterEditsTest, AGestureIsOneEntry) {
  for (int value = 1; value <= 40; ++value) {
    edits.set({"amplitude=" + std::to_string(value)}, 7);
  }
  EXPECT_TRUE(edits.undo());
  EXPECT_EQ(wanted(), of_file);
}

TEST_F(ParameterEditsTest, ABadWordChangesNothing) {
  EXPECT_THROW(edits.set({"amplitude=30", "amplitude:J9=20"}, {}), InputError);
  EXPECT_THROW(edits.set({"amplitude=3000"}, {}), InputError);
  EXPECT_THROW(edits.set({"amplitude=30@5"}, {}), InputError);
  EXPECT_THROW(edits.set({}, {}), InputError);
  EXPECT_EQ(wanted(), of_file);
  EXPECT_EQ(edits.history().to_undo(), nullptr);
}

TEST_F(ParameterEditsTest, AreResetByNameOrAltogether) {
  edits.set({"amplitude=30"}, {});
  edits.set({"offset=3"}, {});
  edits.reset(edits.places_of(std::vector<std::string>{"1.amplitude:J2"}));
  EXPECT_THROW(edits.reset(edits.places_of(std::vector<std::string>{"amplitudo"})), InputError);
  const auto differing =
      static_cast<std::size_t>(std::ranges::count_if(edits.parameters().places(), [this](const ParameterPlace& place) {
        return edits.parameters().at(place).wanted != edits.parameters().at(place).file;
      }));
  EXPECT_EQ(differing, 4U + 5U);
  edits.reset(edits.places_of({}));
  EXPECT_EQ(wanted(), of_file);
  EXPECT_TRUE(edits.undo());
  EXPECT_TRUE(edits.differs_from_file());
}

TEST_F(ParameterEditsTest, BecomeTheStartValuesOfTheNextRun) {
  edits.set({"amplitude:J2=20"}, {});
  const sim::Scenario scenario = edits.scenario_as_wanted();
  for (const ParameterPlace& place : edits.parameters().places()) {
    EXPECT_EQ(sim::start_value(scenario, place.slot, place.joint, place.number), edits.parameters().at(place).wanted);
  }
}

TEST_F(ParameterEditsTest, InternalValuesAreWantedOnce) {
  const std::vector<Setting> distortion = edits.set({"current_phase:J1=90"}, {});
  ASSERT_EQ(distortion.size(), 1U);
  EXPECT_TRUE(distortion.front().internal);
  EXPECT_EQ(wanted(), of_file);
  EXPECT_EQ(edits.history().to_undo(), nullptr);
}

}  // namespace
}  // namespace proleg::tools
