#pragma once

// Where programs connect to this one: a pseudo terminal, or a TCP port.

#include <boost/asio/io_context.hpp>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "host/transport/descriptor.hpp"
#include "host/transport/event_loop.hpp"

namespace proleg::host {

/// A pseudo terminal that one client after the other opens, as it would open a serial line.
class PseudoTerminal {
 public:
  /// The function receives a descriptor for a client, at most 20 ms after it has opened the terminal; after
  /// client_gone() it is called for the next one. Throws TransportError.
  PseudoTerminal(boost::asio::io_context& context, std::function<void(Descriptor)> function);

  /// The name of the terminal that clients open, for example /dev/pts/3.
  [[nodiscard]] const std::string& name() const { return name_; }
  /// Notes that the descriptor that the function received has ended (EIO), since no client has the terminal open.
  void client_gone();

 private:
  [[nodiscard]] bool has_client() const;
  void prepare() const;
  void look();

  Descriptor master_;
  std::string name_;
  std::function<void(Descriptor)> function_;
  Timer timer_;
};

/// A TCP port that clients connect to.
class TcpListener {
 public:
  /// host: an address of this computer, an IPv6 address without brackets; 127.0.0.1 and ::1 let in programs of this
  /// computer only, 0.0.0.0 and :: those of all computers. port 0: any free port. The function receives the socket of
  /// each client and its address as text. Throws TransportError.
  TcpListener(boost::asio::io_context& context, const std::string& host, std::uint16_t port,
              std::function<void(Descriptor, const std::string&)> function);

  [[nodiscard]] std::uint16_t port() const { return port_; }

 private:
  void listen(const std::string& host, std::uint16_t port);
  void accept_clients();

  std::function<void(Descriptor, const std::string&)> function_;
  Descriptor socket_;
  std::uint16_t port_ = 0;
  std::unique_ptr<DescriptorWatch> watch_;
};

}  // namespace proleg::host
