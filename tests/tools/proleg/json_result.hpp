#pragma once

#include <compare>
#include <concepts>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

namespace proleg::test {

/// What a program printed with --json. What is missing, or is no JSON, fails the test and reads as null. The JSON
/// library, which takes half a minute to compile under sanitizers wherever it is included, is known to the source file
/// only.
class Json {
 public:
  explicit Json(const std::string& text);
  ~Json();
  Json(const Json& other);
  Json(Json&& other) noexcept;
  Json& operator=(const Json& other);
  Json& operator=(Json&& other) noexcept;

  [[nodiscard]] Json operator[](std::string_view key) const;
  [[nodiscard]] Json operator[](std::size_t position) const;
  [[nodiscard]] bool contains(std::string_view key) const;
  /// Members of an object or elements of an array.
  [[nodiscard]] std::size_t size() const;
  [[nodiscard]] bool empty() const { return size() == 0; }
  [[nodiscard]] std::vector<Json> elements() const;
  [[nodiscard]] Json without(std::string_view key) const;

  [[nodiscard]] bool is_null() const;
  [[nodiscard]] bool is_number() const;
  /// Fail the test if it is no number or no text.
  [[nodiscard]] double number() const;
  [[nodiscard]] std::string text() const;

  bool operator==(const Json& other) const;
  bool operator==(std::string_view other) const { return text() == other; }
  template <typename Number>
  requires std::integral<Number> || std::floating_point<Number>
  bool operator==(Number other) const { return number() == static_cast<double>(other); }
  template <typename Number>
  requires std::integral<Number> || std::floating_point<Number> std::partial_ordering operator<=>(Number other) const {
    return number() <=> static_cast<double>(other);
  }

  friend std::ostream& operator<<(std::ostream& out, const Json& value);

 private:
  explicit Json(const nlohmann::json& value);

  std::unique_ptr<nlohmann::json> value_;
};

}  // namespace proleg::test
