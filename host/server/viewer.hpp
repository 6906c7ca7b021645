#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>

#include "host/server/robot_session.hpp"
#include "host/server/shared_messages.hpp"
#include "host/server/telemetry.hpp"

namespace proleg::host {

/// Measures the rate of ticks, and chooses how many of them a viewer receives: at most 1,000 a second.
class TickRate {
 public:
  /// Measures the rate. rows: number of rows that were ever added.
  void update(ServerTime now, std::uint64_t rows);

  /// Ticks from one row to the next for a viewer that has not read this many rows: a power of 2. A viewer that is far
  /// behind receives fewer ticks, so that its delay stays short.
  [[nodiscard]] std::uint32_t stride(std::uint64_t unread_rows) const;

 private:
  bool has_started_ = false;
  ServerTime start_{};  ///< start of the present measurement
  std::uint64_t start_rows_ = 0;
  double ticks_per_second_ = 0;
};

/// The data that all viewers receive.
struct SharedState {
  DocumentStore documents;
  NoticeLog notices;
  TickHistory& history;
  TickRate rate;
};

struct OutgoingMessage {
  bool is_binary = false;
  SharedText bytes;
};

/// A WebSocket's close frame.
struct CloseReason {
  std::uint16_t code = 1008;
  std::string text;  ///< at most 123 bytes
};

/// The output of the server to one viewer. Its memory is bounded: of output that a viewer does not read it keeps only
/// the newest, and it ends the connection of a viewer that sends requests without reading the answers.
class Viewer {
 public:
  static constexpr ServerTime hello_timeout{2'000};
  /// Time from one telemetry message to the next, so that a message contains several fast ticks.
  static constexpr ServerTime telemetry_interval{8};
  static constexpr std::size_t max_pending_operations = 64;
  static constexpr std::size_t max_replies = 256;
  /// Limit of the bytes of binary answers that wait to be sent; a single answer may be larger.
  static constexpr std::size_t max_waiting_bytes = std::size_t{8} << 20U;

  Viewer(ClientId client, ServerTime opened) : client_(client), hello_deadline_(opened + hello_timeout) {}

  [[nodiscard]] ClientId client() const { return client_; }
  [[nodiscard]] const std::string& name() const { return name_; }
  /// Whether the viewer has sent hello with the right token, and is not being closed.
  [[nodiscard]] bool is_welcome() const { return is_welcome_ && !closing_; }
  /// Whether the viewer is a connection for STOP alone, beside the one with which a person looks on or drives.
  [[nodiscard]] bool is_only_stop() const { return is_only_stop_; }
  /// The reason with which the connection has to end. Messages are not sent any more, and received ones are ignored.
  [[nodiscard]] const std::optional<CloseReason>& closing() const { return closing_; }
  /// Ends the connection. The first reason counts.
  void close(std::uint16_t code, const std::string& reason);

  /// next_notice: NoticeLog::next_number().
  void welcome(const std::string& name, bool is_only_stop, const std::string& program, std::uint64_t next_notice);
  /// Counts an operation as pending until finish_operation(). Returns false if it was refused, or the connection ends.
  [[nodiscard]] bool begin_operation(std::uint64_t id);
  /// Sends the result of an operation: bytes as a binary message, any other value as a message `result`.
  void finish_operation(std::uint64_t id, bool is_ok, const nlohmann::json& value, const std::string& error);
  /// Queues a message `stopped`. It replaces one that was not sent yet.
  void queue_stopped(std::string message);
  void queue_notice(NoticeLevel level, const std::string& text);
  /// Sets the subscription. Nothing: the viewer receives no telemetry until the next subscription.
  void set_subscription(std::optional<Subscription> subscription, const TickHistory& history, bool with_newest = false);
  [[nodiscard]] std::uint32_t next_subscription_number() { return ++subscriptions_; }

  /// The next message, if there is one now. To be called when the previous message is being sent.
  [[nodiscard]] std::optional<OutgoingMessage> next_message(ServerTime now, const SharedState& state);

  /// Ends the connection of a viewer that has not sent hello in time.
  void advance(ServerTime now);
  /// The time at which advance() or next_message() must be called, if nothing happens before.
  [[nodiscard]] ServerTime deadline(ServerTime now, const SharedState& state) const;

 private:
  struct Reply {
    SharedText message;
    std::optional<std::uint64_t> finished =
        std::nullopt;       ///< the operation that is not pending any more when this is sent
    std::size_t bytes = 0;  ///< size of a binary answer
    bool is_binary = false;
  };

  void queue_reply(std::string message);
  void queue_reply(Reply reply);
  [[nodiscard]] std::optional<OutgoingMessage> next_telemetry(ServerTime now, const SharedState& state);
  [[nodiscard]] bool has_unread_rows(const SharedState& state) const;

  const ClientId client_;
  const ServerTime hello_deadline_;
  std::string name_;
  bool is_welcome_ = false;
  bool is_only_stop_ = false;
  std::optional<CloseReason> closing_;

  std::optional<std::uint64_t> last_operation_;
  std::set<std::uint64_t> pending_;
  std::deque<Reply> replies_;
  std::size_t waiting_bytes_ = 0;
  SharedText stopped_;
  bool has_sent_welcome_ = false;

  KnownRevisions known_documents_;
  std::uint64_t next_notice_ = 0;

  std::uint32_t subscriptions_ = 0;
  std::optional<Subscription> subscription_;
  HistoryCursor cursor_;
  ServerTime next_telemetry_{};
  bool was_telemetry_ = false;
};

}  // namespace proleg::host
