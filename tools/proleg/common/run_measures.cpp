#include "tools/proleg/common/run_measures.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <sstream>

#include "shared/computer/text/text.hpp"

namespace proleg::tools {
namespace {

constexpr double degrees = 180.0 / std::numbers::pi;

constexpr double much = sim::ServoTracking::much_time;
constexpr double large_error_deg = sim::ServoTracking::large_error * degrees;

/// Text "J3 is at its speed limit for 34 % of the time (5 joints above 20 %)"; empty if no joint is above 20 %.
std::string worst_joint(std::span<const sim::ServoTracking> servos, const sim::RobotModel& robot, const char* limit,
                        double (sim::ServoTracking::*share)() const) {
  std::size_t worst = 0;
  std::size_t joints = 0;
  for (std::size_t joint = 0; joint < servos.size(); ++joint) {
    const double its_share = (servos[joint].*share)();
    if (!(its_share > much) || !(servos[joint].rms_error() * degrees > large_error_deg)) {  // true for NaN, too
      continue;
    }
    ++joints;
    if (joints == 1 || its_share > (servos[worst].*share)()) {
      worst = joint;
    }
  }
  if (joints == 0) {
    return {};
  }
  std::ostringstream text;
  text << robot.joints[worst].name << " is at its " << limit << " limit for "
       << std::lround(100.0 * (servos[worst].*share)()) << " % of the time";
  if (joints > 1) {
    text << " (" << joints << " joints above " << std::lround(100.0 * much) << " %)";
  }
  return text.str();
}

}  // namespace

RunMeasures measures_of(const sim::GaitMeter& meter) {
  return {meter.values(), meter.link_duty_factors(), {meter.tracking().begin(), meter.tracking().end()}};
}

Json servos_array(const RunMeasures& measures, const sim::RobotModel& robot) {
  Json servos = Json::empty_array();
  for (std::size_t joint = 0; joint < measures.servos.size(); ++joint) {
    const sim::ServoTracking& servo = measures.servos[joint];
    servos.append(Json{{"joint", robot.joints[joint].name},
                       {"rms_error_deg", servo.rms_error() * degrees},
                       {"max_error_deg", servo.max_error() * degrees},
                       {"at_speed_limit", servo.at_speed_limit()},
                       {"at_torque_limit", servo.at_torque_limit()}});
  }
  return servos;
}

std::string servo_problem(std::span<const sim::ServoTracking> servos, const sim::RobotModel& robot) {
  const std::string speed = worst_joint(servos, robot, "speed", &sim::ServoTracking::at_speed_limit);
  const std::string torque = worst_joint(servos, robot, "torque", &sim::ServoTracking::at_torque_limit);
  if (speed.empty() && torque.empty()) {
    return {};
  }
  return "the servos cannot follow this gait: " + speed + (speed.empty() || torque.empty() ? "" : ", ") + torque;
}

void print_warning_on_servos(const std::string& program, const RunMeasures& measures, const sim::RobotModel& robot) {
  const std::string problem = servo_problem(measures.servos, robot);
  if (problem.empty()) {
    return;
  }
  std::array<char, 80> errors{};
  std::snprintf(errors.data(), errors.size(), "; angles differ from it by up to %.1f deg",
                measures.values[sim::Measure::max_tracking_error]);
  print_warning(program, problem + errors.data());
}

Json measures_object(const sim::MeasureValues& values) {
  Json object = Json::empty_object();
  for (const sim::MeasureDeclaration& declaration : sim::measures()) {
    object.add(declaration.name, values[declaration.measure]);
  }
  return object;
}

void add_measures_option(CommandLine& command_line, bool& all) {
  command_line.add_flag("--measures", all, "print all measures of the run; --json always has all");
}

void print_hashes(const std::string& setpoints, const std::string& servos, const std::optional<std::string>& world,
                  const std::string& motion) {
  std::printf("set-point hash    %s\n", setpoints.c_str());
  std::printf("servo hash        %s\n", servos.c_str());
  std::printf("world hash        %s\n",
              world ? world->c_str() : "none: the two above are of commands, and may be the same on another floor");
  std::printf("motion hash       %s\n", motion.c_str());
}

void print_measures(const sim::MeasureValues& values, bool all) {
  constexpr std::array most_important{sim::Measure::speed,   sim::Measure::sideways_speed,
                                      sim::Measure::heading, sim::Measure::specific_resistance,
                                      sim::Measure::slip,    sim::Measure::max_tracking_error};
  constexpr double noise = 1e-5;  // in any unit: what a straight gait goes sideways in rounding errors
  std::printf("measures (docs/gait-measures.md%s)\n", all ? "" : "; all: --measures");
  for (const sim::MeasureDeclaration& declaration : sim::measures()) {
    const double value = values[declaration.measure];
    if (!std::isfinite(value) ||
        !(all || std::ranges::find(most_important, declaration.measure) != most_important.end())) {
      continue;
    }
    const std::string unit(declaration.unit);
    std::printf("  %-28s  %.4g%s\n", std::string(declaration.name).c_str(), std::abs(value) < noise ? 0.0 : value,
                unit.empty() ? "" : (' ' + unit).c_str());
  }
}

Json sensors_array(const std::vector<sim::SensorSummary>& sensors) {
  Json array = Json::empty_array();
  for (const sim::SensorSummary& summary : sensors) {
    array.append(Json{{"sensor", summary.name},
                      {"type", std::string(sim::name_of(summary.kind))},
                      {"quantity", std::string(summary.quantity)},
                      {"unit", std::string(summary.unit)},
                      {"least", summary.least},
                      {"greatest", summary.greatest},
                      {"mean", summary.mean()}});
  }
  return array;
}

void print_sensors(const std::vector<sim::SensorSummary>& sensors) {
  if (sensors.empty()) {
    return;
  }
  std::printf("sensors\n");
  for (const sim::SensorSummary& summary : sensors) {
    const std::string name = summary.name + ' ' + std::string(summary.quantity);
    if (summary.kind == sim::SensorKind::touch) {
      std::printf("  %-28s  %.3g %% of the time\n", name.c_str(), 100.0 * summary.mean());
    } else {
      std::printf("  %-28s  %.4g to %.4g %s, mean %.4g\n", name.c_str(), summary.least, summary.greatest,
                  std::string(summary.unit).c_str(), summary.mean());
    }
  }
}

void append_sensors(const std::vector<sim::SensorSummary>& sensors,
                    std::vector<std::pair<std::string, std::string>>& results) {
  for (const sim::SensorSummary& summary : sensors) {
    const std::string name = "sensor." + summary.name + '.' + std::string(summary.quantity) + '.';
    if (summary.count > 0) {
      results.emplace_back(name + "least", exact_text(summary.least));
      results.emplace_back(name + "greatest", exact_text(summary.greatest));
      results.emplace_back(name + "mean", exact_text(summary.mean()));
    }
  }
}

void append_results(const RunMeasures& measures, const sim::RobotModel& robot,
                    std::vector<std::pair<std::string, std::string>>& results) {
  for (const sim::MeasureDeclaration& declaration : sim::measures()) {
    if (std::isfinite(measures.values[declaration.measure])) {
      results.emplace_back(declaration.name, exact_text(measures.values[declaration.measure]));
    }
  }
  for (std::size_t link = 0; link < robot.links.size(); ++link) {
    results.emplace_back("duty_factor." + robot.links[link].name, exact_text(measures.link_duty_factors[link]));
  }
}

}  // namespace proleg::tools
