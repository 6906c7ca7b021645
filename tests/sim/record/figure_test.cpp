#include "sim/record/figure.hpp"

#include <gtest/gtest.h>
#include <tinyxml2.h>

#include <cmath>
#include <map>
#include <sstream>

#include "shared/computer/errors/input_error.hpp"
#include "sim/record/figure_contents.hpp"
#include "sim/record/figure_panels.hpp"
#include "sim/record/marks.hpp"
#include "sim/record/svg.hpp"
#include "sim/scenario/reader.hpp"
#include "small_run.hpp"
#include "tests/support/files.hpp"

namespace proleg::sim {
namespace {

/// The elements of a figure.
class Picture {
 public:
  explicit Picture(const std::string& svg) {
    EXPECT_EQ(document_.Parse(svg.c_str()), tinyxml2::XML_SUCCESS) << document_.ErrorStr();
    if (document_.RootElement() != nullptr) {
      look_at(*document_.RootElement());
    }
  }

  [[nodiscard]] bool has_text(const std::string& text) const { return texts_.contains(text); }
  [[nodiscard]] int count(const std::string& what) const {
    const auto found = counts_.find(what);
    return found == counts_.end() ? 0 : found->second;
  }
  /// Points of all polylines within a group of this class.
  [[nodiscard]] const std::vector<std::vector<Point>>& lines(const std::string& group) { return lines_[group]; }

 private:
  void look_at(const tinyxml2::XMLElement& element) {
    ++counts_[element.Name()];
    if (const char* group = element.Attribute("class"); group != nullptr) {
      ++counts_[group];
      group_ = group;
    }
    for (const char* name : {"x", "y", "x1", "y1", "x2", "y2", "cx", "cy", "r", "width", "height"}) {
      if (element.Attribute(name) != nullptr) {
        double value = NAN;
        EXPECT_EQ(element.QueryDoubleAttribute(name, &value), tinyxml2::XML_SUCCESS) << element.Attribute(name);
        EXPECT_TRUE(std::isfinite(value));
        EXPECT_GE(value, 0.0) << name << " of " << element.Name();
        EXPECT_LE(value, 1800.0) << name << " of " << element.Name();
      }
    }
    if (const char* points = element.Attribute("points"); points != nullptr) {
      std::vector<Point>& line = lines_[group_].emplace_back();
      std::istringstream stream(points);
      char comma = ' ';
      for (Point point; stream >> point.x >> comma >> point.y;) {
        line.push_back(point);
        EXPECT_TRUE(point.x >= 0.0 && point.x <= 900.0 && point.y >= 0.0 && point.y <= 1800.0) << points;
      }
      EXPECT_TRUE(stream.eof()) << points;
    }
    if (element.GetText() != nullptr) {
      ++texts_[element.GetText()];
    }
    for (const tinyxml2::XMLElement* child = element.FirstChildElement(); child != nullptr;
         child = child->NextSiblingElement()) {
      look_at(*child);
    }
  }

  tinyxml2::XMLDocument document_;
  std::string group_;
  std::map<std::string, int> counts_;
  std::map<std::string, int> texts_;
  std::map<std::string, std::vector<std::vector<Point>>> lines_;
};

class Figure : public testing::Test {
 protected:
  Picture draw(const Scenario& scenario, std::uint32_t ticks, const TimeWindow& window = {}) {
    record_small(path_, scenario, ticks);
    return Picture(draw_figure(Recording(path_), window));
  }

  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_ / "run.sqlite";
};

/// Like record_small(), with other poses.
void record_moving(const std::filesystem::path& path, const Scenario& scenario, std::uint32_t ticks,
                   const std::function<void(Pose&)>& move) {
  Recorder recorder(path, scenario, "test", "build");
  run_small(scenario, ticks, [&](const TickSample& sample, const Change* /*change*/) {
    std::vector<Pose> poses(sample.link_poses.begin(), sample.link_poses.end());
    std::ranges::for_each(poses, move);
    TickSample moved = sample;
    moved.link_poses = poses;
    recorder.record_tick(moved);
  });
}

/// A robot with this many joints on the sine.
Scenario long_scenario(unsigned joints) {
  Scenario scenario = small_scenario();
  scenario.robot.links.clear();
  scenario.robot.joints.clear();
  for (unsigned i = 0; i <= joints; ++i) {
    scenario.robot.links.emplace_back().name = "Link" + std::to_string(joints - i);
  }
  for (unsigned i = 0; i < joints; ++i) {
    scenario.robot.joints.emplace_back().name = "J" + std::to_string(joints - i);
  }
  scenario.joint_limits.assign(joints, {});
  scenario.kernel.joint_count = static_cast<std::uint8_t>(joints);
  scenario.kernel.slots[0].group = JointMask::first(joints);
  scenario.kernel.slots[2] = {};
  scenario.changes.clear();
  return scenario;
}

TEST_F(Figure, NamesWhatItShows) {
  Picture picture = draw(small_scenario(), 400);
  for (const char* text : {"small", "J1", "J2", "J3", "Head", "Link2", "Link1", "Tail", "time (s)", "x (m)", "y (m)",
                           "start", "end", "set-point", "measured", "displacement 1.625 m in 4 s"}) {
    EXPECT_TRUE(picture.has_text(text)) << text;
  }
  EXPECT_EQ(picture.count("title"), 1);
}

TEST_F(Figure, DrawsSetPointAndAngleOfEachJointAndThePath) {
  Picture picture = draw(small_scenario(), 400);
  EXPECT_EQ(picture.count("joint"), 3);
  ASSERT_EQ(picture.lines("joint").size(), 6U);
  for (const std::vector<Point>& line : picture.lines("joint")) {
    EXPECT_GE(line.size(), 290U);  // 3 s of 10 ms ticks
  }
  ASSERT_EQ(picture.lines("path").size(), 1U);
  EXPECT_GT(picture.lines("path")[0].size(), 50U);
  EXPECT_EQ(picture.lines("chain").size(), 2U);
  EXPECT_GT(picture.count("contact"), 10);
}

TEST_F(Figure, ShowsContactsFromTheSyncAtWhichTheyWereLatchedToTheNext) {
  record_small(path_, small_scenario(), 30);
  const FigureContents contents = collect_figure_contents(Recording(path_), {0.0, 0.14});
  // The made-up contacts of the head: none in ticks 0 to 3, rear in 4 to 7, front in 8 to 11, both in 12 to 15.
  const std::vector<FigureContents::Press>& rear = contents.presses[0][0];
  ASSERT_EQ(rear.size(), 2U);
  EXPECT_NEAR(rear[0].from_s, 0.04, 1e-9);
  EXPECT_NEAR(rear[0].to_s, 0.08, 1e-9);
  EXPECT_NEAR(rear[1].from_s, 0.12, 1e-9);
  EXPECT_NEAR(rear[1].to_s, 0.14, 1e-9);
  const std::vector<FigureContents::Press>& front = contents.presses[0][1];
  ASSERT_EQ(front.size(), 1U);
  EXPECT_NEAR(front[0].from_s, 0.08, 1e-9);
  EXPECT_NEAR(front[0].to_s, 0.14, 1e-9);
  // The tail is pressed at both ends from the start.
  ASSERT_EQ(contents.presses[3][0].size(), 2U);
  EXPECT_EQ(contents.presses[3][0][0].from_s, 0.0);
}

TEST_F(Figure, DrawsThePathToOneScale) {
  // The made-up robot goes 0.399 m ahead in 400 ticks while it swings by +-0.01 m.
  Picture picture = draw(small_scenario(), 400);
  const std::vector<Point>& path = picture.lines("path")[0];
  double low = INFINITY;
  double high = -INFINITY;
  for (const Point& point : path) {
    low = std::min(low, point.y);
    high = std::max(high, point.y);
  }
  const double pixels_per_metre = (path.back().x - path.front().x) / 0.399;
  EXPECT_NEAR((high - low) / pixels_per_metre, 0.02, 0.0005);
}

TEST_F(Figure, ShowsTheRequestedWindow) {
  Picture picture = draw(small_scenario(), 400, {0.5, 1.0});
  EXPECT_EQ(picture.lines("joint")[0].size(), 51U);
  EXPECT_TRUE(picture.has_text("0.75"));
  EXPECT_FALSE(picture.has_text("1.5"));
}

TEST_F(Figure, RefusesAWindowWithoutTicks) {
  record_small(path_, small_scenario(), 100);
  const Recording recording(path_);
  const auto message = [&](const TimeWindow& window) {
    return message_of<InputError>([&] { (void)draw_figure(recording, window); });
  };
  const std::string before_end = ", expected a time before the end of the recording, 1 s";
  EXPECT_EQ(message({2.0, {}}), "--from: found 2 s" + before_end);
  EXPECT_EQ(message({1.0, {}}), "--from: found 1 s" + before_end);
  EXPECT_EQ(message({1e300, {}}), "--from: found 1e+300 s" + before_end);
  EXPECT_EQ(message({{}, -1.0}), "--to: found -1 s, expected a time after the start of the recording, 0 s");
  EXPECT_EQ(message({{}, -1e300}), "--to: found -1e+300 s, expected a time after the start of the recording, 0 s");
  EXPECT_EQ(message({0.7, 0.2}), "--from: found 0.7 s, expected a time before --to, 0.2 s");
  EXPECT_EQ(message({0.5, 0.5}), "--from: found 0.5 s, expected a time before --to, 0.5 s");
  EXPECT_EQ(message({0.992, 0.999}),
            path_.string() +
                ": found fewer than two ticks between 0.992 s and 0.999 s, expected a window within the "
                "recorded 0 s to 1 s");
}

TEST_F(Figure, IsDrawnForTwoTicks) { EXPECT_EQ(draw(small_scenario(), 2).count("joint"), 3); }

TEST_F(Figure, IsDrawnForTheLongestRobot) {
  Picture picture = draw(long_scenario(max_joints), 100);
  EXPECT_EQ(picture.count("joint"), 64) << "a row of the map each, since lines would hide each other";
  EXPECT_TRUE(picture.has_text("Joint angles, measured"));
  EXPECT_TRUE(picture.has_text("J64"));
  EXPECT_TRUE(picture.has_text("Link64"));
}

TEST_F(Figure, DoesNotGrowWithTheLengthOfTheWindow) {
  const Scenario scenario = small_scenario();
  record_small(path_, scenario, 6000);
  const std::size_t minute = draw_figure(Recording(path_), {0.0, 60.0}).size();
  EXPECT_LT(minute, 1'000'000U);
}

/// The recording of a scenario that ships, with made-up motion.
Scenario shipped(const std::string& name) {
  DiskFiles files;
  return read_scenario(source_path("/sim/scenarios/" + name + ".simulation.xml"), files);
}

TEST_F(Figure, ShowsTheRobotInAStrideFromTheSide) {
  Picture picture = draw(shipped("travelling_wave/uniform"), 400);
  EXPECT_TRUE(picture.has_text("A stride from the side"));
  EXPECT_FALSE(picture.has_text("A stride from above")) << "it goes where it points";
  EXPECT_EQ(picture.count("view"), 8);
  EXPECT_EQ(picture.count("link"), 8 * 6) << "one shape for each of six links";
  EXPECT_EQ(picture.count("joint"), 5);
}

TEST_F(Figure, ShowsARobotThatGoesSidewaysFromAbove) {
  const Scenario scenario = shipped("travelling_wave/uniform");
  std::uint32_t poses = 0;
  record_moving(path_, scenario, 400, [&](Pose& pose) {
    const std::uint32_t tick = poses++ / 6;
    pose.position += Eigen::Vector3d(-0.001 * tick, 0.002 * tick, 0.0);
  });
  Picture picture(draw_figure(Recording(path_), {}));
  EXPECT_TRUE(picture.has_text("A stride from above"));
  EXPECT_EQ(picture.count("view"), 16);
}

TEST_F(Figure, ShowsARobotWithYawJointsFromAboveAndTheirAnglesApart) {
  Scenario scenario = shipped("travelling_wave/uniform");
  SourceFile& file = *std::ranges::find_if(
      scenario.sources, [](const SourceFile& its) { return its.path.ends_with("caterpillar.robot.xml"); });
  std::string robot = file.text;
  robot.replace(robot.find("<axis>1 0 0"), 11, "<axis>0 0 1");
  file.text = std::move(robot);
  Picture picture = draw(scenario, 400);
  EXPECT_TRUE(picture.has_text("A stride from above"));
  EXPECT_TRUE(picture.has_text("Angles of the pitch joints (deg)"));
  EXPECT_TRUE(picture.has_text("Angles of the yaw joints (deg)"));
  EXPECT_EQ(picture.count("joint"), 5);
}

TEST_F(Figure, ShowsTheTerrain) {
  Scenario scenario = shipped("obstacle/reflex");
  record_moving(path_, scenario, 400, [](Pose& pose) { pose.position.z() -= 0.3; });
  Picture picture(draw_figure(Recording(path_), {}));
  EXPECT_GT(picture.count("terrain"), 8) << "the floor, and steps in some cells";
}

TEST_F(Figure, OfALongRobotHasFewerCells) {
  Picture picture = draw(shipped("long_chain/twenty"), 300);
  EXPECT_EQ(picture.count("link"), 6 * 21);
}

TEST_F(Figure, OfARobotThatIsTornApartHasNoViews) {
  const Scenario scenario = shipped("travelling_wave/uniform");
  record_moving(path_, scenario, 100, [](Pose& pose) { pose.position *= 1e5; });
  EXPECT_EQ(Picture(draw_figure(Recording(path_), {})).count("view"), 0);
}

TEST_F(Figure, MarksRestartsAndLosses) {
  const Scenario scenario = small_scenario();
  {
    Recorder recorder(path_, scenario, "test", "build");
    run_small(scenario, 300, [&](const TickSample& sample, const Change* /*change*/) {
      if (sample.tick == 150 || sample.tick == 170) {
        recorder.record_restart(sample.tick, 1, sample.tick == 170);
      }
      const Loss lost{sample.tick, 0, 0, 1};
      TickSample with_loss = sample;
      if (sample.tick % 50 == 7) {
        with_loss.lost = {&lost, 1};
      }
      recorder.record_tick(with_loss);
    });
  }
  const Recording recording(path_);
  const Disturbances disturbances = collect_disturbances(recording);
  ASSERT_EQ(disturbances.restarts.size(), 1U);
  EXPECT_EQ(disturbances.restarts[0].joint, "J2");
  EXPECT_NEAR(disturbances.restarts[0].from_s, 1.5, 1e-9);
  EXPECT_NEAR(disturbances.restarts[0].to_s.value(), 1.7, 1e-9);
  ASSERT_EQ(disturbances.lost_in_ticks.size(), 6U);
  EXPECT_EQ(disturbances.lost_in_ticks[1].tick, 57U);
  EXPECT_EQ(disturbances.lost_in_ticks[1].frames, 1U);
  Picture picture(draw_figure(recording, {0.0, 3.0}));
  EXPECT_EQ(picture.count("restart"), 1);
  EXPECT_EQ(picture.count("loss"), 1);
  EXPECT_TRUE(picture.has_text("J2 restarts"));
  EXPECT_TRUE(picture.has_text("State frames lost (%)"));
}

TEST_F(Figure, TheHeightOfALossIsItsShareOfTheFrames) {
  const Scenario scenario = small_scenario();  // three joints that send a frame to each other: six receptions in a tick
  {
    Recorder recorder(path_, scenario, "test", "build");
    run_small(scenario, 300, [&](const TickSample& sample, const Change* /*change*/) {
      const std::vector<Loss> lost{{sample.tick, 0, 0, 1}, {sample.tick, 0, 0, 2}, {sample.tick, 1, 0, 2}};
      TickSample with_loss = sample;
      with_loss.lost = std::span(lost).first(sample.tick >= 100 && sample.tick < 200 ? 3 : 0);
      recorder.record_tick(with_loss);
    });
  }
  const Recording recording(path_);
  const Disturbances disturbances = collect_disturbances(recording);
  const LossShares all = collect_loss_shares(recording, disturbances, {0.0, 3.0, 0.0, 600.0});
  EXPECT_EQ(all.ticks_of_bar, 3U) << "a tick is two pixels";
  EXPECT_NEAR(all.share, 0.5 / 3.0, 1e-9);
  ASSERT_EQ(all.bars.size(), 34U) << "in the first and the last one, a tick of three is without losses";
  EXPECT_NEAR(all.bars[0].share, 0.5 * 2 / 3, 1e-9);
  EXPECT_NEAR(all.bars[1].share, 0.5, 1e-9);
  EXPECT_NEAR(all.bars[33].share, 0.5 * 2 / 3, 1e-9);
  const LossShares within = collect_loss_shares(recording, disturbances, {1.5, 1.55, 0.0, 100.0});
  EXPECT_EQ(within.ticks_of_bar, 1U);
  EXPECT_EQ(within.bars.size(), 5U);
  EXPECT_NEAR(within.share, 0.5, 1e-9);
  EXPECT_TRUE(collect_loss_shares(recording, disturbances, {2.0, 3.0, 0.0, 100.0}).bars.empty());
  EXPECT_TRUE(Picture(draw_figure(recording, {0.0, 3.0})).has_text("16.7 % in this window; each bar: 30 ms"));
  EXPECT_TRUE(Picture(draw_figure(recording, {2.0, 3.0})).has_text("0 % in this window; each bar: 10 ms"));
}

TEST_F(Figure, HasTimesOnThePath) {
  Picture picture = draw(small_scenario(), 800);
  EXPECT_GE(picture.count("time"), 7);
  EXPECT_TRUE(picture.has_text("4 s"));
}

TEST_F(Figure, HasThreeStridesByDefault) {
  Scenario scenario = small_scenario();  // its sine has the default frequency
  record_small(path_, scenario, 2000);
  const FigureContents contents = collect_figure_contents(Recording(path_), {});
  const auto [low, high] = std::ranges::minmax(contents.setpoints[0], {}, &Point::y);
  EXPECT_GT(high.y - low.y, 1.0);
  EXPECT_NEAR(contents.to_s - contents.from_s, 3.0, 0.05) << "at 1 Hz";
}

TEST_F(Figure, IsWellFormedForAnyNames) {
  Scenario scenario = small_scenario();
  scenario.robot.name = "<&\">'\x01\xff\xc3";
  scenario.robot.links[0].name = "]]><b a='";
  scenario.robot.joints[0].name = "K\xc3\xb6rper";
  Picture picture = draw(scenario, 100);
  EXPECT_TRUE(picture.has_text("]]><b a='"));
  EXPECT_TRUE(picture.has_text("K\xc3\xb6rper"));
}

TEST_F(Figure, HasFiniteCoordinatesForAnUnstableSimulation) {
  const Scenario scenario = small_scenario();
  {
    Recorder recorder(path_, scenario, "test", "build");
    run_small(scenario, 50, [&](const TickSample& sample, const Change* /*change*/) {
      std::vector<double> angles(sample.joint_angles.begin(), sample.joint_angles.end());
      std::vector<Pose> poses(sample.link_poses.begin(), sample.link_poses.end());
      if (sample.tick > 30) {
        angles[1] = 1e300;
        poses[2].position = {-1.7e308, 1.7e308, 0.0};
      }
      TickSample wild = sample;
      wild.link_poses = poses;
      wild.joint_angles = angles;
      recorder.record_tick(wild);
    });
  }
  Picture picture(draw_figure(Recording(path_), {}));  // checks that all coordinates are on the page
  EXPECT_EQ(picture.count("joint"), 3);
}

TEST_F(Figure, ShortensNamesThatAreTooLong) {
  Scenario scenario = small_scenario();
  scenario.path.assign(200, 'p').append(".simulation.xml");
  scenario.robot.joints[0].name = "\xc3\xa4\xc3\xb6\xc3\xbc\xc3\xa4\xc3\xb6\xc3\xbc\xc3\xa4\xc3\xb6\xc3\xbc";
  Picture picture = draw(scenario, 100);
  std::string shortened(55, 'p');
  EXPECT_TRUE(picture.has_text(shortened.append("...")));
  EXPECT_TRUE(picture.has_text("\xc3\xa4\xc3\xb6\xc3\xbc\xc3\xa4\xc3\xb6\xc3\xbc\xc3\xa4\xc3\xb6..."));
}

TEST_F(Figure, ShowsThatARunIsNotFinished) {
  const Scenario scenario = small_scenario();
  {
    Recorder recorder(path_, scenario, "test", "build");
    run_small(scenario, 20, [&](const TickSample& sample, const Change* /*change*/) { recorder.record_tick(sample); });
  }
  EXPECT_NE(draw_figure(Recording(path_), {}).find("not finished"), std::string::npos);
}

TEST(XmlText, ReplacesWhatXmlCannotHold) {
  EXPECT_EQ(xml_text("a<b>&\"c"), "a&lt;b&gt;&amp;&quot;c");
  EXPECT_EQ(xml_text("\x01\x7f\t"), "???");
  EXPECT_EQ(xml_text("\xe2\x82\xac"), "\xe2\x82\xac");                            // the euro sign
  EXPECT_EQ(xml_text("\xf0\x9f\x90\x9b"), "\xf0\x9f\x90\x9b");                    // a caterpillar, beyond 16 bits
  EXPECT_EQ(xml_text("\xc0\xaf\xed\xa0\x80\xef\xbf\xbe\xe2\x82"), "??????????");  // overlong, surrogate, U+FFFE, cut
}

TEST(PlainNumber, HasNoTrailingZeros) {
  EXPECT_EQ(plain_number(1.5, 2), "1.5");
  EXPECT_EQ(plain_number(20.0, 2), "20");
  EXPECT_EQ(plain_number(-0.001, 2), "0");
  EXPECT_EQ(plain_number(0.125, 3), "0.125");
}

}  // namespace
}  // namespace proleg::sim
