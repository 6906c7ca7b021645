#include "host/server/shared_messages.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

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

void DocumentStore::publish(const std::string& name, std::string_view value) {
  Document& document = documents_[name];
  document.revision = ++last_revision_;
  std::string message = R"({"type":"document","name":)" + nlohmann::json(name).dump() + R"(,"revision":)" +
                        std::to_string(document.revision) + R"(,"value":)";
  message += value;
  message += '}';
  document.message = std::make_shared<const std::string>(std::move(message));
}

SharedText DocumentStore::next(KnownRevisions& known) const {
  auto oldest = documents_.end();
  for (auto document = documents_.begin(); document != documents_.end(); ++document) {
    const auto found = known.find(document->first);
    const bool is_known = found != known.end() && found->second == document->second.revision;
    if (!is_known && (oldest == documents_.end() || document->second.revision < oldest->second.revision)) {
      oldest = document;
    }
  }
  if (oldest == documents_.end()) {
    return nullptr;
  }
  known[oldest->first] = oldest->second.revision;
  return oldest->second.message;
}

std::string notice_message(NoticeLevel level, const std::string& text, std::optional<std::uint64_t> number) {
  nlohmann::json message{{"type", "notice"}, {"level", text_of(level)}, {"text", text}};
  if (number) {
    message["number"] = *number;
  }
  return message.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

void NoticeLog::add(NoticeLevel level, const std::string& text) {
  notices_.push_back(std::make_shared<const std::string>(notice_message(level, text, next_number())));
  if (notices_.size() > max_notices) {
    notices_.pop_front();
    ++first_;
  }
}

SharedText NoticeLog::next(std::uint64_t& number) const {
  number = std::max(number, first_);
  if (number == next_number()) {
    return nullptr;
  }
  return notices_[static_cast<std::size_t>(number++ - first_)];
}

}  // namespace proleg::host
