#pragma once

// The two kinds of clients of a BusServer: a program with an slcan adapter, and a CAN interface of Linux.

#include <boost/asio/io_context.hpp>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "host/transport/byte_stream.hpp"
#include "host/transport/can_socket.hpp"
#include "host/transport/event_loop.hpp"
#include "shared/can/slcan_adapter.hpp"

namespace proleg::host {

/// An slcan adapter for one client on a stream. A client that does not read loses whole lines, which are counted; one
/// that sends faster than its answers are read has to wait.
class SlcanSession final : private ByteStreamOwner, private CanPort {
 public:
  struct Functions {
    /// Receives a frame of the client. Returns false if the bus has no room; the client then receives BEL.
    std::function<bool(const CanFrame&)> send;
    /// The stream has ended. error: error of the system; 0: the client closed it. The function may destroy the
    /// session.
    std::function<void(int error)> ended;
  };

  SlcanSession(boost::asio::io_context& context, Descriptor descriptor, const SlcanAdapter::Settings& settings,
               Functions functions);

  void received(Microseconds time, const CanFrame& frame);
  void status_changed(const CanStatus& status);
  void errors_occurred(CanErrors errors);
  [[nodiscard]] bool is_open() const { return adapter_.is_open(); }
  [[nodiscard]] const SlcanAdapter::Counters& counters() const { return adapter_.counters(); }

 private:
  static constexpr std::size_t buffer_size = 65'536;

  [[nodiscard]] std::size_t read_room() override;
  void read(std::string_view bytes) override;
  [[nodiscard]] std::string take_output(std::size_t max_bytes) override;
  void ended(int error) override;
  [[nodiscard]] bool send(const CanFrame& frame) override { return functions_.send(frame); }
  void flush();

  Functions functions_;
  std::vector<char> buffer_ = std::vector<char>(buffer_size);
  SlcanAdapter adapter_;
  bool is_waiting_ = false;  ///< the stream waits for room in the buffer
  ByteStream stream_;
};

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
