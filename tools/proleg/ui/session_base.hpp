#pragma once

// What the sessions behind the page have in common: the arguments of operations, a thread that carries operations out,
// and the tasks of a thread that waits for descriptors.

#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "host/server/robot_session.hpp"
#include "host/transport/descriptor.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"

namespace proleg::tools {

/// An argument of an operation, or nothing. Throws InputError if it has another type. expected: for the message.
template <typename Value>
std::optional<Value> argument(const nlohmann::json& arguments, const char* name, const char* expected) {
  const auto found = arguments.find(name);
  if (found == arguments.end() || found->is_null()) {
    return std::nullopt;
  }
  try {
    return found->get<Value>();
  } catch (const nlohmann::json::exception&) {
    throw InputError(name, 0, shortened(found->dump()), expected);
  }
}

/// A whole number from 0 to 2^32 - 1. Nothing is converted or cut: -1 and 2.5 are errors, too.
inline std::optional<std::uint32_t> whole_argument(const nlohmann::json& arguments, const char* name,
                                                   const char* expected) {
  const auto found = arguments.find(name);
  if (found == arguments.end() || found->is_null()) {
    return std::nullopt;
  }
  const bool is_natural =
      found->is_number_unsigned() || (found->is_number_integer() && found->get<std::int64_t>() >= 0);
  if (!is_natural || found->get<std::uint64_t>() > std::numeric_limits<std::uint32_t>::max()) {
    throw InputError(name, 0, shortened(found->dump()), expected);
  }
  return found->get<std::uint32_t>();
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

/// A thread that does what viewers ask for, and outlives its errors.
class SessionThread {
 public:
  SessionThread(const SessionThread&) = delete;
  SessionThread& operator=(const SessionThread&) = delete;

 protected:
  using Clock = std::chrono::steady_clock;
  using Stops = std::vector<host::SessionRequests::Stop>;

  /// requests, output: must outlive this.
  SessionThread(host::SessionRequests& requests, host::SessionOutput& output) : requests_(requests), output_(output) {}
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
  /// Returns the value of the answer, or throws the refusal.
  [[nodiscard]] virtual nlohmann::json carry_out(const host::OperationRequest& operation) = 0;

  /// All STOPs that wait. What was asked for before one of them is refused.
  [[nodiscard]] Stops take_stops();
  /// Carries out all operations that wait, and answers them. Returns whether there were any.
  bool take_operations();

  host::SessionRequests& requests_;
  host::SessionOutput& output_;

 private:
  void run();
  void report(const std::string& error);

  std::string last_error_;  ///< of serve(); empty if it has thrown none the last time
  std::thread thread_;
};

/// What other threads give a thread to do that waits for descriptors.
class TaskQueue {
 public:
  /// Throws std::system_error if the system has no descriptors left.
  TaskQueue();

  /// From any thread.
  void post(std::function<void()> task);
  /// Can be read when there is something to do.
  [[nodiscard]] int descriptor() const { return event_.number(); }
  /// Does it, in order. If a task throws, the later ones wait for the next call.
  void run();

 private:
  host::Descriptor event_;
  std::mutex mutex_;
  std::vector<std::function<void()>> tasks_;
};

}  // namespace proleg::tools
