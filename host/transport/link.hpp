#pragma once

#include <memory>
#include <string>

#include "host/transport/bus_address.hpp"
#include "host/transport/descriptor.hpp"
#include "host/transport/slcan_client.hpp"

namespace proleg::host {

/// The connection to an slcan adapter: opens a descriptor for it, and explains its errors.
class Link {
 public:
  struct Opened {
    Descriptor descriptor;       ///< a private descriptor whose reads and writes return at once
    bool is_connecting = false;  ///< connect() returned EINPROGRESS
  };

  virtual ~Link() = default;

  /// Opens a descriptor. Throws TransportError with one line, without the address: what failed, and what to do.
  [[nodiscard]] virtual Opened open() = 0;
  /// One line about a connection that cannot be made. error: error of the system.
  [[nodiscard]] virtual std::string connect_failure(int error) const;
  /// One line about a connection that has ended. error: error of the system; 0: the other end closed it.
  [[nodiscard]] virtual std::string end_text(int error);
  /// What the user should check if no adapter answers.
  [[nodiscard]] virtual std::string silence_hint() const = 0;
  /// Whether a lost connection can be opened again.
  [[nodiscard]] virtual bool can_reopen() const { return true; }
  /// Number of alternatives that open() tries one after the other, such as the addresses of a host.
  [[nodiscard]] virtual std::size_t alternatives() const { return 1; }
  [[nodiscard]] virtual Microseconds connect_timeout() const { return 5'000'000; }
  [[nodiscard]] virtual SlcanClient::Settings client_settings() const { return {}; }
};

/// Makes a link to a device with termios, without parity and flow control, which no other program may open meanwhile.
[[nodiscard]] std::unique_ptr<Link> make_serial_link(const std::string& device, unsigned baud);
[[nodiscard]] std::unique_ptr<Link> make_tcp_link(const std::string& host, unsigned port);
/// Makes a link over RFCOMM by the kernel's sockets.
[[nodiscard]] std::unique_ptr<Link> make_bluetooth_link(const BusAddress& address);
/// Makes a link to a descriptor of this process, which is closed with the link.
[[nodiscard]] std::unique_ptr<Link> make_descriptor_link(int descriptor);
/// Makes a link to a program that is started as `program file --fd 3` and speaks slcan on that descriptor. Its
/// standard error is that of this process. Signals of the terminal do not reach it. It is ended with the link: its
/// descriptor is closed, it receives SIGTERM, and after two seconds SIGKILL.
[[nodiscard]] std::unique_ptr<Link> make_program_link(const std::string& program, const std::string& file);

/// The folder of the program that runs, with a slash at the end.
[[nodiscard]] std::string program_folder();

}  // namespace proleg::host
