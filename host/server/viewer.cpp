#include "host/server/viewer.hpp"

#include <algorithm>
#include <utility>

#include "shared/computer/text/text.hpp"

namespace proleg::host {
namespace {

constexpr ServerTime measurement{250};
constexpr double max_ticks_per_second = 1000;
constexpr std::uint64_t max_unread_rows = 256;
constexpr std::uint32_t max_stride = 1U << 15U;

using nlohmann::json;

constexpr std::size_t max_reason_bytes = 123;  // RFC 6455, 5.5
constexpr std::size_t bytes_result_header = 16;

std::string dumped(const json& value) { return value.dump(-1, ' ', false, json::error_handler_t::replace); }

/// The text of a close frame, cut before a character that does not fit.
std::string cut_reason(const std::string& text) {
  std::size_t size = 0;
  while (size < text.size()) {
    const std::size_t next = std::max<std::size_t>(utf8_character_size(std::string_view(text).substr(size)), 1);
    if (size + next > max_reason_bytes) {
      break;
    }
    size += next;
  }
  return text.substr(0, size);
}

json result_of(std::uint64_t id, bool is_ok, const json& value, const std::string& error) {
  json result{{"type", "result"}, {"id", id}, {"ok", is_ok}};
  if (is_ok) {
    result["value"] = value;
  } else {
    result["error"] = error;
  }
  return result;
}

/// An answer in bytes: 0, where telemetry has the number of a subscription, then the viewer's id, then the bytes.
std::string bytes_result(std::uint64_t id, const json::binary_t& bytes) {
  std::string message;
  message.reserve(bytes_result_header + bytes.size());
  for (unsigned byte = 0; byte < 8; ++byte) {
    message.push_back('\0');
  }
  for (unsigned byte = 0; byte < 8; ++byte) {
    message.push_back(static_cast<char>(id >> (8 * byte) & 0xFFU));
  }
  message.append(bytes.begin(), bytes.end());
  return message;
}

}  // namespace

void TickRate::update(ServerTime now, std::uint64_t rows) {
  if (has_started_ && now < start_ + measurement) {
    return;
  }
  if (has_started_) {
    ticks_per_second_ = 1000.0 * static_cast<double>(rows - start_rows_) / static_cast<double>((now - start_).count());
  }
  has_started_ = true;
  start_ = now;
  start_rows_ = rows;
}

std::uint32_t TickRate::stride(std::uint64_t unread_rows) const {
  // The computer's clock may be slightly faster than the ticks; all ticks of 1 ms must be shown nevertheless.
  const double tolerated = 1.05 * max_ticks_per_second;
  std::uint32_t stride = 1;
  while (stride < max_stride && (ticks_per_second_ / stride > tolerated || unread_rows / stride > max_unread_rows)) {
    stride *= 2;
  }
  return stride;
}

void Viewer::close(std::uint16_t code, const std::string& reason) {
  if (!closing_) {
    closing_ = CloseReason{code, cut_reason(reason)};
  }
}

void Viewer::welcome(const std::string& name, bool is_only_stop, const std::string& program,
                     std::uint64_t next_notice) {
  is_welcome_ = true;
  name_ = name;
  is_only_stop_ = is_only_stop;
  queue_reply(dumped(
      {{"type", "welcome"}, {"protocol", 1}, {"client", client_}, {"program", program}, {"next_notice", next_notice}}));
}

bool Viewer::begin_operation(std::uint64_t id) {
  if (last_operation_ && id <= *last_operation_) {
    close(1008,
          "operation: found id " + std::to_string(id) + ", expected one above " + std::to_string(*last_operation_));
    return false;
  }
  last_operation_ = id;
  if (pending_.size() >= max_pending_operations) {
    queue_reply(dumped(result_of(id, false, nullptr, "too many operations at once")));
    return false;
  }
  pending_.insert(id);
  return true;
}

void Viewer::finish_operation(std::uint64_t id, bool is_ok, const json& value, const std::string& error) {
  if (!is_ok || !value.is_binary()) {
    queue_reply({std::make_shared<const std::string>(dumped(result_of(id, is_ok, value, error))), id});
    return;
  }
  const json::binary_t& bytes = value.get_binary();
  if (waiting_bytes_ > 0 && waiting_bytes_ + bytes.size() > max_waiting_bytes) {
    finish_operation(id, false, nullptr, "too many answers in bytes wait to be sent");
    return;
  }
  waiting_bytes_ += bytes.size();
  queue_reply({std::make_shared<const std::string>(bytes_result(id, bytes)), id, bytes.size(), true});
}

void Viewer::queue_stopped(std::string message) { stopped_ = std::make_shared<const std::string>(std::move(message)); }

void Viewer::queue_notice(NoticeLevel level, const std::string& text) { queue_reply(notice_message(level, text)); }

void Viewer::queue_reply(std::string message) {
  queue_reply(Reply{std::make_shared<const std::string>(std::move(message))});
}

void Viewer::queue_reply(Reply reply) {
  if (replies_.size() >= max_replies) {
    close(1008, "found " + std::to_string(max_replies) + " replies that were not read, expected a viewer that reads");
    return;
  }
  replies_.push_back(std::move(reply));
}

void Viewer::set_subscription(std::optional<Subscription> subscription, const TickHistory& history, bool with_newest) {
  subscription_ = std::move(subscription);
  cursor_ = {};
  cursor_.next = with_newest ? history.newest() : history.end();
}

std::optional<OutgoingMessage> Viewer::next_message(ServerTime now, const SharedState& state) {
  if (!is_welcome()) {
    return std::nullopt;
  }
  if (has_sent_welcome_ && stopped_) {
    return OutgoingMessage{false, std::exchange(stopped_, nullptr)};
  }
  if (!replies_.empty()) {
    const Reply reply = std::move(replies_.front());
    replies_.pop_front();
    has_sent_welcome_ = true;
    if (reply.finished) {
      pending_.erase(*reply.finished);
    }
    waiting_bytes_ -= reply.bytes;
    return OutgoingMessage{reply.is_binary, reply.message};
  }
  if (is_only_stop_) {
    return std::nullopt;
  }
  // Documents and telemetry take turns, so that neither delays the other.
  if (!was_telemetry_) {
    if (auto message = next_telemetry(now, state)) {
      was_telemetry_ = true;
      return message;
    }
  }
  was_telemetry_ = false;
  if (SharedText document = state.documents.next(known_documents_)) {
    return OutgoingMessage{false, std::move(document)};
  }
  if (SharedText notice = state.notices.next(next_notice_)) {
    return OutgoingMessage{false, std::move(notice)};
  }
  return next_telemetry(now, state);
}

std::optional<OutgoingMessage> Viewer::next_telemetry(ServerTime now, const SharedState& state) {
  if (!subscription_ || now < next_telemetry_ || !has_unread_rows(state)) {
    return std::nullopt;
  }
  const std::uint32_t stride = state.rate.stride(state.history.end() - cursor_.next);
  std::optional<std::string> bytes = state.history.encode_rows(*subscription_, stride, cursor_);
  if (bytes || stride > 1) {
    next_telemetry_ = now + telemetry_interval;  // also without a row: the stride may be smaller then
  }
  if (!bytes) {
    return std::nullopt;
  }
  return OutgoingMessage{true, std::make_shared<const std::string>(std::move(*bytes))};
}

bool Viewer::has_unread_rows(const SharedState& state) const { return cursor_.next < state.history.end(); }

void Viewer::advance(ServerTime now) {
  if (!is_welcome_ && now >= hello_deadline_) {
    close(1008, "found no hello within 2 s, expected one as the first message");
  }
}

ServerTime Viewer::deadline(ServerTime now, const SharedState& state) const {
  if (closing_) {
    return no_deadline;
  }
  if (!is_welcome_) {
    return hello_deadline_;
  }
  // If no telemetry message was sent recently, a row is sent as soon as it is there.
  return subscription_ && next_telemetry_ > now && has_unread_rows(state) ? next_telemetry_ : no_deadline;
}

}  // namespace proleg::host
