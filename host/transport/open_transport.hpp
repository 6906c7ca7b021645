#pragma once

// Opens a bus by its address. A bus behind an slcan adapter is reached by a link: a serial line, a socket, a descriptor
// or a program.

#include <boost/asio/io_context.hpp>
#include <memory>
#include <string>
#include <vector>

#include "host/transport/bus_address.hpp"
#include "host/transport/descriptor.hpp"
#include "host/transport/slcan_client.hpp"
#include "host/transport/transport.hpp"

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
  [[nodiscard]] virtual TransportProblem connect_problem(int /*error*/) const { return TransportProblem::other; }
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
/// Makes a link to a program that is started as `program arguments --fd 3` and speaks slcan on that descriptor. Its
/// standard error is that of this process. Signals of the terminal do not reach it. It is ended with the link: its
/// descriptor is closed, it receives SIGTERM, and after two seconds SIGKILL.
[[nodiscard]] std::unique_ptr<Link> make_program_link(const std::string& program, std::vector<std::string> arguments);

/// The folder of the program that runs, or the one of use_programs_of(), with a slash at the end.
[[nodiscard]] std::string program_folder();
/// For a program that is not in the folder of the others, such as an interpreter: where these are.
void use_programs_of(const std::string& folder);

/// Opens a bus and returns when it is connected. The listener may be called before. Throws TransportError with one
/// line that begins with the address. The caller handles `auto`, because it can examine the bus behind each adapter.
[[nodiscard]] std::unique_ptr<Transport> open_transport(boost::asio::io_context& context, const BusAddress& address,
                                                        TransportListener& listener);

/// Opens a CAN interface of Linux. An interface that goes down or away later is opened again when it is back; the
/// listener receives each change. Throws TransportError with the interface's name at its beginning.
[[nodiscard]] std::unique_ptr<Transport> open_can_transport(boost::asio::io_context& context,
                                                            const std::string& interface, TransportListener& listener);

/// Opens a bus behind an slcan adapter. Returns when the adapter's channel is open. A connection that is lost later is
/// made again, after 0.1 s at first and 5 s at last, if the link allows it; the listener receives each change.
/// address: the text that errors begin with. Throws TransportError.
[[nodiscard]] std::unique_ptr<Transport> open_slcan_transport(boost::asio::io_context& context,
                                                              const std::string& address, std::unique_ptr<Link> link,
                                                              TransportListener& listener);

}  // namespace proleg::host
