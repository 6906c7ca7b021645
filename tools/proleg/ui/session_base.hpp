#pragma once

// What the sessions behind the page have in common: the way of an operation to its session, the requests that wait for
// the session's thread, that thread, and the arguments of operations.

#include <algorithm>
#include <atomic>
#include <chrono>
#include <concepts>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "host/server/robot_session.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"

namespace proleg::tools {

/// Whether a JSON value is a number that the type has. The library converts 1e99 to an integer, too, to any.
template <std::integral Integer>
bool is_whole_number(const nlohmann::json& value) {
  if (value.is_number_unsigned()) {
    return std::in_range<Integer>(value.get<std::uint64_t>());
  }
  return value.is_number_integer() && std::in_range<Integer>(value.get<std::int64_t>());
}

/// Whether a JSON value can become one of this type without a loss. Types that are no numbers are checked by the
/// library.
template <typename Value>
struct IsExactly {
  static bool check(const nlohmann::json& value) {
    if constexpr (std::integral<Value> && !std::same_as<Value, bool>) {
      return is_whole_number<Value>(value);
    } else {
      return true;
    }
  }
};
template <typename Element>
struct IsExactly<std::vector<Element>> {
  static bool check(const nlohmann::json& value) {
    return std::all_of(value.begin(), value.end(), IsExactly<Element>::check);
  }
};

/// An argument of an operation, or nothing. Throws InputError if it has another type, or is a number that the type does
/// not have. expected: for the message.
template <typename Value>
std::optional<Value> argument(const nlohmann::json& arguments, const char* name, const char* expected) {
  const auto found = arguments.find(name);
  if (found == arguments.end() || found->is_null()) {
    return std::nullopt;
  }
  if (!IsExactly<Value>::check(*found)) {
    throw InputError(name, 0, shortened(found->dump()), expected);
  }
  try {
    return found->get<Value>();
  } catch (const nlohmann::json::exception&) {
    throw InputError(name, 0, shortened(found->dump()), expected);
  }
}

/// The same of an argument that must be there.
template <typename Value>
Value required_argument(const nlohmann::json& arguments, const char* name, const char* expected) {
  std::optional<Value> value = argument<Value>(arguments, name, expected);
  if (!value) {
    throw InputError(name, 0, "nothing", expected);
  }
  return std::move(*value);
}

/// For the documents of sessions: null if the text is empty.
inline nlohmann::json text_or_null(const std::string& text) {
  return text.empty() ? nlohmann::json() : nlohmann::json(text);
}

/// The names of the operation `reset`; nothing: all parameters. Throws InputError.
inline std::optional<std::vector<std::string>> parameter_names(const nlohmann::json& arguments) {
  return argument<std::vector<std::string>>(arguments, "names", "names such as \"1.amplitude:J2\"");
}

/// What carries an operation out. Throws InputError, which names all operations, if there is no such one.
template <typename Handler>
const Handler& handler_of(const std::map<std::string_view, Handler>& handlers, const std::string& operation) {
  const auto handler = handlers.find(operation);
  if (handler != handlers.end()) {
    return handler->second;
  }
  std::vector<std::string> names;
  names.reserve(handlers.size());
  for (const auto& [name, function] : handlers) {
    names.emplace_back(name);
  }
  throw InputError("operation", 0, in_quotes(shortened(operation)), "one of " + listed(names));
}

// How the names of the operations begin that are not for the robot.
inline constexpr std::string_view recording_operations = "recording.";
inline constexpr std::string_view remote_operations = "remote.";
inline constexpr std::string_view algorithm_operations = "algorithm.";
inline constexpr std::string_view draft_operations = "draft.";
// Of a draft, too:
inline constexpr std::string_view world_operations = "world.";
inline constexpr std::string_view draft_robot_operations = "robot.";
inline constexpr std::string_view behaviour_operations = "behaviour.";
inline constexpr std::string_view gallery_operations = "gallery.";
inline constexpr std::string_view mesh_operations = "mesh.";
inline constexpr std::string_view search_operations = "search.";
inline constexpr std::string_view sweep_operations = "sweep.";
inline constexpr std::string_view module_operations = "modules.";

/// The sessions behind one page: a robot, its remote control, recordings, a draft, meshes for it, the list of what can
/// be opened, algorithms, searches, sweeps, and modules on a table. The name of an operation says which of them it is
/// for; STOP and the holder of control go to the robot, then to the modules and the remote control.
class SessionRouter final : public host::RobotSession {
 public:
  /// All must outlive the router.
  SessionRouter(host::RobotSession& recordings, host::RobotSession& draft, host::RobotSession& meshes,
                host::RobotSession& gallery, host::RobotSession& algorithms, host::RobotSession& searches,
                host::RobotSession& sweeps, host::RobotSession& modules, host::RobotSession& remote,
                host::RobotSession& robot)
      : recordings_(recordings),
        draft_(draft),
        meshes_(meshes),
        gallery_(gallery),
        algorithms_(algorithms),
        searches_(searches),
        sweeps_(sweeps),
        modules_(modules),
        remote_(remote),
        robot_(robot) {}

  void operate(const host::OperationRequest& request) override;
  void stop(const host::StopRequest& request) override;
  void holder_changed(bool has_holder, bool is_away) override;

 private:
  host::RobotSession& recordings_;
  host::RobotSession& draft_;
  host::RobotSession& meshes_;
  host::RobotSession& gallery_;
  host::RobotSession& algorithms_;
  host::RobotSession& searches_;
  host::RobotSession& sweeps_;
  host::RobotSession& modules_;
  host::RobotSession& remote_;
  host::RobotSession& robot_;
};

/// Requests of viewers to a session, on their way from the server's thread to that of the session.
class SessionRequests final : public host::RobotSession {
 public:
  using Clock = std::chrono::steady_clock;

  struct Stop {
    host::RequestId request = 0;
    std::string by;
    Clock::time_point since;
  };
  struct Holder {
    bool is_there = false;  ///< a viewer drives
    bool is_away = false;   ///< the page of the viewer that drives does not answer
  };

  // The calls from here on are for any thread.
  void operate(const host::OperationRequest& request) override;
  void stop(const host::StopRequest& request) override;
  void holder_changed(bool has_holder, bool is_away) override;
  /// Requests the end of the session.
  void end();
  /// Whether the session has ended: what it moved is at rest.
  [[nodiscard]] bool have_ended() const { return have_ended_; }

  // The calls from here on are for the session's thread.

  /// All STOPs that wait, at most host::max_pending_stops. If there are any, the operations that wait as well go into
  /// `outdated`: what was asked for before a STOP has no effect after it.
  [[nodiscard]] std::vector<Stop> take_stops(std::deque<host::OperationRequest>& outdated);
  /// Takes the oldest operation; nothing as long as a STOP waits.
  [[nodiscard]] std::optional<host::OperationRequest> take_operation();
  /// Takes the present state of the holder of control.
  [[nodiscard]] Holder take_holder();
  /// Whether the session must interrupt its work: a STOP waits, or the session is to end.
  [[nodiscard]] bool interrupts() const;
  [[nodiscard]] bool ends() const;
  void note_end() { have_ended_ = true; }
  /// Whether a request has not been taken. The call is cheap.
  [[nodiscard]] bool are_there() const { return are_there_; }
  /// Waits until a request has not been taken, or until this time.
  void wait_until(Clock::time_point time);
  void wait();

 private:
  void notify();
  void look();

  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<host::OperationRequest> operations_;
  std::vector<Stop> stops_;
  Holder holder_;
  bool is_holder_new_ = false;
  bool ends_ = false;
  std::atomic<bool> are_there_ = false;
  std::atomic<bool> have_ended_ = false;
};

/// Whether somebody drives. A page that is reloaded may be back within a moment.
class DriverWatch {
 public:
  using Clock = SessionRequests::Clock;
  /// Time without a driver after which what moves must stop.
  static constexpr std::chrono::milliseconds longest_absence{400};

  /// Takes note of the present holder of control. Returns whether what moves must stop.
  bool look(const SessionRequests::Holder& holder, Clock::time_point now) {
    if (holder.is_there) {
      absent_since_.reset();
    } else if (!absent_since_) {
      absent_since_ = now;
    }
    return holder.is_away || (absent_since_ && now > *absent_since_ + longest_absence);
  }
  [[nodiscard]] bool has_driver() const { return !absent_since_; }

 private:
  std::optional<Clock::time_point> absent_since_ = Clock::time_point{};
};

/// A thread that does what viewers ask for, and outlives its errors.
class SessionThread {
 public:
  SessionThread(const SessionThread&) = delete;
  SessionThread& operator=(const SessionThread&) = delete;

 protected:
  using Clock = std::chrono::steady_clock;
  using Stops = std::vector<SessionRequests::Stop>;

  /// requests, output: must outlive this.
  SessionThread(SessionRequests& requests, host::SessionOutput& output) : requests_(requests), output_(output) {}
  virtual ~SessionThread() = default;

  /// The last call of the constructor of a session.
  void begin_thread();
  /// The first call of its destructor.
  void end_thread();

  // The thread calls these functions.

  /// Does what is to be done now, or waits for it: again and again until the session ends.
  virtual void serve() = 0;
  /// serve() has thrown this error, which viewers have been told: nothing moves any more.
  virtual void fail(const std::string& why) = 0;
  /// The session ends.
  virtual void close() {}
  /// Returns the value of the answer, or answered_later(), or throws the refusal.
  [[nodiscard]] virtual nlohmann::json carry_out(const host::OperationRequest& operation) = 0;

  /// The session gives the answer, or the refusal, later by itself.
  [[nodiscard]] static nlohmann::json answered_later() { return nlohmann::json(nlohmann::json::value_t::discarded); }

  /// All STOPs that wait. What was asked for before one of them is refused.
  [[nodiscard]] Stops take_stops();
  /// Carries out all operations that wait, and answers them. Returns whether there were any.
  bool take_operations();

  SessionRequests& requests_;
  host::SessionOutput& output_;

 private:
  void run();
  void report(const std::string& error);

  std::string last_error_;  ///< of serve(); empty if it has thrown none the last time
  std::thread thread_;
};

}  // namespace proleg::tools
