#include "sim/data_file/data_file_writer.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "shared/gait/actuation_module.hpp"
#include "shared/gait/registry.hpp"
#include "sim/data_file/robot_frames.hpp"
#include "sim/record/recording.hpp"
#include "sim/record/tsv.hpp"

namespace proleg::sim {
namespace {

/// The outputs of one slot on its joints, computed by the core from recorded parameters and internal values. Ticks must
/// ascend.
class ModuleOutput {
 public:
  /// recording must outlive this object.
  ModuleOutput(const Recording& recording, const RecordedSlot& slot);

  /// Whether this program's core has the algorithm, with the same internal values.
  [[nodiscard]] bool is_known() const { return algorithm_ != nullptr; }
  /// The output that belongs to the recorded state of `tick` (90 degrees = 2^30), without the limits of the joint.
  /// state: the internal values of the joint in their order. is_known() must be true, and the slot must have the joint.
  [[nodiscard]] std::int32_t at(std::uint32_t tick, std::uint32_t joint, const std::int32_t* state);

 private:
  struct JointTuning {
    std::array<std::int32_t, max_parameters> parameters{};
    std::array<std::int32_t, max_derived> derived{};
  };

  void apply(const RecordedSetting& setting);
  void derive(std::uint32_t joint);

  const Recording& recording_;
  const RecordedSlot& slot_;
  const ActuationModule* algorithm_ = nullptr;
  std::vector<RecordedSetting> settings_;  ///< settings of the slot, first those of the start
  std::size_t next_setting_ = 0;
  std::vector<JointTuning> tunings_;  ///< tunings by joint
};

bool has_recorded_values(const Declaration& declaration, const Recording& recording, std::uint32_t slot) {
  for (const RecordedInternalValue& value : recording.internal_values()) {
    if (value.slot == slot && (value.number >= declaration.internal_values.size() ||
                               declaration.internal_values[value.number].name != value.name)) {
      return false;
    }
  }
  const auto recorded = std::ranges::count_if(
      recording.internal_values(), [slot](const RecordedInternalValue& value) { return value.slot == slot; });
  const auto group = std::ranges::find(recording.slots(), slot, &RecordedSlot::slot);
  const auto joints = std::ranges::count(group->joint_group, true);
  return static_cast<std::size_t>(recorded) == static_cast<std::size_t>(joints) * declaration.internal_values.size();
}

ModuleOutput::ModuleOutput(const Recording& recording, const RecordedSlot& slot) : recording_(recording), slot_(slot) {
  const ActuationModule* algorithm = find_algorithm(slot.algorithm);
  if (algorithm == nullptr || !has_recorded_values(algorithm->declaration(), recording, slot.slot)) {
    return;
  }
  algorithm_ = algorithm;
  for (const RecordedSetting& setting : recording.parameters()) {
    if (setting.slot == slot.slot && find_parameter(algorithm->declaration(), setting.name) >= 0) {
      settings_.push_back(setting);
    }
  }
  std::ranges::stable_sort(settings_, [](const RecordedSetting& a, const RecordedSetting& b) {
    return (a.commit ? a.tick + 1 : 0) < (b.commit ? b.tick + 1 : 0);
  });
  JointTuning defaults;
  for (std::size_t i = 0; i < algorithm->declaration().parameters.size(); ++i) {
    defaults.parameters[i] = algorithm->declaration().parameters[i].default_value;
  }
  tunings_.assign(recording.joints().size(), defaults);
  while (next_setting_ < settings_.size() && !settings_[next_setting_].commit) {
    apply(settings_[next_setting_++]);
  }
  for (std::uint32_t joint = 0; joint < tunings_.size(); ++joint) {
    derive(joint);
  }
}

void ModuleOutput::apply(const RecordedSetting& setting) {
  const int parameter = find_parameter(algorithm_->declaration(), setting.name);
  tunings_[setting.joint].parameters[static_cast<std::size_t>(parameter)] = setting.raw;
}

void ModuleOutput::derive(std::uint32_t joint) {
  JointContext context{static_cast<std::uint8_t>(joint), static_cast<std::uint8_t>(tunings_.size()), JointMask(),
                       recording_.tick_period_us()};
  for (std::uint32_t member = 0; member < tunings_.size(); ++member) {
    if (slot_.joint_group[member]) {
      context.group.insert(member);
    }
  }
  algorithm_->derive(context, tunings_[joint].parameters.data(), tunings_[joint].derived.data());
}

std::int32_t ModuleOutput::at(std::uint32_t tick, std::uint32_t joint, const std::int32_t* state) {
  while (next_setting_ < settings_.size() && settings_[next_setting_].tick <= tick) {
    apply(settings_[next_setting_]);
    derive(settings_[next_setting_++].joint);
  }
  return algorithm_->output({tunings_[joint].parameters.data(), tunings_[joint].derived.data()}, state);
}

constexpr std::uint32_t frames_in_round = 100;

/// The source of a type of an actuation module.
struct TypeSource {
  enum class Kind : std::uint8_t { output, time, internal_value };
  Kind kind = Kind::internal_value;
  std::uint32_t number = 0;  ///< number of the internal value
  Unit unit = Unit::degree;
};

double value_in_unit(std::int32_t raw, Unit unit) {
  const UnitScale scale = scale_of(unit);
  return static_cast<double>(raw) * scale.denominator / scale.numerator;
}

/// The frames of an actuation module.
class ActuationFrames {
 public:
  ActuationFrames(const Recording& recording, const RecordedSlot& slot, const FileOrder& order, const std::string& name)
      : output_(recording, slot), first_value_(recording.joints().size(), 0) {
    for (const std::uint32_t joint : order.joints) {
      if (slot.joint_group[joint]) {
        joints_.push_back(joint);
      }
    }
    std::vector<const RecordedInternalValue*> values;  // values of one joint
    for (std::size_t i = 0; i < recording.internal_values().size(); ++i) {
      const RecordedInternalValue& value = recording.internal_values()[i];
      if (value.slot != slot.slot) {
        continue;
      }
      if (value.number == 0) {
        first_value_[value.joint] = i;
      }
      if (!joints_.empty() && value.joint == joints_.front()) {
        values.push_back(&value);
      }
    }
    choose_types(slot.algorithm, values);
    std::vector<std::string> names;
    for (const std::uint32_t joint : joints_) {
      names.push_back(recording.joints()[joint].name);
    }
    text_ = std::make_unique<DataModuleText>(name, type_names_, names);
  }

  /// Whether a data file has data of the module.
  [[nodiscard]] bool has_data() const { return !joints_.empty() && !sources_.empty(); }
  [[nodiscard]] DataModuleText& text() { return *text_; }

  void add(const RecordedTick& tick, double time_s) {
    std::vector<double> numbers(joints_.size());
    for (const TypeSource& source : sources_) {
      for (std::size_t i = 0; i < joints_.size(); ++i) {
        numbers[i] = value_of(source, tick, joints_[i], time_s);
      }
      text_->add(numbers);
    }
  }

 private:
  void add_type(const std::string& name, TypeSource source) {
    type_names_.push_back(name);
    sources_.push_back(source);
  }

  void choose_types(const std::string& algorithm, const std::vector<const RecordedInternalValue*>& values) {
    const std::vector<std::string> of_generators{"current_phase", "measured_frequency", "measured_phase_difference"};
    const bool is_generator = algorithm.starts_with("PatternGenerator_") && output_.is_known() &&
                              values.size() >= of_generators.size() &&
                              std::ranges::equal(of_generators, std::span(values).first(of_generators.size()), {}, {},
                                                 &RecordedInternalValue::name);
    std::size_t next = 0;
    if (is_generator) {
      add_type("Angle", {TypeSource::Kind::output});
      add_type("Time", {TypeSource::Kind::time});
      add_type("Phase_Difference", {TypeSource::Kind::internal_value, 2, values[2]->unit});
      add_type("Frequency", {TypeSource::Kind::internal_value, 1, values[1]->unit});
      next = of_generators.size();
    } else if (output_.is_known()) {
      add_type("desired_angle", {TypeSource::Kind::output});
    }
    for (; next < values.size(); ++next) {
      const std::string name = tag_name(values[next]->name + unit_suffix(values[next]->unit));
      if (std::ranges::find(type_names_, name) == type_names_.end()) {
        add_type(name, {TypeSource::Kind::internal_value, values[next]->number, values[next]->unit});
      }
    }
  }

  [[nodiscard]] double value_of(const TypeSource& source, const RecordedTick& tick, std::uint32_t joint,
                                double time_s) {
    switch (source.kind) {
      case TypeSource::Kind::time:
        return time_s;
      case TypeSource::Kind::output:
        return value_in_unit(output_.at(tick.tick, joint, tick.internal_values.data() + first_value_[joint]),
                             Unit::degree);
      case TypeSource::Kind::internal_value:
        break;
    }
    return value_in_unit(tick.internal_values[first_value_[joint] + source.number], source.unit);
  }

  ModuleOutput output_;
  std::vector<std::size_t> first_value_;  ///< index of each joint's first value in RecordedTick::internal_values
  std::vector<std::uint32_t> joints_;     ///< joints of the group, in the order of the file
  std::vector<std::string> type_names_;
  std::vector<TypeSource> sources_;
  std::unique_ptr<DataModuleText> text_;
};

/// Name of a slot's module. A second slot with an algorithm has its number in its name, from 1 as on the command line.
std::string module_name(const Recording& recording, const RecordedSlot& slot) {
  const std::string name = thesis_module_name(slot.algorithm);
  const auto first = std::ranges::find(recording.slots(), slot.algorithm, &RecordedSlot::algorithm);
  return first->slot == slot.slot ? name : name + "." + std::to_string(slot.slot + 1);
}

}  // namespace

std::string thesis_module_name(std::string_view algorithm) {
  return std::string(algorithm == "SensingModule_global_adaptive_touch" ? "Global_Adaptive_Touch" : algorithm);
}

void write_data_file(const Recording& recording, const std::optional<Scenario>& scenario,
                     const std::function<void(std::string_view)>& write) {
  const FileOrder order(recording);
  std::vector<std::unique_ptr<ActuationFrames>> modules;
  for (const RecordedSlot& slot : recording.slots()) {
    auto frames = std::make_unique<ActuationFrames>(recording, slot, order, module_name(recording, slot));
    if (frames->has_data()) {
      modules.push_back(std::move(frames));
    }
  }
  TactileFrames tactile(recording, order);
  RobotFrames robot(recording, order, scenario);
  std::vector<DataModuleText*> texts;
  texts.reserve(modules.size() + 2);
  for (const auto& module : modules) {
    texts.push_back(&module->text());
  }
  texts.push_back(&tactile.text());
  texts.push_back(&robot.text());

  write("<dataroot>\n  <header>\n");
  for (const DataModuleText* text : texts) {
    write(text->header());
  }
  write("  </header>\n");
  std::uint32_t round = 0;
  recording.read_ticks(recording.first_tick(), recording.last_tick(), [&](const RecordedTick& tick) {
    const double time_s = recording.time_s(tick.tick);
    const double time_ms = 1e3 * time_s;
    for (DataModuleText* text : texts) {
      // Recordings have no time of day, so that equal runs have equal recordings.
      text->begin_frame(tick.tick, time_ms, time_ms);
    }
    for (const auto& module : modules) {
      module->add(tick, time_s);
    }
    tactile.add(tick);
    robot.add(tick);
    for (DataModuleText* text : texts) {
      text->end_frame();
    }
    if (tick.tick == recording.last_tick() || (tick.tick - recording.first_tick() + 1) % frames_in_round == 0) {
      write("  <round number=\"" + std::to_string(round++) + "\">\n");
      for (DataModuleText* text : texts) {
        write(text->finish_round());
      }
      write("  </round>\n");
    }
  });
  write("</dataroot>\n");
}

}  // namespace proleg::sim
