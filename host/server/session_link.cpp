#include "host/server/session_link.hpp"

#include <algorithm>
#include <utility>

namespace proleg::host {

void ServerInbox::put_document(const std::string& name, std::string value) {
  const std::lock_guard lock(mutex_);
  // A newer text is put behind the other documents: revisions are in the order of the last changes.
  std::erase_if(contents_.documents, [&name](const auto& document) { return document.first == name; });
  contents_.documents.emplace_back(name, std::move(value));
}

void ServerInbox::put_layout(Layout layout) {
  const std::lock_guard lock(mutex_);
  contents_.layout = std::move(layout);
}

void ServerInbox::put_answer(OperationAnswer answer) {
  const std::lock_guard lock(mutex_);
  contents_.answers.push_back(std::move(answer));
}

void ServerInbox::put_stopped(const StopAnswer& answer) {
  const std::lock_guard lock(mutex_);
  contents_.stops.push_back(answer);
}

void ServerInbox::put_notice(NoticeLevel level, const std::string& text) {
  const std::lock_guard lock(mutex_);
  contents_.notices.push_back({level, text});
  if (contents_.notices.size() > NoticeLog::max_notices) {
    contents_.notices.pop_front();
  }
}

ServerInbox::Contents ServerInbox::take_contents() {
  is_woken_ = false;  // cleared before the contents are taken: later contents wake the server again
  const std::lock_guard lock(mutex_);
  return std::exchange(contents_, {});
}

SessionLink::SessionLink(AccessToken access_token, PageFiles page_files, DocumentFiles document_files,
                         std::size_t history_bytes, ViewerHub::Options options, RobotSession& session)
    : token(std::move(access_token)),
      page(std::move(page_files)),
      documents(std::move(document_files)),
      history(history_bytes),
      hub(std::move(options), token, session, history) {}

void SessionLink::deliver() {
  ServerInbox::Contents contents = inbox.take_contents();
  if (contents.layout) {
    hub.set_layout(std::move(contents.layout->layout), contents.layout->tick_us, contents.layout->generation);
  }
  for (const auto& [name, value] : contents.documents) {
    hub.publish(name, value);
  }
  for (const OperationAnswer& answer : contents.answers) {
    hub.answer(answer);
  }
  for (const StopAnswer& answer : contents.stops) {
    hub.stopped(answer);
  }
  for (const ServerInbox::Notice& notice : contents.notices) {
    hub.notice(notice.level, notice.text);
  }
}

}  // namespace proleg::host
