#include "shared/computer/algorithm_library/declaration_copy.hpp"

#include <algorithm>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/gait/state_frame.hpp"

namespace proleg {
namespace {

template <std::size_t capacity>
void copy_text(std::string_view from, CapturedDeclaration::Text<capacity>& to) {
  to.size = from.size();
  std::copy_n(from.data(), std::min(from.size(), capacity), to.characters.begin());
}

/// Whether a text can be a name: names are words in files, and arguments of the command line.
bool is_name(std::string_view text) {
  const auto is_letter = [](char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); };
  return !text.empty() && is_letter(text.front()) &&
         std::ranges::all_of(text, [&](char c) { return is_letter(c) || (c >= '0' && c <= '9') || c == '_'; });
}

template <std::size_t capacity>
std::string text_of(const CapturedDeclaration::Text<capacity>& text, const std::string& what, const std::string& file) {
  if (text.size > capacity) {
    throw InputError(file, 0, what + " of " + std::to_string(text.size) + " characters",
                     "at most " + std::to_string(capacity));
  }
  return {text.characters.data(), text.size};
}

template <std::size_t capacity>
std::string name_of(const CapturedDeclaration::Text<capacity>& text, const std::string& what, const std::string& file) {
  std::string name = text_of(text, what, file);
  if (!is_name(name)) {
    throw InputError(file, 0, what + " " + in_quotes(name), "a letter, then letters, digits and _");
  }
  return name;
}

void expect_count(const char* what, std::size_t found, std::size_t least, std::size_t most, const std::string& file) {
  if (found < least || found > most) {
    throw InputError(file, 0, std::to_string(found) + " " + what,
                     std::to_string(least) + " to " + std::to_string(most));
  }
}

void expect_unit(Unit unit, const std::string& name, const std::string& file) {
  if (static_cast<std::uint8_t>(unit) > static_cast<std::uint8_t>(Unit::count)) {
    throw InputError(file, 0, "unit " + std::to_string(static_cast<unsigned>(unit)) + " of " + in_quotes(name),
                     "one of shared/fixed/unit.hpp");
  }
}

template <typename Named>
void expect_unique(const std::vector<Named>& items, const char* what, const std::string& file) {
  for (std::size_t i = 0; i < items.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (items[i].name == items[j].name) {
        throw InputError(file, 0, std::string("two ") + what + " with the name " + in_quotes(items[i].name),
                         "different names");
      }
    }
  }
}

}  // namespace

void CapturedDeclaration::capture(const Declaration& declaration) {
  id = declaration.id;
  sources = declaration.sources;
  copy_text(declaration.name, name);
  copy_text(declaration.help, help);
  parameter_count = declaration.parameters.size();
  value_count = declaration.internal_values.size();
  frame_count = declaration.frame.size();
  for (std::size_t i = 0; i < std::min(parameter_count, parameters.size()); ++i) {
    parameters[i].parameter = declaration.parameters[i];
    copy_text(declaration.parameters[i].name, parameters[i].name);
    copy_text(declaration.parameters[i].help, parameters[i].help);
  }
  for (std::size_t i = 0; i < std::min(value_count, values.size()); ++i) {
    values[i].value = declaration.internal_values[i];
    copy_text(declaration.internal_values[i].name, values[i].name);
    copy_text(declaration.internal_values[i].help, values[i].help);
  }
  std::copy_n(declaration.frame.begin(), std::min(frame_count, frame.size()), frame.begin());
}

DeclarationCopy::DeclarationCopy(const CapturedDeclaration& captured, const std::string& file) {
  if (!is_user_algorithm(captured.id)) {
    throw InputError(
        file, 0, "algorithm id " + std::to_string(captured.id),
        "an id for users' algorithms, " + std::to_string(first_user_id) + " to " + std::to_string(last_user_id));
  }
  declaration_.id = captured.id;
  declaration_.sources = captured.sources;
  declaration_.name = keep(name_of(captured.name, "the algorithm's name", file));
  declaration_.help = keep(text_of(captured.help, "a help text", file));
  expect_count("parameters", captured.parameter_count, 1, max_parameters, file);
  expect_count("internal values", captured.value_count, 0, max_internal_values, file);
  expect_count("fields of the state frame", captured.frame_count, 0, StateFrame::payload_size, file);
  for (std::size_t i = 0; i < captured.parameter_count; ++i) {
    const CapturedDeclaration::CapturedParameter& from = captured.parameters[i];
    Parameter parameter = from.parameter;
    const std::string name = name_of(from.name, "a parameter's name", file);
    expect_unit(parameter.unit, name, file);
    if (parameter.minimum > parameter.default_value || parameter.default_value > parameter.maximum) {
      throw InputError(file, 0,
                       "parameter " + in_quotes(name) + " with minimum " + std::to_string(parameter.minimum) +
                           ", default " + std::to_string(parameter.default_value) + " and maximum " +
                           std::to_string(parameter.maximum),
                       "ascending numbers");
    }
    parameter.name = keep(name);
    parameter.help = keep(text_of(from.help, "a help text", file));
    parameters_.push_back(parameter);
  }
  for (std::size_t i = 0; i < captured.value_count; ++i) {
    const CapturedDeclaration::CapturedValue& from = captured.values[i];
    InternalValue value = from.value;
    const std::string name = name_of(from.name, "an internal value's name", file);
    expect_unit(value.unit, name, file);
    value.name = keep(name);
    value.help = keep(text_of(from.help, "a help text", file));
    values_.push_back(value);
  }
  std::size_t bytes = 0;
  for (std::size_t i = 0; i < captured.frame_count; ++i) {
    const FrameField& field = captured.frame[i];
    if (field.internal_value >= captured.value_count || field.bytes < 1 || field.bytes > 4) {
      throw InputError(file, 0,
                       "a field of the state frame with " + std::to_string(field.bytes) +
                           " bytes of the internal value number " + std::to_string(field.internal_value),
                       "1 to 4 bytes of one of the " + std::to_string(captured.value_count) + " internal values");
    }
    bytes += field.bytes;
    frame_.push_back(field);
  }
  expect_count("bytes in the state frame", bytes, 0, StateFrame::payload_size, file);
  expect_unique(parameters_, "parameters", file);
  expect_unique(values_, "internal values", file);
  declaration_.parameters = parameters_;
  declaration_.internal_values = values_;
  declaration_.frame = frame_;
}

std::string_view DeclarationCopy::keep(std::string text) {
  texts_.push_back(std::make_unique<const std::string>(std::move(text)));
  return *texts_.back();
}

}  // namespace proleg
