#include "tools/proleg/robot/drive_report.hpp"

#include <cstdio>
#include <iostream>
#include <vector>

#include "shared/computer/text/text.hpp"
#include "tools/proleg/common/json_output.hpp"

namespace proleg::tools {
namespace {

/// The verdict on all bits of the set-points; empty if no module was asked.
std::string setpoint_verdict(const GaitCheck& check) {
  if (!check.different_setpoints().empty()) {
    return "the set-points of " + listed(check.different_setpoints()) +
           " differ, in bits that state frames do not carry";
  }
  if (!check.not_compared_setpoints().empty()) {
    return "not all bits of the set-points were compared: " + listed(check.not_compared_setpoints());
  }
  return check.equal_setpoints().empty() ? "" : "all bits of all set-points are equal";
}

std::string verdict(const GaitCheck& check) {
  if (check.first_difference()) {
    return std::to_string(check.differences()) + " state frames differ from the gait of this computer, the first at " +
           *check.first_difference();
  }
  std::string text = "0 differences in " + std::to_string(check.compared()) + " state frames";
  if (check.missing() > 0) {
    text += ", " + std::to_string(check.missing()) + " were not received";
  }
  if (check.end_of_comparison()) {
    return text + "; " + *check.end_of_comparison();
  }
  const std::string setpoints = setpoint_verdict(check);
  return setpoints.empty() ? text : text + "; " + setpoints;
}

Json texts(const std::vector<std::string>& items) {
  Json list = Json::empty_array();
  for (const std::string& item : items) {
    list.append(item);
  }
  return list;
}

}  // namespace

void print_result(const DriveOptions& options, const DriveResult& result, const GaitCheck& check, double seconds,
                  const MirroredRun* mirrored) {
  if (options.json) {
    std::cout << Json{{"scenario", options.file},
                      {"bus", options.bus.address()},
                      {"ticks", result.ticks},
                      {"driven_s", seconds},
                      {"differences", check.differences()},
                      {"first_difference", check.first_difference()},
                      {"frames_compared", check.compared()},
                      {"frames_missing", check.missing()},
                      {"comparison_ended", check.end_of_comparison()},
                      {"setpoints_equal", check.equal_setpoints().size()},
                      {"setpoints_different", texts(check.different_setpoints())},
                      {"setpoints_not_compared", texts(check.not_compared_setpoints())},
                      {"restarts", result.restarts},
                      {"dropped_changes", result.dropped_changes},
                      {"setpoint_hash", check.setpoint_hash().hex()},
                      {"servo_hash", check.servo_hash().hex()},
                      {"servo_period_ms", check.servo_period_us() * 1e-3},
                      {"frames_sent", result.bus.transmitted},
                      {"frames_received", result.bus.received},
                      {"answer_ms", durations_object(result.answers_us, 1e-3)},
                      {"change_acknowledged_ms", durations_object(result.acknowledged_us, 1e-3)},
                      {"change_effect_ticks", durations_object(result.ticks_to_effect, 1)},
                      {"recording", options.record.value_or("")},
                      {"mirror", mirrored != nullptr ? mirrored->json() : Json()}}
                     .text()
              << '\n';
    return;
  }
  std::printf("driven            %.2f s, %u ticks\n", seconds, result.ticks);
  std::printf("verdict           %s\n", verdict(check).c_str());
  std::printf("frames            %llu sent, %llu received\n", static_cast<unsigned long long>(result.bus.transmitted),
              static_cast<unsigned long long>(result.bus.received));
  std::printf("answers           after %s\n", durations_text(result.answers_us, 1e-3, "ms", "SDO requests").c_str());
  if (result.acknowledged_us.count() > 0) {
    std::printf("changes           all modules had them after %s\n",
                durations_text(result.acknowledged_us, 1e-3, "ms", "changes").c_str());
  }
  if (result.ticks_to_effect.count() > 0) {
    std::printf("typed changes     took effect after %s\n",
                durations_text(result.ticks_to_effect, 1, "ticks", "changes").c_str());
  }
  if (result.restarts > 0) {
    std::printf("restarts          %u\n", result.restarts);
  }
  std::printf("set-point hash    %s\n", check.setpoint_hash().hex().c_str());
  std::printf("servo hash        %s, of a pulse every %s ms\n", check.servo_hash().hex().c_str(),
              number_text(check.servo_period_us() * 1e-3).c_str());
  if (options.record) {
    std::printf("recording         %s\n", options.record->c_str());
  }
  if (mirrored != nullptr) {
    mirrored->print();
  }
}

}  // namespace proleg::tools
