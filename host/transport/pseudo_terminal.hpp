#pragma once

#include <boost/asio/io_context.hpp>
#include <functional>
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

}  // namespace proleg::host
