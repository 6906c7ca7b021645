#include "sim/authoring/run_change.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "replaced.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "tests/support/message_of.hpp"
#include "world_files.hpp"

namespace proleg::sim {
namespace {

class RunChangeTest : public testing::Test {
 protected:
  void change(const std::function<void(RunChange&)>& action) {
    const Scenario before = draft_.scenario();
    draft_.change("test", {}, [&](DraftChange& edit) {
      RunChange run(before, edit);
      action(run);
    });
  }
  [[nodiscard]] std::string refusal(const std::function<void(RunChange&)>& action) {
    return message_of<InputError>([&] { change(action); });
  }

  MemoryFiles files_ = world_files();
  Draft draft_{files_.scenario(), files_};
};

TEST_F(RunChangeTest, AValueChangesItsTag) {
  const std::string before = draft_.text("top.xml");
  change([](RunChange& run) { run.set_duration(12.5); });
  EXPECT_EQ(draft_.text("top.xml"), replaced(before, "<duration>2<", "<duration>12.5<"));
  EXPECT_EQ(draft_.scenario().duration_s, 12.5);
  change([](RunChange& run) { run.set_seed(18446744073709551615U); });
  EXPECT_EQ(draft_.scenario().kernel.seed, 18446744073709551615U);
  change([](RunChange& run) { run.set_tick(20.0); });
  EXPECT_EQ(draft_.scenario().kernel.tick_period_us, 20'000U);
  change([](RunChange& run) { run.set_step(0.5); });
  EXPECT_DOUBLE_EQ(draft_.scenario().step_s, 0.0005);
  change([](RunChange& run) { run.set_solver(Solver::iterative); });
  EXPECT_EQ(draft_.scenario().solver, Solver::iterative);
  change([](RunChange& run) { run.set_contact_noise(0.25); });
  EXPECT_EQ(draft_.scenario().contact_noise, 0.25);
}

TEST_F(RunChangeTest, TheWorldHasEngineAndGravity) {
  change([](RunChange& run) { run.set_engine(PhysicsEngine::reduced); });
  EXPECT_EQ(draft_.text("environment.xml"), replaced(world_text, "type=\"ode\"", "type=\"reduced\""));
  change([](RunChange& run) { run.set_gravity({0, 0, -1.62}); });
  change([](RunChange& run) { run.set_self_collision(true); });
  const EnvironmentModel& environment = draft_.scenario().environment;
  EXPECT_EQ(environment.engine, PhysicsEngine::reduced);
  EXPECT_EQ(environment.gravity, Eigen::Vector3d(0, 0, -1.62));
  EXPECT_TRUE(environment.self_collision);
}

TEST_F(RunChangeTest, TagsThatAreMissingAreAdded) {
  files_.texts["top.xml"] =
      "<simulation><robot>robot.xml</robot><actuation>actuation.xml</actuation>\n"
      "  <environment>environment.xml</environment>\n</simulation>\n";
  files_.texts["environment.xml"] = "<Environment>\n</Environment>\n";
  Draft draft(files_.scenario(), files_);
  const Scenario before = draft.scenario();
  draft.change("test", {}, [&](DraftChange& edit) {
    RunChange run(before, edit);
    run.set_duration(3.0);
    run.set_gravity({0, 0, -5});
    run.set_engine(PhysicsEngine::mujoco);
  });
  EXPECT_EQ(draft.scenario().duration_s, 3.0);
  EXPECT_EQ(draft.scenario().environment.gravity.z(), -5.0);
  EXPECT_EQ(draft.scenario().environment.engine, PhysicsEngine::mujoco);
}

TEST_F(RunChangeTest, TheReaderJudgesTheRanges) {
  EXPECT_NE(refusal([](RunChange& run) { run.set_duration(0.0); }).find("<duration>"), std::string::npos);
  EXPECT_NE(refusal([](RunChange& run) { run.set_duration(1e9); }).find("<duration>"), std::string::npos);
  EXPECT_NE(refusal([](RunChange& run) { run.set_tick(7.3); }).find("a whole number of steps"), std::string::npos);
  EXPECT_NE(refusal([](RunChange& run) { run.set_step(3.0); }).find("a whole number of steps"), std::string::npos);
  EXPECT_NE(refusal([](RunChange& run) { run.set_contact_noise(2.0); }).find("<contactNoise>"), std::string::npos);
  EXPECT_NE(refusal([](RunChange& run) { run.set_gravity({0, 0, 1e6}); }).find("<gravity>"), std::string::npos);
  EXPECT_FALSE(draft_.undo_label()) << "nothing has changed";
}

TEST(SolverWords, AreTheSolvers) {
  for (const Solver solver : {Solver::automatic, Solver::direct, Solver::iterative}) {
    EXPECT_EQ(solver_named(word_of(solver)), solver);
  }
  EXPECT_FALSE(solver_named("fast"));
}

}  // namespace
}  // namespace proleg::sim
