#include "host/server/notice_log.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace proleg::host {
namespace {

const char* text_of(NoticeLevel level) {
  switch (level) {
    case NoticeLevel::info:
      return "info";
    case NoticeLevel::warning:
      return "warning";
    case NoticeLevel::error:
      return "error";
  }
  return "";
}

}  // namespace

std::string notice_message(NoticeLevel level, const std::string& text) {
  const nlohmann::json message{{"type", "notice"}, {"level", text_of(level)}, {"text", text}};
  return message.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

void NoticeLog::add(NoticeLevel level, const std::string& text) {
  notices_.push_back(std::make_shared<const std::string>(notice_message(level, text)));
  if (notices_.size() > max_notices) {
    notices_.pop_front();
    ++first_;
  }
}

SharedText NoticeLog::next(std::uint64_t& number) const {
  number = std::max(number, first_);
  if (number == first_ + notices_.size()) {
    return nullptr;
  }
  return notices_[static_cast<std::size_t>(number++ - first_)];
}

}  // namespace proleg::host
