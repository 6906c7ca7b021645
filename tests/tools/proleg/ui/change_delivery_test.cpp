#include "tools/proleg/ui/parameter_edits.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "shipped.hpp"

namespace proleg::tools {
namespace {

class ChangeDeliveryTest : public ::testing::Test {
 protected:
  ChangeDeliveryTest() { delivery.begin_run(); }
  void confirm_all(const std::vector<Setting>& settings, std::uint32_t tick) { delivery.confirm({tick, settings}); }
  bool are_all_confirmed() const {
    return std::ranges::all_of(edits.parameters().places(), [this](const ParameterPlace& place) {
      return edits.parameters().at(place).confirmed == edits.parameters().at(place).wanted;
    });
  }

  sim::Scenario file = sim::shipped("travelling_wave/uniform");
  ParameterEdits edits{file, file};
  ChangeDelivery delivery{edits};
};

TEST_F(ChangeDeliveryTest, GivesWhatIsWantedOnce) {
  EXPECT_TRUE(delivery.next().empty());
  edits.set({"amplitude=30"}, {});
  const std::vector<Setting> given = delivery.next();
  EXPECT_EQ(given.size(), 5U);
  EXPECT_TRUE(delivery.next().empty());
  EXPECT_FALSE(are_all_confirmed());
  confirm_all(given, 40);
  EXPECT_TRUE(are_all_confirmed());
}

TEST_F(ChangeDeliveryTest, OnlyTheLastOfManyWishesGoesNext) {
  edits.set({"amplitude=30"}, 1);
  const std::vector<Setting> first = delivery.next();
  for (int value = 31; value <= 60; ++value) {
    edits.set({"amplitude=" + std::to_string(value)}, 1);
  }
  confirm_all(first, 40);
  EXPECT_FALSE(are_all_confirmed()) << "what is confirmed is not what is wanted by now";
  const std::vector<Setting> last = delivery.next();
  ASSERT_EQ(last.size(), 5U);
  confirm_all(last, 80);
  EXPECT_TRUE(are_all_confirmed());
}

TEST_F(ChangeDeliveryTest, NoJointGetsMoreThanItsModuleKeeps) {
  std::mt19937 random(20261122);
  for (int round = 0; round < 50; ++round) {
    edits.set({"amplitude=" + std::to_string(1 + random() % 60), "offset=" + std::to_string(random() % 20),
               "phase_difference=" + std::to_string(random() % 90)},
              {});
    delivery.add(edits.set({"current_phase=" + std::to_string(random() % 90)}, {}));
    for (std::vector<Setting> given = delivery.next(); !given.empty(); given = delivery.next()) {
      for (std::uint8_t joint = 0; joint < 5; ++joint) {
        EXPECT_LE(std::ranges::count(given, joint, &Setting::joint), static_cast<std::ptrdiff_t>(max_staged_values));
      }
      confirm_all(given, 40);
    }
    EXPECT_TRUE(are_all_confirmed());
  }
}

TEST_F(ChangeDeliveryTest, WhatHadNoEffectIsNotWantedAnyMore) {
  edits.set({"amplitude=30"}, {});
  static_cast<void>(delivery.next());
  delivery.give_up();
  EXPECT_FALSE(edits.differs_from_file());
  EXPECT_TRUE(delivery.next().empty());
}

TEST_F(ChangeDeliveryTest, AChangeOfTheFileIsWantedFromThenOn) {
  const ParameterPlace place = edits.parameters().places().front();
  delivery.confirm({100, {{place.slot, place.joint, place.number, false, 12345}}});
  EXPECT_EQ(edits.parameters().at(place).wanted, 12345);
  EXPECT_EQ(edits.parameters().at(place).tick, 100U);
  EXPECT_TRUE(delivery.next().empty());
}

}  // namespace
}  // namespace proleg::tools
