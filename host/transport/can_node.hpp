#pragma once

#include <boost/asio/io_context.hpp>
#include <deque>
#include <functional>
#include <memory>
#include <string>

#include "host/transport/can_socket.hpp"
#include "host/transport/descriptor_watch.hpp"
#include "host/transport/event_loop.hpp"

namespace proleg::host {

/// A CAN interface of Linux as a node of a simulated bus: its frames go in both directions.
class CanNode {
 public:
  struct Functions {
    std::function<void(const CanFrame&)> received;
    /// The interface has failed, with one line; or it is back, and the line is empty.
    std::function<void(const std::string&)> changed;
  };

  /// Throws TransportError if the interface cannot be used now. Later it is opened again when it is back.
  CanNode(boost::asio::io_context& context, std::string interface, Functions functions);

  /// Frames that the kernel cannot take now wait for it, up to 1,024; more are dropped and counted.
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
