#pragma once

// JSON that a program prints, and durations as JSON and as text.

#include <concepts>
#include <initializer_list>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace proleg {
class Durations;
}

namespace proleg::tools {

struct JsonMember;

/// A JSON value to be printed; null unless constructed from a value. Only the source file includes the JSON library,
/// whose compilation takes seconds.
class Json {
 public:
  Json();
  ~Json();
  Json(const Json& other);
  Json(Json&& other) noexcept;
  Json& operator=(const Json& other);
  Json& operator=(Json&& other) noexcept;

  /// Infinities and NaN print as null.
  template <std::floating_point Number>
  Json(Number value) : Json(from_number(value)) {}
  template <std::integral Integer>
  requires(!std::same_as<Integer, bool>) Json(Integer value) : Json(from_integer(value)) {}
  template <std::same_as<bool> Boolean>
  Json(Boolean value) : Json(from_boolean(value)) {}
  Json(const char* value) : Json(std::string_view(value)) {}
  Json(const std::string& value) : Json(std::string_view(value)) {}
  Json(std::string_view value);
  Json(const std::vector<double>& values);
  /// An empty optional is null.
  template <typename Value>
  Json(const std::optional<Value>& value) : Json(value ? Json(*value) : Json()) {}
  /// An object whose members keep their order.
  Json(std::initializer_list<JsonMember> members);

  [[nodiscard]] static Json empty_object();
  [[nodiscard]] static Json empty_array();

  /// Adds a member to an object.
  void add(std::string_view key, const Json& value);
  /// Adds an element to an array.
  void append(const Json& value);

  /// Text with one member or element in each line, indented by two blanks for each level. Bytes that are not UTF-8 are
  /// replaced.
  [[nodiscard]] std::string text() const;
  /// Text without line ends, which no program takes for more than one line: all characters are ASCII.
  [[nodiscard]] std::string line() const;

 private:
  [[nodiscard]] static Json from_boolean(bool value);
  [[nodiscard]] static Json from_number(double value);
  template <typename Integer>
  [[nodiscard]] static Json from_integer(Integer value) {
    if constexpr (std::signed_integral<Integer>) {
      return from_signed(value);
    } else {
      return from_unsigned(value);
    }
  }
  [[nodiscard]] static Json from_signed(long long value);
  [[nodiscard]] static Json from_unsigned(unsigned long long value);

  std::unique_ptr<nlohmann::ordered_json> value_;
};

struct JsonMember {
  std::string_view key;
  Json value;
};

/// Text "0.31 ms (median), 99 % within 0.5 ms; 312 ", followed by the name of the counted things. factor: from the unit
/// of the durations to `unit`. "none" without durations.
[[nodiscard]] std::string durations_text(const Durations& durations, double factor, const std::string& unit,
                                         const std::string& counted);

/// Object for --json: count, median, p99; the last two are null without durations.
[[nodiscard]] Json durations_object(const Durations& durations, double factor);

}  // namespace proleg::tools
