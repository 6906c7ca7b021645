#include "sim/data_file/data_file_writer.hpp"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "sim/data_file/data_frame_text.hpp"
#include "sim/data_file/module_output.hpp"
#include "sim/data_file/robot_frames.hpp"
#include "sim/record/tsv.hpp"

namespace proleg::sim {
namespace {

constexpr std::uint32_t frames_in_round = 100;

/// What a type of an actuation module shows.
struct TypeSource {
  enum class Kind : std::uint8_t { output, time, internal_value };
  Kind kind = Kind::internal_value;
  std::uint32_t number = 0;  ///< of the internal value
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
    std::vector<const RecordedInternalValue*> values;  // of one joint
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

  /// False for a module of which a data file has nothing.
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
  std::vector<std::size_t> first_value_;  ///< by joint: its first one in RecordedTick::internal_values
  std::vector<std::uint32_t> joints_;     ///< of the group, in the order of the file
  std::vector<std::string> type_names_;
  std::vector<TypeSource> sources_;
  std::unique_ptr<DataModuleText> text_;
};

/// A second slot with an algorithm has its number in its name, from 1 as on the command line.
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
