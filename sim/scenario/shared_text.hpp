#pragma once

// The text of a file, which a scenario, its copies, a draft and its history have in common: a mesh has megabytes.

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

namespace proleg::sim {

/// A text that does not change. Copies share its memory, also in other threads.
class SharedText {
 public:
  SharedText() = default;
  // NOLINTNEXTLINE(google-explicit-constructor,hicpp-explicit-conversions): it is used as a text.
  SharedText(std::string text) : text_(std::make_shared<const std::string>(std::move(text))) {}
  // NOLINTNEXTLINE(google-explicit-constructor,hicpp-explicit-conversions)
  SharedText(const char* text) : SharedText(std::string(text)) {}

  // NOLINTNEXTLINE(google-explicit-constructor,hicpp-explicit-conversions)
  operator const std::string&() const { return str(); }
  // NOLINTNEXTLINE(google-explicit-constructor,hicpp-explicit-conversions)
  operator std::string_view() const { return str(); }
  [[nodiscard]] const std::string& str() const {
    static const std::string empty;
    return text_ ? *text_ : empty;
  }
  [[nodiscard]] std::size_t size() const { return str().size(); }
  [[nodiscard]] bool operator==(const SharedText& other) const { return text_ == other.text_ || str() == other.str(); }
  [[nodiscard]] bool operator==(const std::string& other) const { return str() == other; }

 private:
  std::shared_ptr<const std::string> text_;
};

}  // namespace proleg::sim
