#include "tools/proleg/ui/parameter_edits.hpp"

#include <gtest/gtest.h>

#include "shared/computer/errors/input_error.hpp"
#include "shipped.hpp"
#include "sim/scenario/settings.hpp"

namespace proleg::tools {
namespace {

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
