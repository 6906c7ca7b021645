#pragma once

// Lets GDB inspect a stopped program: `gdb-multiarch IMAGE -ex 'target remote :PORT'`.
//
// The owner of the target runs and stops it; the server communicates while it stands still:
//
//   GdbServer server(port, target);               // port 0: any; see server.port()
//   if (!server.wait_for_client(interrupted)) return;
//   Resume resume = server.serve(StopReason::attached, interrupted);
//   while (resume != Resume::kill && resume != Resume::interrupted) {
//     StopReason reason;
//     if (resume == Resume::step) {
//       ... execute one instruction ...
//       reason = StopReason::step;
//     } else {                                    // run or detach: after detach without breakpoints
//       ... execute until a breakpoint, a fault, or server.interrupt_requested() ...
//       reason = ...
//     }
//     resume = server.serve(reason, interrupted);
//   }
//
// interrupt_requested() costs a system call; every few milliseconds of the user's time is enough. Without a client
// (after a detach or a lost connection) serve() returns Resume::detach at once, and the target runs on;
// interrupt_requested() finds a client that comes later, and then requests a stop. There is one client at a time;
// others are disconnected.
//
// All functions must be called from one thread. Only programs on this computer can connect.

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "sim/mcu/debug/debug_target.hpp"
#include "sim/mcu/debug/gdb_commands.hpp"
#include "sim/mcu/debug/gdb_packet.hpp"
#include "sim/mcu/debug/local_socket.hpp"

namespace proleg::sim {

class GdbServer {
 public:
  /// Returns whether to stop waiting; called at least every 100 ms.
  using Interrupted = std::function<bool()>;

  /// Listens on 127.0.0.1. The target must outlive the server. Throws std::runtime_error with one line if the port
  /// cannot be had.
  GdbServer(std::uint16_t port, DebugTarget& target);

  [[nodiscard]] std::uint16_t port() const { return listener_.port(); }
  [[nodiscard]] bool has_client() const { return connection_.has_value(); }

  /// Sets the function that answers the user's `monitor TEXT`.
  void set_monitor(MonitorCommand monitor) { commands_.set_monitor(std::move(monitor)); }

  /// Blocks until there is a client; false if `interrupted` was true before.
  [[nodiscard]] bool wait_for_client(const Interrupted& interrupted);

  /// To be called when the target has stopped. Reports the stop to the client, and answers it until it resumes the
  /// target.
  [[nodiscard]] Resume serve(StopReason reason, const Interrupted& interrupted);

  /// To be called every few milliseconds while the target runs, where breakpoints can be changed. Does not block. True
  /// if the target must stop: the client requests it, or a new one has connected.
  [[nodiscard]] bool interrupt_requested();

  /// Sends a text to the user, while the target runs or before serve(), for example the cause of a fault. The text is
  /// dropped if no client waits for the target, or if the client does not read.
  void send_text(std::string_view text);

  /// The program has ended: reports this status to the client and disconnects it.
  void finish(std::uint8_t status);

 private:
  [[nodiscard]] bool accept_client();
  void disconnect();
  void receive();
  void send(std::string_view payload);
  void flush();
  [[nodiscard]] std::optional<GdbInput> next_input();
  [[nodiscard]] std::optional<Resume> handle(const GdbInput& input);
  [[nodiscard]] std::optional<Resume> handle_packet(const std::string& payload);

  LocalListener listener_;
  GdbCommands commands_;
  std::optional<LocalConnection> connection_;
  GdbDecoder decoder_;
  std::optional<GdbInput> unanswered_;  ///< a packet that came while the target ran
  std::string unsent_;
  std::string last_packet_;
  bool acknowledges_ = true;
  bool awaits_stop_ = false;  ///< the client has resumed the target, and waits for its stop
};

}  // namespace proleg::sim
