#include "tools/proleg/robot/mirrored_run.hpp"

#include <cstdio>

#include "shared/computer/output/output.hpp"
#include "shared/computer/text/text.hpp"
#include "tools/proleg/common/beside_recording.hpp"

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
                     {"servo_hash", check.servo_hash().hex()}});
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
  return {{"recording", recording_}, {"picture", picture_of(recording_).string()}, {"joints", joints}};
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
  std::printf("%-17s %s, %s\n", "mirror", recording_.c_str(), picture_of(recording_).c_str());
}

}  // namespace proleg::tools
