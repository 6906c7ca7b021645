#pragma once

#include <memory>
#include <string>

#include "host/transport/bus_address.hpp"
#include "host/transport/descriptor.hpp"
#include "host/transport/slcan_client.hpp"

namespace proleg::host {

/// The way to an slcan adapter: how a descriptor for it is opened, and what its errors mean.
class Link {
 public:
  struct Opened {
    Descriptor descriptor;       ///< private, and its reads and writes return at once
    bool is_connecting = false;  ///< connect() returned EINPROGRESS
  };

  virtual ~Link() = default;

  /// Throws TransportError with one line, without the address: what failed, and what to do.
  [[nodiscard]] virtual Opened open() = 0;
  /// One line about a connection that cannot be made; the error is the system's.
  [[nodiscard]] virtual std::string connect_failure(int error) const;
  /// One line about a connection that has ended; 0: the other end closed it.
  [[nodiscard]] virtual std::string end_text(int error);
  /// What to look at if no adapter answers.
  [[nodiscard]] virtual std::string silence_hint() const = 0;
  /// A lost connection can be opened again.
  [[nodiscard]] virtual bool can_reopen() const { return true; }
  /// How many times open() tries something else, such as another address of a host.
  [[nodiscard]] virtual std::size_t alternatives() const { return 1; }
  [[nodiscard]] virtual Microseconds connect_timeout() const { return 5'000'000; }
  [[nodiscard]] virtual SlcanClient::Settings client_settings() const { return {}; }
};

/// A device with termios, without parity and flow control, which no other program may open meanwhile.
[[nodiscard]] std::unique_ptr<Link> make_serial_link(const std::string& device, unsigned baud);
[[nodiscard]] std::unique_ptr<Link> make_tcp_link(const std::string& host, unsigned port);
/// RFCOMM by the kernel's sockets.
[[nodiscard]] std::unique_ptr<Link> make_bluetooth_link(const BusAddress& address);
/// A descriptor that this process has. It is closed with the link.
[[nodiscard]] std::unique_ptr<Link> make_descriptor_link(int descriptor);
/// A program that is started as `program file --fd 3` and speaks slcan on that descriptor. Its standard error is that
/// of this process. Signals of the terminal do not reach it. It is ended with the link: its descriptor is closed, it
/// gets SIGTERM, and after two seconds SIGKILL.
[[nodiscard]] std::unique_ptr<Link> make_program_link(const std::string& program, const std::string& file);

/// The folder of the program that runs, with a slash at the end.
[[nodiscard]] std::string program_folder();

}  // namespace proleg::host
