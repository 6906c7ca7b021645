#include "json_result.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace proleg::test {

using nlohmann::json;

Json::Json(const std::string& text) : value_(std::make_unique<json>(json::parse(text, nullptr, false))) {
  if (value_->is_discarded()) {
    ADD_FAILURE() << "not JSON: " << text;
    *value_ = nullptr;
  }
}
Json::Json(const json& value) : value_(std::make_unique<json>(value)) {}
Json::~Json() = default;
Json::Json(const Json& other) : Json(*other.value_) {}
Json::Json(Json&& other) noexcept = default;
Json& Json::operator=(const Json& other) {
  value_ = std::make_unique<json>(*other.value_);
  return *this;
}
Json& Json::operator=(Json&& other) noexcept = default;

Json Json::operator[](std::string_view key) const {
  if (!contains(key)) {
    ADD_FAILURE() << "no member " << key << " in " << *value_;
    return Json(json());
  }
  return Json(value_->at(std::string(key)));
}

Json Json::operator[](std::size_t position) const {
  if (!value_->is_array() || position >= value_->size()) {
    ADD_FAILURE() << "no element " << position << " in " << *value_;
    return Json(json());
  }
  return Json(value_->at(position));
}

bool Json::contains(std::string_view key) const { return value_->contains(std::string(key)); }

std::size_t Json::size() const { return value_->size(); }

std::vector<Json> Json::elements() const {
  std::vector<Json> all;
  for (const json& element : *value_) {
    all.push_back(Json(element));
  }
  return all;
}

Json Json::without(std::string_view key) const {
  if (!contains(key)) {
    ADD_FAILURE() << "no member " << key << " in " << *value_;
    return *this;
  }
  Json rest(*this);
  rest.value_->erase(std::string(key));
  return rest;
}

bool Json::is_null() const { return value_->is_null(); }

bool Json::is_number() const { return value_->is_number(); }

double Json::number() const {
  if (!value_->is_number()) {
    ADD_FAILURE() << "not a number: " << *value_;
    return 0.0;
  }
  return value_->get<double>();
}

std::string Json::text() const {
  if (!value_->is_string()) {
    ADD_FAILURE() << "not a text: " << *value_;
    return {};
  }
  return value_->get<std::string>();
}

bool Json::operator==(const Json& other) const { return *value_ == *other.value_; }

std::ostream& operator<<(std::ostream& out, const Json& value) { return out << *value.value_; }

}  // namespace proleg::test
