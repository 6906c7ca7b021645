#include "sim/record/run_tables.hpp"

#include <span>

#include "shared/computer/text/text.hpp"
#include "shared/fixed/decimal.hpp"
#include "shared/kernel/fingerprint.hpp"
#include "sim/record/recorded_scenario.hpp"
#include "sim/record/schema.hpp"
#include "sim/scenario/settings.hpp"

namespace proleg::sim {
namespace {

std::string_view solver_name(Solver solver) {
  switch (solver) {
    case Solver::automatic:
      return "automatic";
    case Solver::direct:
      return "direct";
    case Solver::iterative:
      break;
  }
  return "iterative";
}

/// What the command line gave instead of the files; the words repeat the run.
template <typename Put>
void write_overrides(const Overrides& overrides, const Put& put) {
  const OverrideWords words = words_of(overrides);
  for (const OverrideDeclaration& declaration : override_declarations()) {
    if (const std::optional<std::string>& word = words.*declaration.word) {
      put("override_" + std::string(declaration.name), *word);
    }
  }
}

void write_run(Database& database, const Scenario& scenario, const std::string& program, const std::string& build_id) {
  Statement insert(database, "INSERT INTO run VALUES(?1, ?2)");
  const auto put = [&insert](std::string_view key, std::string_view value) { insert.run(key, value); };
  put("format", std::to_string(recording_format));
  put("program", program);
  put("build_id", build_id);
  put("core_fingerprint", hexadecimal(core_fingerprint, 8));
  if (scenario.environment.engine != PhysicsEngine::reduced) {  // whose motion is the same on every processor
    put("processor", processor_text());
  }
  if (const std::string algorithms = user_algorithms_text(scenario.kernel); !algorithms.empty()) {
    put("user_algorithms", algorithms);
  }
  put("scenario", scenario.path);
  put("robot", scenario.robot.name);
  put("joint_count", std::to_string(scenario.robot.joints.size()));
  put("seed", std::to_string(scenario.kernel.seed));
  put("tick_us", std::to_string(scenario.kernel.tick_period_us));
  put("step_s", exact_text(scenario.step_s));
  put("engine", name_of(scenario.environment.engine));
  put("solver", solver_name(scenario.solver));
  put("planned_duration_s", exact_text(scenario.duration_s));
  put("servo_period_us", std::to_string(scenario.robot.servo.period_us));
  put("command_speed_deg_per_s", std::to_string(scenario.robot.servo.command_speed));
  put("servo_gain_per_s", exact_text(scenario.robot.servo.gain));
  write_overrides(scenario.overrides, put);
  put("finished", "0");

  Statement source(database, "INSERT INTO source(path, text) VALUES(?1, ?2)");
  for (const SourceFile& file : scenario.sources) {
    source.run(std::string_view(file.path), std::string_view(file.text));
  }
}

void write_robot(Database& database, const Scenario& scenario) {
  Statement joint(database, "INSERT INTO joint VALUES(?1, ?2, ?3, ?4, ?5)");
  for (std::size_t i = 0; i < scenario.robot.joints.size(); ++i) {
    const AngleLimits& limits = scenario.joint_limits[i];
    joint.run(i, std::string_view(scenario.robot.joints[i].name), scenario.robot.joints[i].file_index, limits.lower,
              limits.upper);
  }
  Statement link(database, "INSERT INTO link VALUES(?1, ?2)");
  for (std::size_t i = 0; i < scenario.robot.links.size(); ++i) {
    link.run(i, std::string_view(scenario.robot.links[i].name));
  }
  Statement object(database, "INSERT INTO object VALUES(?1, ?2)");
  for (std::size_t i = 0; i < scenario.environment.moving_objects.size(); ++i) {
    object.run(i, std::string_view(scenario.environment.moving_objects[i].name));
  }
}

void write_sensors(Database& database, const RobotModel& robot) {
  Statement sensor(database, "INSERT INTO sensor VALUES(?1, ?2, ?3, ?4)");
  Statement channel(database, "INSERT INTO sensor_channel VALUES(?1, ?2, ?3, ?4)");
  for (std::size_t i = 0; i < robot.sensors.size(); ++i) {
    const AttachedSensor& attached = robot.sensors[i];
    sensor.run(i, std::string_view(attached.name), name_of(attached.kind), attached.part);
    const std::vector<SensorChannel> channels = channels_of(attached);
    for (std::size_t number = 0; number < channels.size(); ++number) {
      channel.run(i, number, std::string_view(channels[number].name), channels[number].unit);
    }
  }
}

void write_start_parameters(ParameterTable& table, const Scenario& scenario, std::uint32_t slot) {
  const Slot& used = scenario.kernel.slots[slot];
  const std::span<const Parameter> parameters = used.algorithm->declaration().parameters;
  for (std::uint32_t joint = 0; joint < scenario.kernel.joint_count; ++joint) {
    if (!used.group.contains(joint)) {
      continue;
    }
    for (std::uint32_t i = 0; i < parameters.size(); ++i) {
      table.add(0, "start", slot, joint, i, start_value(scenario, slot, joint, i));
    }
  }
}

void write_slots(Database& database, const Scenario& scenario) {
  Statement insert_slot(database, "INSERT INTO slot VALUES(?1, ?2, ?3, ?4)");
  ParameterTable parameters(database, scenario);
  Statement insert_name(database, "INSERT INTO internal_value_name VALUES(?1, ?2, ?3, ?4, ?5)");
  for (std::uint32_t number = 0; number < max_slots; ++number) {
    const Slot& slot = scenario.kernel.slots[number];
    if (slot.algorithm == nullptr) {
      continue;
    }
    const Declaration& declaration = slot.algorithm->declaration();
    std::string group;
    for (unsigned joint = 0; joint < scenario.kernel.joint_count; ++joint) {
      group += slot.group.contains(joint) ? '1' : '0';
    }
    insert_slot.run(number, declaration.name, std::uint32_t{declaration.id}, std::string_view(group));
    for (std::size_t i = 0; i < declaration.internal_values.size(); ++i) {
      const InternalValue& value = declaration.internal_values[i];
      const UnitScale scale = scale_of(value.unit);
      insert_name.run(number, i, value.name, std::string_view(scale.symbol),
                      static_cast<double>(scale.denominator) / static_cast<double>(scale.numerator));
    }
    write_start_parameters(parameters, scenario, number);
  }
}

}  // namespace

void write_run_tables(Database& database, const Scenario& scenario, const std::string& program,
                      const std::string& build_id) {
  write_run(database, scenario, program, build_id);
  write_robot(database, scenario);
  write_sensors(database, scenario.robot);
  write_slots(database, scenario);
}

void ParameterTable::add(std::uint32_t tick, std::string_view origin, std::uint32_t slot, std::uint32_t joint,
                         std::uint32_t index, std::int32_t value) {
  const Parameter& parameter = scenario_.kernel.slots[slot].algorithm->declaration().parameters[index];
  insert_.run(tick, origin, slot, joint, parameter.name, std::string_view(scale_of(parameter.unit).symbol), value,
              format_decimal(value, parameter.unit).view());
}

}  // namespace proleg::sim
