#include "sim/authoring/actuation_edit.hpp"

#include <algorithm>
#include <string_view>
#include <utility>

#include "shared/computer/text/text.hpp"
#include "shared/fixed/decimal.hpp"
#include "sim/scenario/actuation_reader.hpp"
#include "sim/scenario/names.hpp"
#include "sim/scenario/reader.hpp"
#include "sim/scenario/settings.hpp"
#include "sim/scenario/sources.hpp"
#include "sim/scenario/tag_scanner.hpp"

namespace proleg::sim {
namespace {

/// The elements of a module in the text that a tag may follow.
struct ModuleText {
  ElementNumber joint_configuration = 0;
  std::vector<ElementNumber> parameters = {};
};

std::vector<ModuleText> find_modules(const XmlText& xml) {
  std::vector<ModuleText> modules;
  for (ElementNumber i = 0; i < xml.size(); ++i) {
    if (xml.is(i, "actuationModule")) {
      modules.emplace_back();
    } else if (!modules.empty() && xml.is(i, "parameter")) {
      modules.back().parameters.push_back(i);
    } else if (!modules.empty() && xml.is(i, "jointConfiguration")) {
      modules.back().joint_configuration = i;
    }
  }
  return modules;
}

/// What people see of a line.
std::string shown(std::string_view line) {
  constexpr std::size_t max_characters = 240;
  return shortened(trimmed(line), max_characters);
}

/// A line of a text, without its line end.
TextRange line_around(std::string_view text, std::size_t position) {
  const std::size_t end = std::min(text.find('\n', position), text.size());
  const bool has_return = end > position && text[end - 1] == '\r';
  return {line_begin(text, position), has_return ? end - 1 : end};
}

class Editor {
 public:
  Editor(const Scenario& file, const Scenario& wanted)
      : file_(file),
        wanted_(wanted),
        xml_(file.actuation_file, actuation_source(file).text),
        modules_(find_modules(xml_)) {}

  std::vector<ActuationEdit> run() {
    const XmlDocument document(file_.actuation_file, xml_.text(), nullptr);
    const std::vector<XmlElement> modules = actuation_modules(document);
    for (unsigned slot = 0; slot < modules.size(); ++slot) {
      edit_module(slot, read_parameter_tags(modules[slot], file_, slot));
    }
    return std::move(edits_);
  }

 private:
  [[nodiscard]] std::int32_t wanted(unsigned slot, unsigned joint, unsigned number) const {
    return start_value(wanted_, slot, joint, number);
  }
  [[nodiscard]] bool want_one_value(unsigned slot, JointMask joints, unsigned number) const {
    for (const unsigned joint : joints) {
      if (wanted(slot, joint, number) != wanted(slot, joints.front(), number)) {
        return false;
      }
    }
    return true;
  }
  [[nodiscard]] const Parameter& parameter(unsigned slot, unsigned number) const {
    return file_.kernel.slots[slot].algorithm->declaration().parameters[number];
  }
  [[nodiscard]] std::string value_text(unsigned slot, unsigned joint, unsigned number) const {
    return std::string(format_decimal(wanted(slot, joint, number), parameter(slot, number).unit).view());
  }

  void edit_module(unsigned slot, const std::vector<ParameterTag>& tags) {
    const std::size_t count = file_.kernel.slots[slot].algorithm->declaration().parameters.size();
    for (unsigned number = 0; number < count; ++number) {
      edit_parameter(slot, number, tags);
    }
  }

  void edit_parameter(unsigned slot, unsigned number, const std::vector<ParameterTag>& tags) {
    const ModuleText& module = modules_[slot];
    JointMask common = file_.kernel.slots[slot].group;  // joints without a tag of their own
    std::optional<ElementNumber> for_all;
    ElementNumber anchor = module.parameters.empty() ? module.joint_configuration : module.parameters.back();
    for (std::size_t i = 0; i < tags.size(); ++i) {
      const Setting& setting = tags[i].setting;
      if (setting.number != number) {
        continue;
      }
      anchor = module.parameters[i];
      if (tags[i].is_for_all) {
        for_all = anchor;
        continue;
      }
      common.erase(setting.joint);
      if (setting.value != wanted(slot, setting.joint, number)) {
        replace_value(slot, number, JointMask::of(setting.joint), anchor);
      }
    }
    JointMask changed;
    for (const unsigned joint : common) {
      if (wanted(slot, joint, number) != start_value(file_, slot, joint, number)) {
        changed.insert(joint);
      }
    }
    if (changed.empty()) {
      return;
    }
    const bool has_own_tags = common != file_.kernel.slots[slot].group;
    const bool is_uniform = changed == common && want_one_value(slot, common, number);
    if (is_uniform && for_all) {
      replace_value(slot, number, common, *for_all);
    } else if (is_uniform && !has_own_tags) {
      add_tag(slot, number, common, {}, anchor);
    } else {
      for (const unsigned joint : changed) {
        add_tag(slot, number, JointMask::of(joint), " joint=\"" + escaped_xml(file_.robot.joints[joint].name) + '"',
                anchor);
      }
    }
  }

  void replace_value(unsigned slot, unsigned number, JointMask joints, ElementNumber element) {
    const std::string value = value_text(slot, joints.front(), number);
    ActuationEdit edit{slot, number, joints, xml_.set_attribute(element, "value", value)};
    show_changed_line(edit);
    edits_.push_back(std::move(edit));
  }

  /// Below the line of the element, or behind the element if its line has more than that.
  void add_tag(unsigned slot, unsigned number, JointMask joints, const std::string& joint_attribute,
               ElementNumber behind) {
    const std::string unit = shown_unit(parameter(slot, number).unit);
    const std::string tag = "<parameter name=\"" + std::string(parameter(slot, number).name) + "\" value=\"" +
                            value_text(slot, joints.front(), number) + '"' +
                            (unit.empty() ? "" : " unit=\"" + unit + '"') + joint_attribute + "/>";
    ActuationEdit edit{slot, number, joints, xml_.add_behind(behind, tag)};
    if (edit.patch.inserted.starts_with('<')) {
      show_changed_line(edit);
    } else {  // a line of its own
      edit.line = line_at(xml_.text(), xml_.at(behind).end);
      edit.new_line = shown(tag);
    }
    edits_.push_back(std::move(edit));
  }

  void show_changed_line(ActuationEdit& edit) const {
    const TextRange line = line_around(xml_.text(), edit.patch.position);
    std::string changed = xml_.text().substr(line.begin, line.end - line.begin);
    edit.line = line_at(xml_.text(), edit.patch.position);
    edit.old_line = shown(changed);
    apply({edit.patch.position - line.begin, edit.patch.removed, edit.patch.inserted}, changed);
    edit.new_line = shown(changed);
  }

  const Scenario& file_;
  const Scenario& wanted_;
  XmlText xml_;
  std::vector<ModuleText> modules_;
  std::vector<ActuationEdit> edits_;
};

}  // namespace

const SourceFile& actuation_source(const Scenario& scenario) {
  return *std::ranges::find(scenario.sources, scenario.actuation_file, &SourceFile::path);
}

std::vector<ActuationEdit> actuation_edits(const Scenario& file, const Scenario& wanted) {
  return Editor(file, wanted).run();
}

std::vector<const ActuationEdit*> from_the_end(std::span<const ActuationEdit> edits) {
  std::vector<const ActuationEdit*> ordered;
  for (const ActuationEdit& edit : edits) {
    ordered.push_back(&edit);
  }
  // Tags that are added at one place keep their order.
  std::ranges::reverse(ordered);
  std::ranges::stable_sort(ordered, std::ranges::greater{},
                           [](const ActuationEdit* edit) { return edit->patch.position; });
  return ordered;
}

std::string edited(std::string text, std::span<const ActuationEdit> edits) {
  for (const ActuationEdit* edit : from_the_end(edits)) {
    apply(edit->patch, text);
  }
  return text;
}

Scenario with_actuation_text(const Scenario& scenario, const std::string& text) {
  SourceTexts files;
  for (const SourceFile& source : scenario.sources) {
    files.add(source.path, source.path == scenario.actuation_file ? SharedText(text) : source.text);
  }
  Scenario again = read_scenario(scenario.path, files, scenario.overrides);
  again.moves = scenario.moves;  // of the command line, as the overrides
  return again;
}

}  // namespace proleg::sim
