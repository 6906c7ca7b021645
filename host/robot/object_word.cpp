#include "host/robot/object_word.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "shared/canopen/messages.hpp"
#include "shared/canopen/object_name.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/fixed/decimal.hpp"
#include "shared/gait/registry.hpp"
#include "shared/kernel/kernel_configuration.hpp"

namespace proleg::host {
namespace {

constexpr const char* expected_object =
    "an index such as 0x6064 or 0x1018:4, a name of 'proleg objects', or a parameter such as amplitude or amplitude:2";

bool has_parameter(const ActuationModule& algorithm, std::string_view name) {
  return find_parameter(algorithm.declaration(), name) >= 0;
}

bool is_parameter_name(std::string_view name) {
  for (std::size_t i = 0; i < algorithm_count(); ++i) {
    if (has_parameter(algorithm_at(i), name)) {
      return true;
    }
  }
  return false;
}

/// The address in an argument; nothing if it does not have the form INDEX[:SUB].
std::optional<canopen::Address> parse_address(std::string_view word) {
  const std::size_t colon = word.find(':');
  std::string_view index = word.substr(0, colon);
  if (index.starts_with("0x") || index.starts_with("0X")) {
    index.remove_prefix(2);
  } else if (index.size() != 4) {
    return std::nullopt;
  }
  const auto number = parse_whole<std::uint16_t>(index, 16);
  const auto sub = colon == std::string_view::npos ? std::optional<std::uint8_t>(0)
                                                   : parse_whole<std::uint8_t>(word.substr(colon + 1));
  return number && sub ? std::optional(canopen::Address{*number, *sub}) : std::nullopt;
}

/// The unit of the object, if the core has it.
std::optional<Unit> unit_of(const canopen::Object& object) {
  for (const Unit unit : {Unit::degree, Unit::hertz, Unit::per_second, Unit::ratio}) {
    const UnitScale known = scale_of(unit);
    if (known.numerator == object.scale.numerator && known.denominator == object.scale.denominator) {
      const bool is_phase =
          unit == Unit::degree && canopen::is_signed(object.type) && object.minimum == canopen::min_value(object.type);
      return is_phase ? Unit::phase_degree : unit;
    }
  }
  return std::nullopt;
}

/// Whether people read the number as a code: identifiers, serial numbers, checksums.
bool is_code(const canopen::Object& object) {
  return !canopen::is_signed(object.type) && canopen::size_of(object.type) == 4 &&
         std::string_view(object.scale.symbol).empty();
}

std::string bytes_text(std::span<const std::uint8_t> bytes) {
  std::string text;
  for (const std::uint8_t byte : bytes) {
    text += (text.empty() ? "" : " ") + hexadecimal(byte, 2).substr(2);
  }
  return text.empty() ? "no bytes" : text;
}

std::uint32_t little_endian(std::span<const std::uint8_t> bytes) {
  std::uint32_t number = 0;
  for (std::size_t i = bytes.size(); i-- > 0;) {
    number = number << 8U | bytes[i];
  }
  return number;
}

std::string physical_text(const canopen::Object& object, std::uint32_t number) {
  if (const auto unit = unit_of(object); unit && canopen::is_signed(object.type)) {
    return std::string(format_decimal(static_cast<std::int32_t>(number), *unit).view());
  }
  const auto value = canopen::is_signed(object.type) ? static_cast<double>(static_cast<std::int32_t>(number))
                                                     : static_cast<double>(number);
  return exact_text(value * object.scale.denominator / object.scale.numerator);
}

/// The number that is sent for a text, without a check of its range.
std::optional<std::int64_t> parse_raw(const canopen::Object& object, std::string_view word) {
  if (word.starts_with("0x") || word.starts_with("0X")) {
    const auto number = parse_whole<std::uint32_t>(word.substr(2), 16);
    if (!number) {
      return std::nullopt;
    }
    // 0xFF is sent for -1 of a type with 8 bits.
    const std::uint32_t bits = canopen::size_of(object.type) * 8U;
    const bool fits = bits >= 32 || *number >> bits == 0;
    const std::uint32_t value = fits ? canopen::extend(object.type, *number) : *number;
    return canopen::is_signed(object.type) ? std::int64_t{static_cast<std::int32_t>(value)} : std::int64_t{value};
  }
  if (object.scale.numerator == object.scale.denominator) {
    return parse_whole<std::int64_t>(word);
  }
  if (const auto unit = unit_of(object)) {
    const DecimalResult result = parse_decimal(word, *unit);
    return result.error == DecimalError::none ? std::optional<std::int64_t>(result.raw) : std::nullopt;
  }
  const auto number = parse_number(word);
  constexpr double largest = 4294967296.0;
  const double raw = number.value_or(0.0) * object.scale.numerator / object.scale.denominator;
  return number && raw >= -largest && raw <= largest ? std::optional(std::int64_t{std::llround(raw)}) : std::nullopt;
}

/// The object with a name. Throws InputError if no object or several have the name.
canopen::Object object_of_name(const std::string& word) {
  constexpr std::size_t max_listed = 5;
  const std::string wanted = lower_case(word);
  std::optional<canopen::Object> of_full_name;
  std::vector<canopen::Object> matches;
  std::vector<std::string> known;
  canopen::for_each_object([&](const canopen::Object& object) {
    if (canopen::value_address(object.address)) {
      return;  // these objects are named by their parameters
    }
    known.emplace_back(canopen::full_name(object.address).view());
    known.emplace_back(canopen::entry_name(object.address).view());
    if (lower_case(known.back()) == wanted) {
      matches.push_back(object);
    }
    if (lower_case(known[known.size() - 2]) == wanted) {
      of_full_name = object;
    }
  });
  if (of_full_name || matches.size() == 1) {
    return of_full_name ? *of_full_name : matches.front();
  }
  if (matches.empty()) {
    const auto hint = most_similar(word, known);
    throw InputError(word, 0, "no object of this name",
                     hint ? "perhaps '" + *hint + "'; else " + expected_object : expected_object);
  }
  std::string list;
  for (std::size_t i = 0; i < std::min(matches.size(), max_listed); ++i) {
    list += (i == 0 ? "" : ", ") + address_text(matches[i].address) + " '" +
            std::string(canopen::full_name(matches[i].address).view()) + "'";
  }
  throw InputError(word, 0, std::to_string(matches.size()) + " objects of this name",
                   "one of them: " + list + (matches.size() > max_listed ? ", ..." : ""));
}

}  // namespace

std::string address_text(canopen::Address address) {
  return hexadecimal(address.index, 4) + (address.sub == 0 ? "" : ":" + std::to_string(address.sub));
}

ObjectWord::ObjectWord(std::string_view word) : text_(word) {
  if (const auto address = parse_address(word)) {
    object_ = canopen::find_object(*address);
    if (!object_) {
      throw InputError(text_, 0, "no object " + address_text(*address), expected_object);
    }
    return;
  }
  const std::size_t colon = word.rfind(':');
  const std::string_view name = word.substr(0, colon);
  if (is_parameter_name(name)) {
    const auto slot =
        colon == std::string_view::npos ? std::optional(1U) : parse_whole<unsigned>(word.substr(colon + 1));
    if (!slot || *slot < 1 || *slot > max_slots) {
      throw InputError(text_, 0, "slot " + in_quotes(word.substr(colon + 1)), "1 to " + std::to_string(max_slots));
    }
    slot_ = static_cast<std::uint8_t>(*slot - 1);
    parameter_ = name;
    return;
  }
  object_ = object_of_name(text_);
}

canopen::Object ObjectWord::object(std::uint8_t algorithm) const {
  if (object_) {
    return *object_;
  }
  const ActuationModule* module = find_algorithm(algorithm);
  if (module == nullptr || !has_parameter(*module, parameter_)) {
    const std::string slot = std::to_string(*slot_ + 1);
    throw InputError(text_, 0,
                     module == nullptr ? "no algorithm in slot " + slot + " of the module"
                                       : std::string(module->declaration().name) + " in slot " + slot,
                     "an algorithm with this parameter: 'proleg drive' configures the modules of a robot");
  }
  const canopen::ValueAddress value{canopen::ValueKind::parameter, algorithm,
                                    static_cast<std::uint8_t>(find_parameter(module->declaration(), parameter_)),
                                    *slot_};
  return canopen::find_object(canopen::address_of(value)).value();
}

std::string value_text(const canopen::Object& object, std::span<const std::uint8_t> bytes) {
  if (object.type == canopen::DataType::visible_string) {
    return one_line(std::string(bytes.begin(), bytes.end()));
  }
  if (canopen::is_long(object.type) || bytes.size() != canopen::size_of(object.type)) {
    return bytes_text(bytes);
  }
  const std::uint32_t number = canopen::extend(object.type, little_endian(bytes));
  if (is_code(object)) {
    return hexadecimal(number) + " (" + std::to_string(number) + ")";
  }
  const std::string symbol = object.scale.symbol;
  return physical_text(object, number) + (symbol.empty() || symbol == "1" ? "" : " " + symbol);
}

std::vector<std::uint8_t> parse_value(const std::string& where, const canopen::Object& object, std::string_view word) {
  if (canopen::is_long(object.type)) {
    return {word.begin(), word.end()};
  }
  const std::string symbol = object.scale.symbol;
  const std::string range = physical_text(object, object.minimum) + " to " + physical_text(object, object.maximum) +
                            (symbol.empty() || symbol == "1" ? "" : " " + symbol);
  const auto number = parse_raw(object, word);
  if (!number) {
    throw InputError(where, 0, in_quotes(word), "a number, " + range);
  }
  const bool fits = canopen::is_signed(object.type) ? *number >= INT32_MIN && *number <= INT32_MAX
                                                    : *number >= 0 && *number <= std::int64_t{UINT32_MAX};
  const auto raw = static_cast<std::uint32_t>(*number);
  if (!fits || canopen::check_range(object, raw) != canopen::AbortCode::none) {
    throw InputError(where, 0, std::string(word), range);
  }
  std::vector<std::uint8_t> bytes;
  for (unsigned i = 0; i < canopen::size_of(object.type); ++i) {
    bytes.push_back(static_cast<std::uint8_t>(raw >> (8 * i)));
  }
  return bytes;
}

std::optional<std::vector<std::uint8_t>> parse_nodes(std::string_view word, const std::string& where) {
  if (word == "all") {
    return std::nullopt;
  }
  const auto refuse = [word, &where] {
    throw InputError(where, 0, in_quotes(word), "node ids from 1 to 126, such as 3, 1,3 or 2-5, or all");
  };
  std::vector<std::uint8_t> nodes;
  for (std::string_view rest = word;;) {
    const std::size_t comma = rest.find(',');
    const std::string_view item = rest.substr(0, comma);
    const std::size_t dash = item.find('-');
    const auto first = parse_whole<unsigned>(item.substr(0, dash));
    const auto last = dash == std::string_view::npos ? first : parse_whole<unsigned>(item.substr(dash + 1));
    if (!first || !last || *first < canopen::min_node_id || *last > canopen::max_node_id || *first > *last) {
      refuse();
    }
    for (unsigned node = *first; node <= *last; ++node) {
      if (std::ranges::find(nodes, node) == nodes.end()) {
        nodes.push_back(static_cast<std::uint8_t>(node));
      }
    }
    if (comma == std::string_view::npos) {
      return nodes;
    }
    rest = rest.substr(comma + 1);
  }
}

}  // namespace proleg::host
