#include "tools/proleg/robot/mirror.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "shared/computer/output/output.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/loop/ramp_in.hpp"
#include "sim/record/plot_frame.hpp"
#include "tools/proleg/common/result_folder.hpp"

namespace proleg::tools {
namespace {

ScenarioOptions with_recording(const ScenarioOptions& options, const std::string& recording) {
  ScenarioOptions mirrored = options;
  mirrored.record = recording;
  return mirrored;
}

std::filesystem::path picture_of(const std::string& recording) {
  return beside_recording(recording, ".difference.svg");
}

/// "uniform" for uniform.simulation.xml.
std::string title_of(const std::string& scenario_file) {
  const std::string name = std::filesystem::path(scenario_file).filename().string();
  return name.substr(0, name.find('.'));
}

}  // namespace

Mirror::Mirror(const sim::Scenario& scenario)
    : scenario_(scenario),
      plant_(scenario),
      player_(plant_, {scenario.robot.servo.period_us, scenario.kernel.tick_period_us}),
      lines_(scenario.robot.joints.size()) {
  remember_angles();
}

sim::TickSample Mirror::follow(const sim::TickSample& real) {
  if (real.tick == 0) {
    sim::ramp_in(scenario_, plant_, player_, real.servo_pulses);
    angles_.clear();
    next_tick_ = 0;
    remember_angles();
  }
  player_.advance(real.tick, real.servo_pulses);
  hash_.append(plant_);
  remember_angles();
  compare();
  sim::TickSample sample = real;
  plant_.add_to(sample);
  sample.servo_commands = real.servo_commands;
  return sample;
}

void Mirror::note_measured(std::uint32_t tick, unsigned joint, double angle) {
  waiting_.push_back({tick, joint, angle});
  compare();
}

void Mirror::remember_angles() {
  constexpr std::size_t kept_ticks = 256;
  angles_.emplace_back(plant_.joint_angles().begin(), plant_.joint_angles().end());
  ++next_tick_;
  if (angles_.size() > kept_ticks) {
    angles_.pop_front();
  }
}

void Mirror::compare() {
  const std::uint32_t oldest = next_tick_ - static_cast<std::uint32_t>(angles_.size());
  while (!waiting_.empty() && waiting_.front().tick < next_tick_) {
    const Measurement& measured = waiting_.front();
    if (measured.tick >= oldest) {
      const double difference = measured.angle - angles_[measured.tick - oldest][measured.joint];
      lines_[measured.joint].push_back(
          {measured.tick * (scenario_.kernel.tick_period_us * 1e-6), difference * (180.0 / std::numbers::pi)});
    }
    waiting_.pop_front();
  }
}

std::vector<Mirror::Difference> Mirror::differences() const {
  std::vector<Difference> differences;
  for (const sim::Polyline& line : lines_) {
    Difference& difference = differences.emplace_back();
    difference.over_time = line;
    double squares = 0.0;
    for (const sim::Point& point : line) {
      squares += point.y * point.y;
      difference.largest = std::max(difference.largest, std::abs(point.y));
    }
    difference.root_mean_square = line.empty() ? 0.0 : std::sqrt(squares / static_cast<double>(line.size()));
  }
  return differences;
}

std::string Mirror::picture(const std::string& title, double seconds) const {
  constexpr double bottom = 470.0;
  double lowest = 0.0;
  double highest = 0.0;
  for (const sim::Polyline& line : lines_) {
    for (const sim::Point& point : line) {
      lowest = std::min(lowest, point.y);
      highest = std::max(highest, point.y);
    }
  }
  const sim::Axis x{0.0, std::max(seconds, 0.1), sim::page_left, sim::page_right};
  const sim::Axis y = sim::axis_over(lowest, highest, bottom, sim::first_panel_top);
  sim::Svg svg(sim::page_width, bottom + 56.0, title, "Measured minus simulated angle of each joint, against time.");
  sim::draw_title(svg, title, "the robot and the simulation of it with the same pulses");
  sim::draw_plot_grid(svg, x, y, "time, s", "measured minus simulated angle, degrees");
  std::vector<sim::LineName> names;
  for (std::size_t joint = 0; joint < lines_.size(); ++joint) {
    if (lines_[joint].empty()) {
      continue;
    }
    const char* colour = sim::distinct_colours.at(joint % sim::distinct_colours.size());
    svg.begin_group("joint");
    svg.polyline(sim::to_pixels(lines_[joint], x, y),
                 std::string("stroke=\"") + colour + R"(" stroke-width="1.6" stroke-linejoin="round")");
    svg.end_group();
    names.push_back({lines_[joint].back().y, scenario_.robot.joints[joint].name, colour});
  }
  sim::draw_line_names(svg, y, sim::page_right, names);
  sim::draw_plot_frame(svg, x, y);
  return svg.finish();
}

MirroredRun::MirroredRun(const ScenarioOptions& options, const std::string& recording, const sim::Scenario& scenario)
    : recording_(recording),
      title_(title_of(options.file)),
      scenario_(scenario),
      mirror_(scenario),
      recorder_(open_recorder(with_recording(options, recording), scenario, "drive mirror")) {}

std::vector<PlannedOutput> MirroredRun::planned(const ScenarioOptions& options, const std::string& recording) {
  std::vector<PlannedOutput> outputs = planned_recording(with_recording(options, recording));
  outputs.front().option = "--mirror";
  outputs.push_back({"--mirror", picture_of(recording), "SVG picture", starts_with("<")});
  return outputs;
}

void MirroredRun::finish(double seconds, const GaitCheck& check) {
  recorder_->finish({{"simulated_s", exact_text(seconds)},
                     {"setpoint_hash", check.setpoint_hash().hex()},
                     {"servo_hash", check.servo_hash().hex()},
                     {"motion_hash", mirror_.motion_hash()}});
  write_file(picture_of(recording_), mirror_.picture(title_, seconds));
}

Json MirroredRun::json() const {
  Json joints = Json::empty_array();
  const auto differences = mirror_.differences();
  for (std::size_t joint = 0; joint < differences.size(); ++joint) {
    const Mirror::Difference& difference = differences[joint];
    joints.append({{"joint", scenario_.robot.joints[joint].name},
                   {"measurements", difference.over_time.size()},
                   {"root_mean_square_deg", difference.root_mean_square},
                   {"largest_deg", difference.largest}});
  }
  return {{"recording", recording_},
          {"picture", picture_of(recording_).string()},
          {"motion_hash", mirror_.motion_hash()},
          {"motion_compared", false},
          {"joints", joints}};
}

void MirroredRun::print() const {
  const auto differences = mirror_.differences();
  for (std::size_t joint = 0; joint < differences.size(); ++joint) {
    const Mirror::Difference& difference = differences[joint];
    const std::string name = "mirror, " + scenario_.robot.joints[joint].name;
    if (difference.over_time.empty()) {
      std::printf("%-17s its module does not measure the angle\n", name.c_str());
    } else {
      std::printf("%-17s measured - simulated angle: %.2f deg (root mean square), %.2f deg at most\n", name.c_str(),
                  difference.root_mean_square, difference.largest);
    }
  }
  std::printf("%-17s %s; the verdict is on commands: a real robot has no hash of its motion\n", "mirror, motion",
              mirror_.motion_hash().c_str());
  std::printf("%-17s %s, %s\n", "mirror", recording_.c_str(), picture_of(recording_).c_str());
}

}  // namespace proleg::tools
