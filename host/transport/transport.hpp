#pragma once

// One end of a CAN bus, over any kind of connection. All functions of a transport run in the thread that calls
// run_until() or runs its io_context.

#include <cstdint>
#include <stdexcept>
#include <string>

#include "shared/can/can_frame.hpp"
#include "shared/can/can_port.hpp"

namespace proleg::host {

/// The reason why a bus cannot be reached, for a program that explains more than one line can.
enum class TransportProblem : std::uint8_t {
  other,
  no_kernel_support,  ///< the kernel has no CAN sockets
  missing,            ///< no such interface or device
  wrong_kind,         ///< it is no CAN interface, or no serial line
  interface_down,
  no_rights,
  in_use,       ///< another program has it open
  no_answer,    ///< nothing was received from the adapter
  not_slcan,    ///< bytes were received that no slcan adapter sends
  no_listener,  ///< the host is on, and no program of it listens at the port
  no_bit_rate,  ///< the adapter refuses 1 Mbit/s, or to open its channel
};

/// A bus that cannot be reached. what() is one line: what failed, and what to do.
class TransportError : public std::runtime_error {
 public:
  explicit TransportError(const std::string& what, TransportProblem problem = TransportProblem::other)
      : std::runtime_error(what), problem_(problem) {}
  [[nodiscard]] TransportProblem problem() const { return problem_; }

 private:
  TransportProblem problem_;
};

/// The state of the bus. A part that a transport cannot find out keeps its default value.
struct BusState {
  bool is_connected = false;
  std::string reason;            ///< one line: why it is not connected, or why frames cannot be sent; else empty
  CanStatus controller;          ///< state of the controller at this end
  CanErrors errors;              ///< kinds of errors since the transport was opened
  std::uint64_t bus_errors = 0;  ///< error reports since the transport was opened

  friend bool operator==(const BusState&, const BusState&) = default;
};

/// What has happened since the transport was opened; losses of the connection do not reset it.
struct Statistics {
  std::uint64_t received = 0;     ///< frames given to the listener
  std::uint64_t transmitted = 0;  ///< frames that the adapter or the controller took
  std::uint64_t refused = 0;      ///< frames that the adapter rejected
  std::uint64_t unconfirmed = 0;  ///< frames whose confirmation is missing: they may have been sent
  std::uint64_t dropped_out = 0;  ///< frames not sent: the queue was full, or the connection was lost
  std::uint64_t dropped_in = 0;   ///< received frames that the kernel dropped because this process was too slow
  std::uint64_t foreign = 0;      ///< extended and remote frames, which are ignored
  std::uint64_t malformed = 0;    ///< lines from an adapter that are not slcan
  std::string malformed_line;     ///< the last of them, in quotes, as a person can read it; empty if there was none
  std::uint64_t connections = 0;  ///< number of connections: the first, and one for each reconnection
};

class TransportListener {
 public:
  /// Receives a frame of another node; the time is on the transport's clock.
  virtual void received(Microseconds time, const CanFrame& frame) = 0;
  /// The adapter or the controller took a frame of send(): SocketCAN: it is on the bus; slcan: the adapter confirmed
  /// it, or the line took it if the adapter confirms nothing.
  virtual void transmitted(Microseconds time, const CanFrame& frame) = 0;
  virtual void state_changed(const BusState& /*state*/) {}

 protected:
  ~TransportListener() = default;
};

class Transport {
 public:
  virtual ~Transport() = default;
  Transport() = default;
  Transport(const Transport&) = delete;
  Transport& operator=(const Transport&) = delete;

  /// The time in microseconds on a steady clock with an arbitrary start.
  [[nodiscard]] virtual Microseconds now() const = 0;
  /// Sends a frame. Returns false if the queue is full or the bus is not connected; the frame is then counted as
  /// dropped_out.
  [[nodiscard]] virtual bool send(const CanFrame& frame) = 0;
  /// Handles events until the listener was called, or until this time. Other work of the io_context runs meanwhile.
  virtual void run_until(Microseconds deadline) = 0;
  [[nodiscard]] virtual const BusState& state() const = 0;
  [[nodiscard]] virtual Statistics statistics() const = 0;
  /// One line for the user: the address and, as far as known, the adapter behind it.
  [[nodiscard]] virtual std::string description() const = 0;
};

}  // namespace proleg::host
