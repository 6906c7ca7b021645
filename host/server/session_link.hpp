#pragma once

// The way of a session to the sockets: its output on the way to their thread, and what this thread does with it.

#include <atomic>
#include <cstddef>
#include <deque>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host/server/page_files.hpp"
#include "host/server/request_policy.hpp"
#include "host/server/shared_messages.hpp"
#include "host/server/telemetry.hpp"
#include "host/server/viewer_hub.hpp"

namespace proleg::host {

/// The output of the session since the server has last read it. The session may be faster than the server: only the
/// newest text of each document and the last notices are kept. All functions may be called from any thread.
class ServerInbox {
 public:
  struct Layout {
    SignalLayout layout;
    std::uint32_t tick_us = 0;
    std::uint64_t generation = 0;
  };
  struct Notice {
    NoticeLevel level = NoticeLevel::info;
    std::string text;
  };
  struct Contents {
    std::vector<std::pair<std::string, std::string>> documents;  ///< name and JSON of each document
    std::optional<Layout> layout;
    std::vector<OperationAnswer> answers;
    std::vector<StopAnswer> stops;
    std::deque<Notice> notices;
  };

  void put_document(const std::string& name, std::string value);
  void put_layout(Layout layout);
  void put_answer(OperationAnswer answer);
  void put_stopped(const StopAnswer& answer);
  void put_notice(NoticeLevel level, const std::string& text);

  /// Returns true for the first call since take_contents(): the server must be woken.
  [[nodiscard]] bool claim_wake() { return !is_woken_.exchange(true); }
  [[nodiscard]] Contents take_contents();

 private:
  std::atomic<bool> is_woken_ = false;
  std::mutex mutex_;
  Contents contents_;
};

/// Connects the sockets with the session's thread: `history` and `inbox` are for any thread, `hub` and deliver() for
/// that of the sockets.
struct SessionLink {
  SessionLink(AccessToken access_token, PageFiles page_files, DocumentFiles document_files, std::size_t history_bytes,
              ViewerHub::Options options, RobotSession& session);

  /// Moves the contents of the inbox to the hub.
  void deliver();

  const AccessToken token;
  const PageFiles page;
  const DocumentFiles documents;
  TickHistory history;
  ServerInbox inbox;
  ViewerHub hub;
};

}  // namespace proleg::host
