#include "host/remote/parameter_changes.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <vector>

namespace proleg::host {
namespace {

/// Number of the first gesture of a remote control; gestures of pages have smaller numbers.
constexpr std::uint64_t first_gesture = std::uint64_t{1} << 40U;

/// The setting in the form of --set, which takes decimal text without an exponent.
std::string set_argument(const std::string& parameter, double value) {
  std::array<char, 400> text{};
  std::snprintf(text.data(), text.size(), "%.9f", value);
  std::string number = text.data();
  number.erase(number.find_last_not_of('0') + 1);
  if (number.back() == '.') {
    number.pop_back();
  }
  return parameter + '=' + (number == "-0" ? "0" : number);
}

}  // namespace

void ParameterChanges::want(RemoteTime now, const ParameterMotion::Value& value) {
  if (!wanted_at_ || now - *wanted_at_ >= gesture_pause) {
    gesture_ = std::max(gesture_ + 1, first_gesture);
  }
  wanted_at_ = now;
  pending_[value.parameter] = value.value;
}

RemoteTime ParameterChanges::next_set() const {
  const RemoteTime paced = sent_at_ ? *sent_at_ + shortest_period : RemoteTime::min();
  return sent_unanswered_ ? std::max(paced, *sent_unanswered_ + answer_timeout) : paced;
}

std::optional<RemoteTime> ParameterChanges::due() const {
  return pending_.empty() ? std::nullopt : std::optional(next_set());
}

void ParameterChanges::advance(RemoteTime now) {
  if (pending_.empty() || now < next_set()) {
    return;
  }
  std::vector<std::string> words;
  words.reserve(pending_.size());
  for (const auto& [parameter, value] : pending_) {
    words.push_back(set_argument(parameter, value));
  }
  pending_.clear();
  sent_at_ = sent_unanswered_ = now;
  target_.set(words, gesture_);
}

}  // namespace proleg::host
