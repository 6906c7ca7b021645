#include "host/flash/module_query.hpp"

#include <algorithm>

#include "shared/fixed/little_endian.hpp"

namespace proleg::host {

using broadcast::Code;

void ModuleQuery::start(Microseconds now, const std::vector<std::uint32_t>& serials) {
  for (const std::uint32_t serial : serials) {
    modules_.push_back({serial, false, {}, std::nullopt});
  }
  next_ = 0;
  if (!is_done()) {
    begin_module(now);
  }
}

void ModuleQuery::begin_module(Microseconds now) {
  bytes_.fill(0);
  missing_.clear();
  longest_answer_ = 0;
  attempt_ = 0;
  ask(now);
}

void ModuleQuery::next_module(Microseconds now) {
  ++next_;
  deadline_ = never;
  waiting_.clear();
  if (!is_done()) {
    begin_module(now);
  }
}

/// Requests the state first; then the words of the header that are missing, some at a time.
void ModuleQuery::ask(Microseconds now) {
  waiting_.clear();
  if (!module().has_answered) {
    waiting_.push_back(broadcast::status_frame(module().serial));
  }
  asked_ = std::min(missing_.size(), max_parallel);
  for (std::size_t i = 0; i < asked_; ++i) {
    waiting_.push_back(broadcast::header_frame(module().serial, missing_[i]));
  }
  ++attempt_;
  asked_at_ = now;
  constexpr Microseconds least_us = 5'000;
  const Microseconds timeout = longest_answer_ == 0 ? options_.answer_timeout_us : least_us + 4 * longest_answer_;
  deadline_ = now + std::min(timeout << (attempt_ - 1), options_.answer_timeout_us);
  send_waiting();
}

void ModuleQuery::send_waiting() {
  while (!waiting_.empty() && port_.send(waiting_.front())) {
    waiting_.pop_front();
  }
}

void ModuleQuery::transmitted(Microseconds /*now*/, const CanFrame& /*frame*/) { send_waiting(); }

void ModuleQuery::receive(Microseconds now, const CanFrame& frame) {
  if (is_done()) {
    return;
  }
  if (const auto word = broadcast::decode_header_word(frame, module().serial)) {
    take_word(now, *word);
    return;
  }
  const auto status = broadcast::decode_status(frame, Code::status, module().serial);
  if (!status || module().has_answered) {
    return;
  }
  module().has_answered = true;
  module().status = *status;
  if (!module().is(broadcast::module_flag::has_image)) {
    next_module(now);
    return;
  }
  longest_answer_ = std::max<Microseconds>(now - asked_at_, 1);
  for (unsigned word = 0; word < first_words; ++word) {
    missing_.push_back(static_cast<std::uint8_t>(word));
  }
  missing_.push_back(last_word);
  attempt_ = 0;
  ask(now);
}

void ModuleQuery::take_word(Microseconds now, const broadcast::HeaderWord& word) {
  const auto found = std::ranges::find(missing_, word.number);
  if (found == missing_.end()) {
    return;  // the word was requested twice
  }
  write_little_endian(bytes_, 4U * word.number, 4, word.value);
  const bool was_asked = found - missing_.begin() < static_cast<std::ptrdiff_t>(asked_);
  missing_.erase(found);
  asked_ -= was_asked ? 1U : 0U;
  if (missing_.empty()) {
    const image::HeaderResult result = image::decode(bytes_);
    if (result.error == image::Error::none) {
      module().image = result.header;
    }
    next_module(now);
  } else if (asked_ == 0) {
    longest_answer_ = std::max(longest_answer_, now - asked_at_);
    attempt_ = 0;
    ask(now);
  }
}

void ModuleQuery::poll(Microseconds now) {
  if (is_done() || now < deadline_) {
    return;
  }
  if (attempt_ < options_.attempts) {
    ask(now);
  } else {
    next_module(now);
  }
}

}  // namespace proleg::host
