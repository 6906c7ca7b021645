#include "sim/data_file/module_frames.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <string_view>
#include <utility>

#include "shared/computer/text/text.hpp"

namespace proleg::sim {
namespace {

using Item = MarkupScanner::Item;
using Kind = MarkupScanner::Kind;

// Bounds of the memory that a header can require.
constexpr std::size_t max_modules = 64;
constexpr std::size_t max_types = 64;
constexpr std::size_t max_parts = 4096;

/// Whether a declared type is an attribute of the frame.
bool is_stamp(std::string_view type) { return type == "realtime" || type == "simtime" || type == "stepcount"; }

std::string label(const Item& item) {
  switch (item.kind) {
    case Kind::start:
      return "<" + shortened(item.text) + ">";
    case Kind::end:
      return "</" + shortened(item.text) + ">";
    case Kind::text:
      return in_quotes(item.text);
    case Kind::end_of_file:
    case Kind::cut:
      break;
  }
  return "the end of the file";
}

void expect(const MarkupScanner& scanner, const Item& item, Kind kind, std::string_view text,
            const std::string& expected) {
  if (item.kind != kind || (!text.empty() && item.text != text)) {
    scanner.refuse(item.line, label(item), expected);
  }
}

/// The value of an attribute; empty if the tag has no such attribute.
std::string value_of(const Item& tag, std::string_view name) {
  const auto attribute = std::ranges::find(tag.attributes, name, &MarkupScanner::Attribute::name);
  return attribute == tag.attributes.end() ? std::string() : attribute->value;
}

void allow_attributes(const MarkupScanner& scanner, const Item& tag, std::initializer_list<std::string> names) {
  for (const MarkupScanner::Attribute& attribute : tag.attributes) {
    if (std::ranges::find(names, attribute.name) == names.end()) {
      scanner.refuse(tag.line, "the attribute " + in_quotes(attribute.name) + " in " + label(tag),
                     names.size() == 0 ? "no attribute" : listed(std::vector<std::string>(names)));
    }
  }
}

std::vector<std::string> names_of(std::string_view text) {
  const std::vector<std::string_view> found = words(text);
  return {found.begin(), found.end()};
}

/// Parses a number as a program in C++ writes it, also inf and nan.
std::optional<double> parse_value(std::string_view word) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc{} && end == word.data() + word.size() ? std::optional(value) : std::nullopt;
}

double stamp(const MarkupScanner& scanner, const Item& frame, std::string_view name) {
  const std::string text = value_of(frame, name);
  const std::optional<double> value = parse_value(text);
  if (!value || !std::isfinite(*value)) {
    scanner.refuse(frame.line, std::string(name) + "=" + in_quotes(text) + " in <frame>",
                   "index, realtime and simtime: the number of the frame, and milliseconds");
  }
  return *value;
}

DataModule read_module(MarkupScanner& scanner, const Item& start) {
  allow_attributes(scanner, start, {"parts", "types", "names", "jointnames"});
  DataModule module;
  module.name = start.text;
  const std::string parts = value_of(start, "parts");
  const std::optional<std::size_t> count = parse_whole<std::size_t>(parts);
  if (!count || *count < 1 || *count > max_parts) {
    scanner.refuse(start.line, "parts=" + in_quotes(parts) + " in " + label(start),
                   "1 to " + std::to_string(max_parts) + " parts");
  }
  module.parts = *count;
  module.part_names = names_of(value_of(start, "names"));
  module.joint_names = names_of(value_of(start, "jointnames"));
  expect(scanner, scanner.next(), Kind::start, "typenames", "<typenames>");
  const Item& types = scanner.next();
  expect(scanner, types, Kind::text, {}, "the names of the types");
  for (std::string& type : names_of(types.text)) {
    if (std::ranges::find(module.types, type) != module.types.end()) {
      scanner.refuse(types.line, "the type " + in_quotes(type) + " twice", "each type once");
    }
    if (!is_stamp(type)) {
      module.types.push_back(std::move(type));
    }
  }
  if (module.types.size() > max_types) {
    scanner.refuse(types.line, std::to_string(module.types.size()) + " types",
                   "at most " + std::to_string(max_types) + " types");
  }
  expect(scanner, scanner.next(), Kind::end, "typenames", "</typenames>");
  expect(scanner, scanner.next(), Kind::end, module.name, "</" + module.name + ">");
  return module;
}

}  // namespace

std::vector<DataModule> read_data_header(MarkupScanner& scanner) {
  expect(scanner, scanner.next(), Kind::start, "dataroot", "<dataroot>, as a data file begins");
  expect(scanner, scanner.next(), Kind::start, "header", "<header>");
  std::vector<DataModule> modules;
  while (true) {
    const Item& item = scanner.next();
    if (item.kind == Kind::end) {
      return modules;
    }
    expect(scanner, item, Kind::start, {}, "a module or </header>");
    if (std::ranges::find(modules, item.text, &DataModule::name) != modules.end()) {
      scanner.refuse(item.line, label(item) + " twice in the header", "each module once");
    }
    if (modules.size() == max_modules) {
      scanner.refuse(item.line, "more than " + std::to_string(max_modules) + " modules", "</header>");
    }
    const Item start = item;
    modules.push_back(read_module(scanner, start));
  }
}

ModuleFrames::ModuleFrames(MarkupScanner scanner, const std::vector<DataModule>& modules, std::size_t own)
    : scanner_(std::move(scanner)), modules_(modules), own_(own) {}

std::string ModuleFrames::expected_here() const {
  switch (place_) {
    case Place::file:
      return "<round> or </dataroot>";
    case Place::round:
      return "a module of the header or </round>";
    case Place::module:
      return "<frame> or </" + modules_[own_].name + ">";
    case Place::after:
      break;
  }
  return "nothing behind </dataroot>";
}

bool ModuleFrames::next() {
  while (true) {
    const Item& item = scanner_.next();
    if (item.kind == Kind::cut) {
      cut_line_ = item.line;
      return false;
    }
    if (item.kind == Kind::end_of_file) {
      return false;
    }
    if (item.kind == Kind::end) {
      leave();
    } else if (item.kind == Kind::start && place_ == Place::module && item.text == "frame") {
      const Item start = item;
      return read_frame(start);
    } else if (item.kind == Kind::start) {
      enter(item);
    } else {
      scanner_.refuse(item.line, label(item), expected_here());
    }
  }
}

void ModuleFrames::enter(const Item& tag) {
  if (place_ == Place::file && tag.text == "round") {
    allow_attributes(scanner_, tag, {"number"});
    place_ = Place::round;
    return;
  }
  const auto module =
      place_ == Place::round ? std::ranges::find(modules_, tag.text, &DataModule::name) : modules_.end();
  if (module == modules_.end()) {
    scanner_.refuse(tag.line, label(tag), expected_here());
  }
  allow_attributes(scanner_, tag, {});
  if (module == modules_.begin() + static_cast<std::ptrdiff_t>(own_)) {
    place_ = Place::module;
  } else {
    scanner_.skip_element();
  }
}

void ModuleFrames::leave() {
  place_ = place_ == Place::module ? Place::round : place_ == Place::round ? Place::file : Place::after;
}

bool ModuleFrames::read_frame(const Item& start) {
  allow_attributes(scanner_, start, {"index", "realtime", "simtime"});
  DataFrame frame;
  frame.index = value_of(start, "index");
  if (!parse_whole<std::uint64_t>(frame.index)) {
    scanner_.refuse(start.line, "index=" + in_quotes(frame.index) + " in <frame>", "the number of the frame");
  }
  frame.realtime_ms = stamp(scanner_, start, "realtime");
  frame.simtime_ms = stamp(scanner_, start, "simtime");
  if (has_frame_ && frame.simtime_ms <= frame_.simtime_ms) {
    scanner_.refuse(start.line, "simtime " + number_text(frame.simtime_ms) + " after " + number_text(frame_.simtime_ms),
                    "frames of a module in the order of time");
  }
  const std::vector<std::string>& types = modules_[own_].types;
  std::vector<std::vector<double>> numbers(types.size());
  while (true) {
    const Item& item = scanner_.next();
    if (item.kind == Kind::cut) {
      cut_line_ = item.line;
      return false;
    }
    if (item.kind == Kind::end) {
      break;
    }
    const auto type = item.kind == Kind::start ? std::ranges::find(types, item.text) : types.end();
    if (type == types.end()) {
      scanner_.refuse(item.line, label(item) + " in <frame>", types.empty() ? "</frame>" : "types: " + listed(types));
    }
    const auto number = static_cast<std::size_t>(type - types.begin());
    if (!numbers[number].empty()) {
      scanner_.refuse(item.line, label(item) + " twice in a frame", "each type once");
    }
    if (!read_numbers(number, numbers[number])) {
      return false;
    }
  }
  take(numbers, start.line);
  frame.values = std::move(frame_.values);
  frame_ = std::move(frame);
  has_frame_ = true;
  return true;
}

bool ModuleFrames::read_numbers(std::size_t type, std::vector<double>& numbers) {
  const Item& item = scanner_.next();
  if (item.kind == Kind::cut) {
    cut_line_ = item.line;
    return false;
  }
  expect(scanner_, item, Kind::text, {}, "the numbers of <" + modules_[own_].types[type] + ">");
  for (const std::string_view word : words(item.text)) {
    const std::optional<double> value = parse_value(word);
    if (!value) {
      scanner_.refuse(item.line, in_quotes(word) + " in <" + modules_[own_].types[type] + ">", "a number");
    }
    numbers.push_back(*value);
  }
  const std::size_t min = counts_.empty() ? 1 : counts_[type];
  const std::size_t max = counts_.empty() ? modules_[own_].parts : counts_[type];
  if (numbers.size() < min || numbers.size() > max) {
    scanner_.refuse(item.line, std::to_string(numbers.size()) + " numbers in <" + modules_[own_].types[type] + ">",
                    counts_.empty() ? "1 to " + std::to_string(max) + ", the parts of " + modules_[own_].name
                                    : std::to_string(max) + ", as in the frames before");
  }
  const Item& end = scanner_.next();
  if (end.kind == Kind::cut) {
    cut_line_ = end.line;
    return false;
  }
  expect(scanner_, end, Kind::end, {}, "</" + modules_[own_].types[type] + ">");
  return true;
}

void ModuleFrames::take(std::vector<std::vector<double>>& numbers, int line) {
  frame_.values.clear();
  for (std::size_t type = 0; type < numbers.size(); ++type) {
    if (numbers[type].empty()) {
      scanner_.refuse(line, "a frame without <" + modules_[own_].types[type] + ">", "every type of the header");
    }
    frame_.values.insert(frame_.values.end(), numbers[type].begin(), numbers[type].end());
  }
  if (counts_.empty()) {
    for (const std::vector<double>& of_type : numbers) {
      counts_.push_back(of_type.size());
    }
  }
}

}  // namespace proleg::sim
