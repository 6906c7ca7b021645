#include "sim/optimize/experiment/value_reader.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>

#include "shared/computer/text/text.hpp"
#include "sim/optimize/experiment/value_set.hpp"
#include "sim/scenario/settings.hpp"
#include "sim/scenario/values.hpp"

namespace proleg::optimize {
namespace {

using sim::XmlElement;

constexpr std::uint64_t max_values = 1'000'000;

/// Throws InputError for a value outside the parameter's declared range.
void check_range(const Parameter& parameter, const Decimal& value, const XmlElement& place) {
  static_cast<void>(sim::parse_parameter(parameter, value.text(), place.document().name(), place.line()));
}

Decimal parse_decimal_word(std::string_view word, const XmlElement& element) {
  const std::optional<Decimal> number = Decimal::parse(word);
  if (!number) {
    element.refuse(in_quotes(word) + " in " + element.label(), "a decimal number below 10^10 with at most 15 places");
  }
  return *number;
}

/// An element with one word for all joints, or one word for each joint.
class WordPerJoint {
 public:
  WordPerJoint(const XmlElement& element, std::size_t joints) : element_(element) {
    const std::string text = element.text();
    for (const std::string_view word : words(text)) {
      words_.emplace_back(word);
    }
    if (words_.size() != 1 && words_.size() != joints) {
      element.refuse(std::to_string(words_.size()) + " numbers in " + element.label(),
                     joints == 1 ? "one number" : "one number, or " + std::to_string(joints) + ", one for each joint");
    }
  }

  [[nodiscard]] const XmlElement& element() const { return element_; }
  [[nodiscard]] const std::string& word(std::size_t joint) const { return words_[words_.size() == 1 ? 0 : joint]; }
  [[nodiscard]] Decimal number(std::size_t joint) const { return parse_decimal_word(word(joint), element_); }

 private:
  XmlElement element_;
  std::vector<std::string> words_;
};

/// Whether the bounds of a side belong to the values, with GAlib's numbers. Without the tag they belong to them.
class BoundTypes {
 public:
  BoundTypes(const XmlElement& config, std::string_view tag, std::size_t joints) {
    if (const auto element = config.child(tag)) {
      words_.emplace(*element, joints);
    }
  }

  [[nodiscard]] bool inclusive(std::size_t joint) const {
    const std::string word = words_ ? words_->word(joint) : "1";
    if (word != "1" && word != "2") {
      words_->element().refuse(
          in_quotes(word) + " in " + words_->element().label(),
          std::string(word == "0" ? "a bound (0 is none): " : "") + "1 (inclusive) or 2 (exclusive)");
    }
    return word == "1";
  }

 private:
  std::optional<WordPerJoint> words_;
};

class RangeReader {
 public:
  RangeReader(const XmlElement& config, const Parameter& parameter, std::size_t joints)
      : parameter_(&parameter),
        lower_(config.required_child("lowerBounds"), joints),
        upper_(config.required_child("upperBounds"), joints),
        steps_(config.required_child("boundsIncrements"), joints),
        lower_types_(config, "lowerBoundTypes", joints),
        upper_types_(config, "upperBoundTypes", joints) {}

  [[nodiscard]] std::vector<std::int32_t> values(std::size_t joint) const {
    const Decimal min = lower_.number(joint);
    const Decimal max = upper_.number(joint);
    const Decimal step = steps_.number(joint);
    if (step <= Decimal()) {
      steps_.element().refuse("a step of " + step.text() + " in " + steps_.element().label(), "a step above 0");
    }
    if (max < min) {
      upper_.element().refuse("crossed bounds: " + max.text() + " in " + upper_.element().label() + ", " + min.text() +
                                  " in " + lower_.element().label(),
                              "an upper bound that is not below the lower one");
    }
    const DecimalRange range(min, max, step);
    if (range.count() > max_values) {
      steps_.element().refuse("more than " + std::to_string(max_values) + " values from " + min.text() + " to " +
                                  max.text() + " in steps of " + step.text(),
                              "at most " + std::to_string(max_values));
    }
    if (!range.step_fits()) {
      steps_.element().refuse(
          "a step of " + step.text() + " that does not fit from " + min.text() + " to " + max.text(),
          "a step that fits, or an upper bound of " + range.fitting_below().text() + " or " +
              range.fitting_above().text());
    }
    return between(range, lower_types_.inclusive(joint) ? 0 : 1,
                   range.count() - (upper_types_.inclusive(joint) ? 0 : 1));
  }

 private:
  /// The values with the numbers first to end - 1.
  [[nodiscard]] std::vector<std::int32_t> between(const DecimalRange& range, std::uint64_t first,
                                                  std::uint64_t end) const {
    if (first >= end) {
      upper_.element().refuse("no value between the exclusive bounds", "at least one");
    }
    check_range(*parameter_, range[first], lower_.element());
    check_range(*parameter_, range[end - 1], upper_.element());
    std::vector<Decimal> numbers;
    numbers.reserve(end - first);
    for (std::uint64_t n = first; n < end; ++n) {
      numbers.push_back(range[n]);
    }
    return raw_values(numbers, parameter_->unit);
  }

  const Parameter* parameter_;
  WordPerJoint lower_;
  WordPerJoint upper_;
  WordPerJoint steps_;
  BoundTypes lower_types_;
  BoundTypes upper_types_;
};

std::vector<std::int32_t> read_list(const XmlElement& element, const Parameter& parameter) {
  const std::string text = element.text();
  std::vector<Decimal> numbers;
  for (const std::string_view word : words(text)) {
    numbers.push_back(parse_decimal_word(word, element));
    check_range(parameter, numbers.back(), element);
    if (numbers.size() > max_values) {
      element.refuse("more than " + std::to_string(max_values) + " values in " + element.label(),
                     "at most " + std::to_string(max_values));
    }
  }
  if (numbers.empty()) {
    element.refuse("an empty set of values in " + element.label(), "at least one number");
  }
  std::ranges::sort(numbers);
  return raw_values(numbers, parameter.unit);
}

void refuse_tags(const XmlElement& config, std::initializer_list<std::string_view> tags, const std::string& expected) {
  for (const std::string_view tag : tags) {
    if (const auto element = config.child(tag)) {
      element->refuse(element->label() + " with valueSpace " + in_quotes(config.attribute("valueSpace").value_or("1")),
                      expected);
    }
  }
}

}  // namespace

ValuesOfJoint read_values(const XmlElement& config, const Parameter& parameter, std::size_t joints) {
  const bool range = !config.attribute("valueSpace") || read_whole_attribute(config, "valueSpace", 0, 1) == 1;
  if (!range) {
    refuse_tags(config, {"upperBounds", "lowerBounds", "boundsIncrements", "lowerBoundTypes", "upperBoundTypes"},
                "<values>");
    return [list = read_list(config.required_child("values"), parameter)](std::size_t /*joint*/) { return list; };
  }
  refuse_tags(config, {"values"}, "<lowerBounds>, <upperBounds> and <boundsIncrements>");
  return [reader = RangeReader(config, parameter, joints)](std::size_t joint) { return reader.values(joint); };
}

}  // namespace proleg::optimize
