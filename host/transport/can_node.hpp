#pragma once

#include <boost/asio/io_context.hpp>
#include <deque>
#include <functional>
#include <memory>
#include <string>

#include "host/transport/can_socket.hpp"
#include "host/transport/event_loop.hpp"

namespace proleg::host {

/// A CAN interface of Linux as a node of a simulated bus: its frames go in both directions.
class CanNode {
 public:
  struct Functions {
    std::function<void(const CanFrame&)> received;
    /// Receives one line when the interface has failed, and an empty one when it is back.
    std::function<void(const std::string&)> changed;
  };

  /// Opens the interface. Throws TransportError if it cannot be used now. If it fails later, it is opened again when
  /// it is back.
  CanNode(boost::asio::io_context& context, std::string interface, Functions functions);

  /// Sends a frame. Up to 1,024 frames wait for the kernel; more are dropped and counted.
  void send(const CanFrame& frame);
  [[nodiscard]] const std::string& interface() const { return interface_; }
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }

 private:
  void connect();
  void reconnect();
  void lose(int error);
  void read();
  void write();

  boost::asio::io_context& context_;
  const std::string interface_;
  const Functions functions_;
  std::unique_ptr<CanSocket> socket_;
  std::unique_ptr<DescriptorWatch> watch_;
  Timer retry_;
  Timer reconnect_;
  std::deque<CanFrame> queue_;
  std::uint64_t dropped_ = 0;
};

}  // namespace proleg::host
