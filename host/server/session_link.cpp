#include "host/server/session_link.hpp"

#include <utility>

namespace proleg::host {

SessionLink::SessionLink(AccessToken access_token, PageFiles page_files, std::size_t history_bytes,
                         ViewerHub::Options options, RobotSession& session)
    : token(std::move(access_token)),
      page(std::move(page_files)),
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
