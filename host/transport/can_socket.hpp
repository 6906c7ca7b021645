#pragma once

#include <linux/can.h>
#include <optional>
#include <string>

#include "host/transport/descriptor.hpp"
#include "shared/can/can_frame.hpp"
#include "shared/can/can_port.hpp"

namespace proleg::host {

/// The contents of an error frame of SocketCAN (linux/can/error.h).
struct CanErrorReport {
  CanStatus status;  ///< the state before, changed by the frame
  CanErrors errors;
  bool was_restarted = false;  ///< the controller has left bus-off
};

/// Reads an error frame. frame: a frame with CAN_ERR_FLAG. before: the state that is known.
[[nodiscard]] CanErrorReport read_can_error(const can_frame& frame, const CanStatus& before);

/// A raw socket of SocketCAN. Reads and writes return at once.
class CanSocket {
 public:
  struct Options {
    bool has_error_frames = true;
    bool receives_own_frames = true;  ///< own frames are received, with is_own, when the controller has sent them
  };
  struct Received {
    can_frame frame{};
    Microseconds time = 0;  ///< time stamp of the kernel, on the clock of steady_now()
    bool is_own = false;    ///< the frame was sent on this socket
  };

  /// Opens a socket. Throws TransportError with one line, without the name of the interface: what is wrong with it,
  /// and what to do.
  CanSocket(const std::string& interface, const Options& options);

  /// Reads a frame; nothing if there is none. error() is then not 0 if the interface has failed.
  [[nodiscard]] std::optional<Received> read();
  /// Writes a frame. Returns 0, or the error of the system: ENOBUFS or EAGAIN if the queue is full.
  [[nodiscard]] int write(const CanFrame& frame);
  [[nodiscard]] int error() const { return error_; }
  /// Number of frames that the kernel dropped because they were not read in time.
  [[nodiscard]] std::uint32_t dropped() const { return dropped_; }
  [[nodiscard]] int descriptor() const { return socket_.number(); }

 private:
  void set_options(const Options& options) const;

  Descriptor socket_;
  int error_ = 0;
  std::uint32_t dropped_ = 0;
};

/// Converts a standard data frame to a frame of the protocol; returns nothing for all other frames.
[[nodiscard]] std::optional<CanFrame> protocol_frame(const can_frame& frame);

/// One line about the error of a socket whose interface has failed: ENETDOWN, ENODEV.
[[nodiscard]] std::string can_failure(const std::string& interface, int error);

}  // namespace proleg::host
