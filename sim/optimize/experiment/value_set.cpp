#include "sim/optimize/experiment/value_set.hpp"

#include <algorithm>
#include <charconv>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_set>

#include "shared/computer/text/text.hpp"
#include "sim/scenario/settings.hpp"
#include "sim/scenario/values.hpp"

namespace proleg::optimize {
namespace {

constexpr int places = 15;
constexpr Decimal::Wide one = 1'000'000'000'000'000;
constexpr Decimal::Wide limit = one * 10'000'000'000;

constexpr bool is_digit(char c) { return c >= '0' && c <= '9'; }

bool skip(std::string_view& text, std::string_view characters) {
  const bool found = !text.empty() && characters.find(text.front()) != std::string_view::npos;
  text.remove_prefix(found ? 1 : 0);
  return found;
}

/// The digits of a number without the point, and the number of digits after it.
struct Digits {
  Decimal::Wide value = 0;
  int after_point_count = 0;
};

/// Reads and removes the digits at the front of the text; nothing if digits are absent or too many.
std::optional<Digits> read_digits(std::string_view& text) {
  Digits digits;
  bool any = false;
  bool after_point = false;
  for (; !text.empty(); text.remove_prefix(1)) {
    const char c = text.front();
    if (c == '.' && !after_point) {
      after_point = true;
      continue;
    }
    if (!is_digit(c)) {
      break;
    }
    any = true;
    // A Decimal has fewer digits. Further digits could only be zeros at the end.
    if (digits.value > limit * 10'000'000'000 || digits.after_point_count > 4 * places) {
      return std::nullopt;
    }
    digits.value = digits.value * 10 + (c - '0');
    digits.after_point_count += after_point ? 1 : 0;
  }
  return any ? std::optional(digits) : std::nullopt;
}

/// Reads and removes an "e" and the exponent after it at the front of the text; 0 without them.
std::optional<int> read_exponent(std::string_view& text) {
  if (!skip(text, "eE")) {
    return 0;
  }
  const bool negative = skip(text, "-");
  if (!negative) {
    skip(text, "+");
  }
  int exponent = 0;
  constexpr int max_exponent = 60;
  const std::size_t length = static_cast<std::size_t>(std::ranges::find_if_not(text, is_digit) - text.begin());
  const auto [end, error] = std::from_chars(text.data(), text.data() + length, exponent);
  if (error != std::errc{} || exponent > max_exponent) {
    return std::nullopt;
  }
  text.remove_prefix(length);
  return negative ? -exponent : exponent;
}

/// value * 10^power if that is a whole number within the limits.
std::optional<Decimal::Wide> shifted(Decimal::Wide value, int power) {
  if (value == 0) {
    return value;
  }
  for (; power < 0; ++power) {
    if (value % 10 != 0) {
      return std::nullopt;
    }
    value /= 10;
  }
  for (; power > 0 && value < limit; --power) {
    value *= 10;
  }
  return power == 0 && value < limit ? std::optional(value) : std::nullopt;
}

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

std::optional<Decimal> Decimal::parse(std::string_view text) {
  const bool negative = skip(text, "-");
  if (!negative) {
    skip(text, "+");
  }
  const std::optional<Digits> digits = read_digits(text);
  const std::optional<int> exponent = digits ? read_exponent(text) : std::nullopt;
  if (!exponent || !text.empty()) {
    return std::nullopt;
  }
  const std::optional<Wide> quanta = shifted(digits->value, places - digits->after_point_count + *exponent);
  return quanta ? std::optional(Decimal(negative ? -*quanta : *quanta)) : std::nullopt;
}

std::string Decimal::text() const {
  const Wide magnitude = quanta_ < 0 ? -quanta_ : quanta_;
  // The 1 in front keeps the zeros after the point.
  std::string fraction = std::to_string(static_cast<std::uint64_t>(one + magnitude % one)).substr(1);
  fraction.erase(fraction.find_last_not_of('0') + 1);
  return (quanta_ < 0 ? "-" : "") + std::to_string(static_cast<std::uint64_t>(magnitude / one)) +
         (fraction.empty() ? "" : "." + fraction);
}

std::int32_t Decimal::raw(Unit unit) const {
  // 10^25 quanta by 2^29 are below 2^113.
  const UnitScale scale = scale_of(unit);
  const Wide numerator = (quanta_ < 0 ? -quanta_ : quanta_) * scale.numerator;
  const Wide denominator = one * scale.denominator;
  Wide quotient = numerator / denominator;
  const Wide twice_rest = (numerator - quotient * denominator) * 2;
  if (twice_rest > denominator || (twice_rest == denominator && quotient % 2 != 0)) {
    ++quotient;
  }
  const auto magnitude = static_cast<std::uint32_t>(static_cast<std::uint64_t>(quotient));
  return static_cast<std::int32_t>(quanta_ < 0 ? 0U - magnitude : magnitude);
}

DecimalRange::DecimalRange(Decimal min, Decimal max, Decimal step)
    : min_(min), max_(max), step_(step), steps_((max.quanta() - min.quanta() + step.quanta() / 2) / step.quanta()) {}

bool DecimalRange::step_fits() const {
  const Decimal::Wide length = max_.quanta() - min_.quanta();
  const Decimal::Wide rest = length - steps_ * step_.quanta();
  constexpr Decimal::Wide tolerance = 1'000'000'000;
  return (rest < 0 ? -rest : rest) * tolerance <= length;
}

std::uint64_t DecimalRange::count() const {
  constexpr std::uint64_t max_count = std::numeric_limits<std::uint64_t>::max();
  return steps_ >= Decimal::Wide{max_count} ? max_count : static_cast<std::uint64_t>(steps_) + 1;
}

Decimal DecimalRange::operator[](std::uint64_t n) const {
  // The last value is exactly the upper end, even if the step fits only nearly.
  return Decimal::Wide{n} == steps_ ? max_ : Decimal(min_.quanta() + Decimal::Wide{n} * step_.quanta());
}

Decimal DecimalRange::fitting_below() const {
  const Decimal::Wide whole = (max_.quanta() - min_.quanta()) / step_.quanta();
  return Decimal(min_.quanta() + whole * step_.quanta());
}

Decimal DecimalRange::fitting_above() const { return Decimal(fitting_below().quanta() + step_.quanta()); }

std::vector<std::int32_t> raw_values(const std::vector<Decimal>& numbers, Unit unit) {
  std::vector<std::int32_t> values;
  values.reserve(numbers.size());
  // Raw values ascend with the numbers, so equal ones follow each other, except with a unit that wraps.
  std::unordered_set<std::int32_t> seen;
  for (const Decimal& number : numbers) {
    const std::int32_t value = number.raw(unit);
    const bool known = wraps(unit) ? !seen.insert(value).second : !values.empty() && values.back() == value;
    if (!known) {
      values.push_back(value);
    }
  }
  return values;
}

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
