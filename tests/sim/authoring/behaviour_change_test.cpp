#include "sim/authoring/behaviour_change.hpp"

#include <gtest/gtest.h>

#include "replaced.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/gait/registry.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/scenario/names.hpp"
#include "sim/scenario/settings.hpp"
#include "tests/support/message_of.hpp"
#include "world_files.hpp"

namespace proleg::sim {
namespace {

/// One module moves both joints.
MemoryFiles one_module() {
  MemoryFiles files = small_scenario();
  files.texts["actuation.xml"] = R"(<actuation>
  <actuationModule name="PatternGenerator_sinusoidal">
    <jointConfiguration joints="11"/>
    <parameter name="amplitude" value="30" unit="deg"/>  <!-- stays -->
  </actuationModule>
</actuation>
)";
  return files;
}

class BehaviourTest : public testing::Test {
 protected:
  template <typename Change>
  void change(const Change& change) {
    const Scenario before = draft_.scenario();
    draft_.change("test", {}, [&](DraftChange& edit) {
      BehaviourChange behaviour(before, edit);
      change(behaviour);
    });
  }
  template <typename Change>
  [[nodiscard]] std::string refusal(const Change& refused) {
    const std::string before = text();
    std::string message = message_of<InputError>([&] { change(refused); });
    EXPECT_EQ(text(), before) << "what is refused changes nothing";
    return message;
  }
  [[nodiscard]] std::string text() const { return draft_.text("actuation.xml"); }
  [[nodiscard]] const Slot& slot(unsigned number) const { return draft_.scenario().kernel.slots[number]; }

  MemoryFiles files_ = one_module();
  const std::string original_ = files_.texts.at("actuation.xml");
  Draft draft_{files_.scenario(), files_};
};

constexpr const char* sine = "PatternGenerator_sinusoidal";

TEST_F(BehaviourTest, AModuleIsAddedBehindTheOthersAndRemoved) {
  change([](BehaviourChange& behaviour) { behaviour.add("DirectJointAccess", JointMask::of(0)); });
  EXPECT_EQ(used_slots(draft_.scenario()).size(), 2U);
  EXPECT_EQ(slot(1).algorithm->declaration().name, "DirectJointAccess");
  EXPECT_EQ(slot(1).group, JointMask::of(0));
  EXPECT_NE(text().find("joints=\"01\""), std::string::npos) << "kernel joint 0 is the last of the file";
  change([](BehaviourChange& behaviour) { behaviour.remove(1); });
  EXPECT_EQ(text(), original_);
}

TEST_F(BehaviourTest, EachAlgorithmCanMoveARobot) {
  for (std::size_t i = 0; i < algorithm_count(); ++i) {
    const std::string name(algorithm_at(i).declaration().name);
    SCOPED_TRACE(name);
    change([&](BehaviourChange& behaviour) { behaviour.set_algorithm(0, name); });
    EXPECT_EQ(slot(0).algorithm->declaration().name, name);
    Simulation simulation(draft_.scenario());
    for (int tick = 0; tick < 20; ++tick) {
      simulation.advance();
    }
  }
}

TEST_F(BehaviourTest, AnotherAlgorithmKeepsTheValuesThatItHas) {
  ASSERT_NE(original_.find("\"amplitude\" value=\"30\""), std::string::npos);
  change([](BehaviourChange& behaviour) { behaviour.set_algorithm(0, "PatternGenerator_sinusoidal_extended"); });
  EXPECT_EQ(text(), replaced(original_, "PatternGenerator_sinusoidal", "PatternGenerator_sinusoidal_extended"));
  change([](BehaviourChange& behaviour) { behaviour.set_algorithm(0, "PatternGenerator_serpenoid"); });
  const Declaration& declaration = slot(0).algorithm->declaration();
  for (const Setting& setting : draft_.scenario().settings) {
    EXPECT_LT(setting.number, declaration.parameters.size());
  }
  ASSERT_TRUE(draft_.undo());
  ASSERT_TRUE(draft_.undo());
  EXPECT_EQ(text(), original_);
}

TEST_F(BehaviourTest, JointsOfAModuleAreTheirCharacters) {
  const JointMask before = slot(0).group;
  change([](BehaviourChange& behaviour) { behaviour.set_joints(0, JointMask::of(1)); });
  EXPECT_EQ(slot(0).group, JointMask::of(1));
  change([&](BehaviourChange& behaviour) { behaviour.set_joints(0, before); });
  EXPECT_EQ(slot(0).group, before);
}

TEST_F(BehaviourTest, AJointThatLeavesTakesItsOwnValuesAlong) {
  change([](BehaviourChange& behaviour) { behaviour.set_parameter(0, "phase", JointMask::of(1), "12"); });
  EXPECT_NE(text().find("joint=\"J1\""), std::string::npos) << text();
  change([](BehaviourChange& behaviour) { behaviour.set_joints(0, JointMask::of(0)); });
  EXPECT_EQ(text().find("joint=\"J1\""), std::string::npos) << text();
}

TEST_F(BehaviourTest, AValueIsWrittenWhereItStands) {
  change([](BehaviourChange& behaviour) { behaviour.set_parameter(0, "amplitude", JointMask::first(2), "25.5"); });
  EXPECT_EQ(text(), replaced(original_, "\"amplitude\" value=\"30\"", "\"amplitude\" value=\"25.5\""));
}

TEST_F(BehaviourTest, ACopyMovesOtherJointsWithTheSameValues) {
  change([](BehaviourChange& behaviour) { behaviour.set_parameter(0, "phase", JointMask::of(1), "12"); });
  change([](BehaviourChange& behaviour) { behaviour.duplicate(0, JointMask::of(0)); });
  ASSERT_EQ(used_slots(draft_.scenario()).size(), 2U);
  EXPECT_EQ(slot(1).group, JointMask::of(0));
  const int amplitude = find_parameter(slot(1).algorithm->declaration(), "amplitude");
  EXPECT_EQ(start_value(draft_.scenario(), 1, 0, static_cast<unsigned>(amplitude)),
            start_value(draft_.scenario(), 0, 0, static_cast<unsigned>(amplitude)));
}

TEST_F(BehaviourTest, WhatCannotBeIsRefusedWithItsReason) {
  EXPECT_NE(refusal([](BehaviourChange& behaviour) { behaviour.remove(0); }).find("no <actuationModule>"),
            std::string::npos);
  EXPECT_NE(refusal([](BehaviourChange& behaviour) { behaviour.add("Fly", JointMask::of(0)); }).find("'Fly'"),
            std::string::npos);
  EXPECT_NE(refusal([](BehaviourChange& behaviour) { behaviour.set_joints(3, JointMask::of(0)); }).find("1 to 1"),
            std::string::npos);
  EXPECT_NE(refusal([](BehaviourChange& behaviour) { behaviour.set_joints(0, JointMask::of(9)); }).find("below 2"),
            std::string::npos);
  EXPECT_NE(refusal([](BehaviourChange& behaviour) {
              behaviour.set_parameter(0, "amplitude", JointMask::first(2), "9000");
            }).find("90"),
            std::string::npos);
  EXPECT_NE(refusal([](BehaviourChange& behaviour) {
              behaviour.set_parameter(0, "wings", JointMask::first(2), "1");
            }).find("one of"),
            std::string::npos);
  for (int i = 0; i < 3; ++i) {
    const char* const algorithm = i == 0 ? sine : "DirectJointAccess";
    change([&](BehaviourChange& behaviour) { behaviour.add(algorithm, JointMask::of(0)); });
  }
  EXPECT_NE(
      refusal([](BehaviourChange& behaviour) { behaviour.add("DirectJointAccess", JointMask::of(1)); }).find("a fifth"),
      std::string::npos);
}

}  // namespace
}  // namespace proleg::sim
