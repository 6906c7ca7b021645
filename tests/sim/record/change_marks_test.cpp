#include "sim/record/marks.hpp"

#include <gtest/gtest.h>

#include "sim/record/figure.hpp"
#include "sim/record/recorder.hpp"
#include "sim/scenario/settings.hpp"
#include "small_run.hpp"

namespace proleg::sim {
namespace {

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
    ++found;
  }
  return found;
}

TEST(ChangeMarks, NameTheValueAndItsJointUnlessAllChange) {
  const TemporaryFolder folder;
  Scenario scenario = small_scenario();
  scenario.changes.clear();
  Setting setting = scenario.settings.front();  // the amplitude
  setting.value = raw(Unit::degree, 20);
  const Change one{3, {setting}};
  Change all{9, {}};
  for (std::uint8_t joint = 0; joint < 3; ++joint) {
    setting.joint = joint;
    all.settings.push_back(setting);
  }
  {
    Recorder recorder(folder / "run", scenario, "test", "build");
    recorder.record_change(one);
    recorder.record_change(all);
    run_small(scenario, 20, [&](const TickSample& sample, const Change* /*change*/) { recorder.record_tick(sample); });
  }
  const std::vector<ChangeMark> marks = collect_change_marks(Recording(folder / "run"));
  ASSERT_EQ(marks.size(), 2U);
  EXPECT_DOUBLE_EQ(marks[0].time_s, 0.03);
  EXPECT_EQ(marks[0].text, "amplitude J2 = 20");
  EXPECT_DOUBLE_EQ(marks[1].time_s, 0.09);
  EXPECT_EQ(marks[1].text, "amplitude = 20");
}

TEST(ChangeMarks, WriteHalfATurnWithoutASign) {
  const TemporaryFolder folder;
  Scenario scenario = small_scenario();
  scenario.changes.clear();
  apply_setting(scenario, "current_phase:J2=180@3");
  {
    Recorder recorder(folder / "run", scenario, "test", "build");
    recorder.record_change(scenario.changes.at(0));
    run_small(scenario, 20, [&](const TickSample& sample, const Change* /*change*/) { recorder.record_tick(sample); });
  }
  EXPECT_EQ(collect_change_marks(Recording(folder / "run")).at(0).text, "current_phase J2 = 180");
}

TEST(ChangeMarks, AppearInTheFigureAtTheirTime) {
  const TemporaryFolder folder;
  record_small(folder / "run", small_scenario(), 50);
  const Recording recording(folder / "run");
  const std::string whole = draw_figure(recording, {});
  EXPECT_EQ(count(whole, R"(class="change")"), 4U) << "a commit and a distortion, each through two panels";
  EXPECT_EQ(count(whole, "angle J1 = -7"), 1U);
  EXPECT_EQ(count(whole, "changed 2 times in flight"), 1U);
  EXPECT_EQ(count(draw_figure(recording, {0.2, 0.4}), R"(class="change")"), 0U) << "the changes are before the window";
}

}  // namespace
}  // namespace proleg::sim
