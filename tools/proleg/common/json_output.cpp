#include "tools/proleg/common/json_output.hpp"

#include <nlohmann/json.hpp>

#include "shared/computer/durations/durations.hpp"
#include "shared/computer/text/text.hpp"

namespace proleg::tools {
namespace {

using nlohmann::ordered_json;

constexpr unsigned slow = 99;  // per cent

std::optional<double> scaled(const std::optional<std::uint64_t>& duration, double factor) {
  return duration ? std::optional(static_cast<double>(*duration) * factor) : std::nullopt;
}

}  // namespace

Json::Json() : value_(std::make_unique<ordered_json>()) {}
Json::~Json() = default;
Json::Json(const Json& other) : value_(std::make_unique<ordered_json>(*other.value_)) {}
Json::Json(Json&& other) noexcept = default;
Json& Json::operator=(const Json& other) {
  value_ = std::make_unique<ordered_json>(*other.value_);
  return *this;
}
Json& Json::operator=(Json&& other) noexcept = default;

Json::Json(std::string_view value) : value_(std::make_unique<ordered_json>(value)) {}

Json::Json(const std::vector<double>& values) : value_(std::make_unique<ordered_json>(values)) {}

Json::Json(std::initializer_list<JsonMember> members) : Json(empty_object()) {
  for (const JsonMember& member : members) {
    add(member.key, member.value);
  }
}

Json Json::empty_object() {
  Json result;
  *result.value_ = ordered_json::object();
  return result;
}

Json Json::empty_array() {
  Json result;
  *result.value_ = ordered_json::array();
  return result;
}

Json Json::from_boolean(bool value) {
  Json result;
  *result.value_ = value;
  return result;
}

Json Json::from_number(double value) {
  Json result;
  *result.value_ = value;
  return result;
}

Json Json::from_signed(long long value) {
  Json result;
  *result.value_ = value;
  return result;
}

Json Json::from_unsigned(unsigned long long value) {
  Json result;
  *result.value_ = value;
  return result;
}

void Json::add(std::string_view key, const Json& value) { (*value_)[std::string(key)] = *value.value_; }

void Json::append(const Json& value) { value_->push_back(*value.value_); }

std::string Json::text() const { return value_->dump(2, ' ', false, ordered_json::error_handler_t::replace); }

std::string Json::line() const { return value_->dump(-1, ' ', true, ordered_json::error_handler_t::replace); }

std::string durations_text(const Durations& durations, double factor, const std::string& unit,
                           const std::string& counted) {
  if (durations.count() == 0) {
    return "none";
  }
  return number_text(*scaled(durations.median(), factor)) + " " + unit + " (median), 99 % within " +
         number_text(*scaled(durations.percentile(slow), factor)) + " " + unit + "; " +
         std::to_string(durations.count()) + " " + counted;
}

Json durations_object(const Durations& durations, double factor) {
  return {{"count", durations.count()},
          {"median", scaled(durations.median(), factor)},
          {"p99", scaled(durations.percentile(slow), factor)}};
}

}  // namespace proleg::tools
