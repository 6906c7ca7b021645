#pragma once

#include <boost/asio/io_context.hpp>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "host/transport/bus_clients.hpp"
#include "host/transport/listeners.hpp"

namespace proleg::host {

/// Number of a client of a BusServer, which is an slcan client or a CAN interface. No number is used twice.
using BusClient = std::uint32_t;
inline constexpr BusClient no_client = 0;

/// The bus behind a BusServer.
class BusServerListener {
 public:
  /// Receives a frame of a client. Returns false if the bus has no room now; an slcan client then receives BEL. The
  /// bus gives the frame to the other clients with broadcast(time, frame, client), at once or when it has been on the
  /// bus.
  [[nodiscard]] virtual bool frame_from_client(BusClient client, const CanFrame& frame) = 0;
  /// Receives one line for a log: a client came or went, or an interface failed.
  virtual void client_event(const std::string& /*line*/) {}
  /// The other end of the descriptor of add_descriptor() has closed it.
  virtual void descriptor_closed() {}

 protected:
  ~BusServerListener() = default;
};

/// Lets programs take part in a bus of this process, as if each had an slcan adapter or a CAN interface of its own.
/// Everything happens in the io_context.
class BusServer {
 public:
  struct Totals {
    std::uint64_t frames_from_clients = 0;
    std::uint64_t frames_refused = 0;  ///< frames of clients that were answered with BEL
    std::uint64_t frames_dropped = 0;  ///< frames for clients that do not read fast enough
  };

  BusServer(boost::asio::io_context& context, BusServerListener& listener, const SlcanAdapter::Settings& settings = {});

  /// Adds a pseudo terminal for one slcan client after the other. Returns its name. All add functions throw
  /// TransportError with one line.
  std::string add_pseudo_terminal();
  /// Adds a TCP port for slcan clients, up to 32 at once. host: 127.0.0.1 lets in programs of this computer only. port
  /// 0: any free port. Returns the port.
  std::uint16_t add_tcp(const std::string& host, std::uint16_t port);
  /// Adds an slcan client at the other end of a socket or pipe that this process has inherited and now owns.
  void add_descriptor(int descriptor);
  void add_can(const std::string& interface);

  /// Sends a frame that was on the bus to all clients with an open channel, except one.
  void broadcast(Microseconds time, const CanFrame& frame, BusClient except = no_client);
  /// Reports the error state of the bus to present and later slcan clients.
  void status_changed(const CanStatus& status);
  void errors_occurred(CanErrors errors);

  /// Number of slcan clients whose channel is open.
  [[nodiscard]] std::size_t open_clients() const;
  [[nodiscard]] Totals totals() const;

 private:
  struct Client {
    std::string name;
    std::unique_ptr<SlcanSession> session;
  };

  /// ended: called when the client has gone, after it was forgotten.
  void add_session(Descriptor descriptor, const std::string& name, std::function<void()> ended);
  void end_session(BusClient client);

  boost::asio::io_context& context_;
  BusServerListener& listener_;
  const SlcanAdapter::Settings settings_;
  std::map<BusClient, Client> clients_;
  std::map<BusClient, std::unique_ptr<CanNode>> can_nodes_;
  std::vector<std::unique_ptr<PseudoTerminal>> terminals_;
  std::vector<std::unique_ptr<TcpListener>> tcp_listeners_;
  CanStatus status_;
  Totals past_;  ///< totals of clients that have gone
  BusClient last_client_ = no_client;
};

}  // namespace proleg::host
