#pragma once

#include <cstddef>

#include "host/server/access_token.hpp"
#include "host/server/page_files.hpp"
#include "host/server/server_inbox.hpp"
#include "host/server/tick_history.hpp"
#include "host/server/viewer_hub.hpp"

namespace proleg::host {

/// Connects the sockets with the session's thread: `history` and `inbox` are for any thread, `hub` and deliver() for
/// that of the sockets.
struct SessionLink {
  SessionLink(AccessToken access_token, PageFiles page_files, std::size_t history_bytes, ViewerHub::Options options,
              RobotSession& session);

  /// Moves the contents of the inbox to the hub.
  void deliver();

  const AccessToken token;
  const PageFiles page;
  TickHistory history;
  ServerInbox inbox;
  ViewerHub hub;
};

}  // namespace proleg::host
