#pragma once

#include <linux/can.h>

#include <optional>
#include <string>

#include "host/transport/descriptor.hpp"
#include "shared/can/can_frame.hpp"
#include "shared/can/can_port.hpp"

namespace proleg::host {

/// A raw socket of SocketCAN. Reads and writes return at once.
class CanSocket {
 public:
  struct Options {
    bool has_error_frames = true;
    bool receives_own_frames = true;  ///< with is_own, when the controller has sent them
  };
  struct Received {
    can_frame frame{};
    Microseconds time = 0;  ///< of the kernel, on the clock of steady_now()
    bool is_own = false;    ///< sent on this socket
  };

  /// Throws TransportError with one line, without the name: what is wrong with the interface, and what to do.
  CanSocket(const std::string& interface, const Options& options);

  /// Nothing if there is none; then error() is not 0 if the interface has failed.
  [[nodiscard]] std::optional<Received> read();
  /// 0, or the error of the system: ENOBUFS or EAGAIN if the queue is full.
  [[nodiscard]] int write(const CanFrame& frame);
  [[nodiscard]] int error() const { return error_; }
  /// Frames that the kernel dropped because they were not read in time.
  [[nodiscard]] std::uint32_t dropped() const { return dropped_; }
  [[nodiscard]] int descriptor() const { return socket_.number(); }

 private:
  void set_options(const Options& options) const;

  Descriptor socket_;
  int error_ = 0;
  std::uint32_t dropped_ = 0;
};

/// A standard data frame, in the form of the protocol; nothing for all other frames.
[[nodiscard]] std::optional<CanFrame> protocol_frame(const can_frame& frame);

/// One line for the errors of a socket whose interface has failed: ENETDOWN, ENODEV.
[[nodiscard]] std::string can_failure(const std::string& interface, int error);

}  // namespace proleg::host
