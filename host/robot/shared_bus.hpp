#pragma once

#include <boost/asio/io_context.hpp>
#include <cstddef>
#include <deque>
#include <optional>

#include "host/robot/bus_connection.hpp"
#include "host/robot/bus_user.hpp"
#include "host/transport/bus_server.hpp"
#include "host/transport/descriptor.hpp"

namespace proleg::host {

/// Lets other programs take part in a bus that this program has open: each as if it had an slcan adapter of its own,
/// behind a socket that it inherits (`--bus fd:N`). Some adapters can be opened only once. What one of them or this
/// program sends, the others receive when the bus has carried it. When the connection to the bus is lost, they lose
/// theirs (look_at_connection()).
class SharedBus final : private BusUser, private BusServerListener {
 public:
  /// context: in which the transport of the bus runs. context, bus: must outlive this.
  SharedBus(boost::asio::io_context& context, BusConnection& bus);
  SharedBus(const SharedBus&) = delete;
  SharedBus& operator=(const SharedBus&) = delete;

  /// Adds a program. end: one end of a pair of stream sockets, of which the program has the other. It leaves when that
  /// is closed.
  void add(Descriptor end);
  /// Number of programs that take part.
  [[nodiscard]] std::size_t programs() const { return server_->open_clients(); }
  /// Ends the part of all programs if the connection to the bus has been lost for longer than this: they would wait for
  /// answers in vain, and name a wrong cause. Not to be called within a call of the bus.
  void look_at_connection(Microseconds longest_loss);

 private:
  /// A frame of a program that the bus has not carried yet.
  struct Sent {
    CanFrame frame;
    BusClient client;
  };
  /// More than the bus takes; of older ones no confirmation comes any more.
  static constexpr std::size_t max_sent = 2'048;

  // BusUser
  void receive(Microseconds now, const CanFrame& frame) override;
  void transmitted(Microseconds now, const CanFrame& frame) override;
  // BusServerListener
  [[nodiscard]] bool frame_from_client(BusClient client, const CanFrame& frame) override;

  boost::asio::io_context& context_;
  BusConnection& bus_;
  std::optional<BusServer> server_;
  BusAttachment attachment_;
  std::deque<Sent> sent_;
  Microseconds connected_at_ = 0;  ///< when it was looked at last
};

}  // namespace proleg::host
