#include "sim/scenario/actuation_edit.hpp"

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

/// An element in the text, with its end tag.
struct TextElement {
  TextTag tag;
  std::size_t end;  ///< behind its last '>'
};

/// The elements of a module in the text that a tag may follow.
struct ModuleText {
  TextElement joint_configuration{};
  std::vector<TextElement> parameters{};
};

std::vector<ModuleText> find_modules(std::string_view text) {
  std::vector<ModuleText> modules;
  TextElement* last = nullptr;
  TagScanner tags(text);
  while (const std::optional<TextTag> tag = tags.next()) {
    const std::string name = lower_case(tag->name);
    if (tag->kind == TextTag::Kind::end) {
      if (last != nullptr) {
        last->end = tag->end;
      }
      last = nullptr;
    } else if (name == "actuationmodule") {
      modules.emplace_back();
    } else if (!modules.empty() && (name == "parameter" || name == "jointconfiguration")) {
      ModuleText& module = modules.back();
      TextElement& element = name == "parameter" ? module.parameters.emplace_back() : module.joint_configuration;
      element = {*tag, tag->end};
      last = tag->kind == TextTag::Kind::start ? &element : nullptr;
    }
  }
  return modules;
}

/// The text as an attribute in double quotes needs it.
std::string escaped(std::string_view text) {
  std::string result;
  for (const char character : text) {
    switch (character) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += character;
    }
  }
  return result;
}

/// What people see of a line.
std::string shown(std::string_view line) {
  constexpr std::size_t max_characters = 240;
  return shortened(trimmed(line), max_characters);
}

/// A line of a text, without its line end.
TextRange line_around(std::string_view text, std::size_t position) {
  const std::size_t before = text.substr(0, position).rfind('\n');
  const std::size_t end = std::min(text.find('\n', position), text.size());
  const bool has_return = end > position && text[end - 1] == '\r';
  return {before == std::string_view::npos ? 0 : before + 1, has_return ? end - 1 : end};
}

bool is_blank_or_comment(std::string_view rest) {
  rest = trimmed(rest);
  return rest.empty() || (rest.starts_with("<!--") && rest.find("-->") == rest.size() - 3);
}

class Editor {
 public:
  Editor(const Scenario& file, const Scenario& wanted)
      : file_(file), wanted_(wanted), text_(actuation_source(file).text), modules_(find_modules(text_)) {}

  std::vector<ActuationEdit> run() {
    const XmlDocument document(file_.actuation_file, std::string(text_), nullptr);
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
    const TextElement* for_all = nullptr;
    const TextElement* anchor = module.parameters.empty() ? &module.joint_configuration : &module.parameters.back();
    for (std::size_t i = 0; i < tags.size(); ++i) {
      const Setting& setting = tags[i].setting;
      if (setting.number != number) {
        continue;
      }
      anchor = &module.parameters[i];
      if (tags[i].is_for_all) {
        for_all = anchor;
        continue;
      }
      common.erase(setting.joint);
      if (setting.value != wanted(slot, setting.joint, number)) {
        replace_value(slot, number, JointMask::of(setting.joint), *anchor);
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
    if (is_uniform && for_all != nullptr) {
      replace_value(slot, number, common, *for_all);
    } else if (is_uniform && !has_own_tags) {
      add_tag(slot, number, common, {}, *anchor);
    } else {
      for (const unsigned joint : changed) {
        add_tag(slot, number, JointMask::of(joint), " joint=\"" + escaped(file_.robot.joints[joint].name) + '"',
                *anchor);
      }
    }
  }

  void replace_value(unsigned slot, unsigned number, JointMask joints, const TextElement& element) {
    const TextRange value = find_attribute(text_, element.tag, "value").value();  // the reader has read it
    ActuationEdit edit{
        slot, number, joints, value.begin, value.end - value.begin, value_text(slot, joints.front(), number)};
    show_changed_line(edit);
    edits_.push_back(std::move(edit));
  }

  /// Below the line of the element, or behind the element if its line has more than that.
  void add_tag(unsigned slot, unsigned number, JointMask joints, const std::string& joint_attribute,
               const TextElement& behind) {
    const std::string unit = shown_unit(parameter(slot, number).unit);
    const std::string tag = "<parameter name=\"" + std::string(parameter(slot, number).name) + "\" value=\"" +
                            value_text(slot, joints.front(), number) + '"' +
                            (unit.empty() ? "" : " unit=\"" + unit + '"') + joint_attribute + "/>";
    const TextRange first_line = line_around(text_, behind.tag.begin);
    const TextRange last_line = line_around(text_, behind.end);
    const std::string_view indentation = text_.substr(first_line.begin, behind.tag.begin - first_line.begin);
    ActuationEdit edit{slot, number, joints, behind.end, 0, tag};
    if (trimmed(indentation).empty() && is_blank_or_comment(text_.substr(behind.end, last_line.end - behind.end))) {
      edit.position = last_line.end;
      edit.text = (text_.substr(last_line.end).starts_with('\r') ? "\r\n" : "\n") + std::string(indentation) + tag;
      edit.line = line_at(text_, behind.end);
      edit.new_line = shown(tag);
    } else {
      show_changed_line(edit);
    }
    edits_.push_back(std::move(edit));
  }

  void show_changed_line(ActuationEdit& edit) const {
    const TextRange line = line_around(text_, edit.position);
    std::string changed(text_.substr(line.begin, line.end - line.begin));
    edit.line = line_at(text_, edit.position);
    edit.old_line = shown(changed);
    edit.new_line = shown(changed.replace(edit.position - line.begin, edit.removed, edit.text));
  }

  const Scenario& file_;
  const Scenario& wanted_;
  std::string_view text_;
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

std::string edited(std::string text, std::span<const ActuationEdit> edits) {
  std::vector<const ActuationEdit*> from_the_end;
  for (const ActuationEdit& edit : edits) {
    from_the_end.push_back(&edit);
  }
  // Tags that are added at one place keep their order.
  std::ranges::reverse(from_the_end);
  std::ranges::stable_sort(from_the_end, std::ranges::greater{}, &ActuationEdit::position);
  for (const ActuationEdit* edit : from_the_end) {
    text.replace(edit->position, edit->removed, edit->text);
  }
  return text;
}

Scenario with_actuation_text(const Scenario& scenario, const std::string& text) {
  SourceTexts files;
  for (const SourceFile& source : scenario.sources) {
    files.add(source.path, source.path == scenario.actuation_file ? text : source.text);
  }
  Scenario again = read_scenario(scenario.path, files, scenario.overrides);
  again.moves = scenario.moves;  // of the command line, as the overrides
  return again;
}

}  // namespace proleg::sim
