#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "host/server/client_message.hpp"
#include "host/server/control_lease.hpp"
#include "host/server/request_policy.hpp"
#include "host/server/robot_session.hpp"
#include "host/server/telemetry.hpp"
#include "host/server/viewer.hpp"

namespace proleg::host {

/// The answer of a session to an operation.
struct OperationAnswer {
  RequestId request = 0;
  bool is_ok = false;
  nlohmann::json value;
  std::string error;
};

/// The answer of a session to STOP.
struct StopAnswer {
  RequestId request = 0;
  unsigned confirmed = 0;  ///< number of modules that confirmed
  unsigned of = 0;         ///< number of all modules
  double ms = 0;           ///< duration from the request to the last confirmation
};

/// Which viewers have control from the start, if their hello asks for it.
enum class NewViewers {
  none,
  alone,  ///< one that connects alone
  any,    ///< one that finds control free, or its holder away
};

/// The viewers of a session, and their lease: the part of the server above its sockets. It is used by one thread, and
/// the time is an argument.
class ViewerHub {
 public:
  struct Options {
    std::string program;                    ///< name and version, for the welcome
    std::set<std::string> free_operations;  ///< operations that need no control
    NewViewers gives_control = NewViewers::none;
  };

  ViewerHub(Options options, const AccessToken& token, RobotSession& session, TickHistory& history);

  // The functions below are for the sockets.
  [[nodiscard]] ClientId add_viewer(ServerTime now);
  void receive(ServerTime now, ClientId client, std::string_view text);
  void close(ClientId client, std::uint16_t code, const std::string& reason);
  void remove_viewer(ServerTime now, ClientId client);
  [[nodiscard]] std::size_t viewers() const { return viewers_.size(); }
  [[nodiscard]] std::optional<OutgoingMessage> next_message(ServerTime now, ClientId client);
  /// The reason with which a viewer's connection has to end (Viewer::closing()).
  [[nodiscard]] std::optional<CloseReason> closing(ClientId client) const;
  /// Stops the robot on a request that did not come from a viewer. The caller has checked the token. answered: called
  /// when the session has answered.
  void stop(const std::string& by, std::function<void(const StopAnswer&)> answered = {});

  // The functions below are for the session.
  void publish(const std::string& name, std::string_view value) { state_.documents.publish(name, value); }
  /// Sets the layout of the rows of this generation of the history.
  void set_layout(SignalLayout layout, std::uint32_t tick_us, std::uint64_t generation);
  void answer(const OperationAnswer& answer);
  void stopped(const StopAnswer& answer);
  void notice(NoticeLevel level, const std::string& text) { state_.notices.add(level, text); }

  void advance(ServerTime now);
  /// The time at which advance() or next_message() must be called, if nothing happens before.
  [[nodiscard]] ServerTime deadline(ServerTime now) const;

 private:
  struct PendingOperation {
    ClientId client = 0;
    std::uint64_t id = 0;
  };

  void handle(ServerTime now, Viewer& viewer, const Hello& hello);
  void handle(ServerTime now, Viewer& viewer, const Operation& operation);
  void handle(ServerTime now, Viewer& viewer, const Stop& stop);
  void handle(ServerTime now, Viewer& viewer, const Beat& beat);
  void handle(ServerTime now, Viewer& viewer, const Subscribe& subscribe);
  void control(ServerTime now, Viewer& viewer, const Operation& operation);
  /// Whether no other viewer is connected, except those for STOP alone.
  [[nodiscard]] bool is_alone(ClientId client) const;
  /// Reports changes after each call of the lease: results to viewers, the document, and the holder to the session.
  void report_lease(ServerTime now);
  [[nodiscard]] Viewer* find(ClientId client);

  const Options options_;
  const AccessToken& token_;
  RobotSession& session_;
  SharedState state_;
  ControlLease lease_;
  std::uint64_t published_lease_ = 0;
  bool had_holder_ = false;
  bool was_away_ = false;

  SignalLayout layout_;
  std::uint64_t generation_ = 0;

  ClientId last_client_ = 0;
  std::map<ClientId, Viewer> viewers_;
  RequestId last_request_ = 0;
  std::map<RequestId, PendingOperation> operations_;
  std::map<RequestId, ClientId> stops_;
  std::map<RequestId, std::function<void(const StopAnswer&)>> other_stops_;  ///< of requests that no viewer made
};

}  // namespace proleg::host
