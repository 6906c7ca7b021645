#pragma once

#include <boost/asio/io_context.hpp>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "host/transport/byte_stream.hpp"
#include "host/transport/listeners.hpp"

namespace proleg::host {

/// The end of a serial line in this process, for one program after the other. It carries bytes and does not look at
/// them. Bytes for the line are lost while no program is there, and if the program lets more than 65,536 wait.
class LineServer final : private ByteStreamOwner {
 public:
  /// Functions that are called from the io_context.
  struct Functions {
    /// Receives bytes that the program has sent, not more than room() has returned.
    std::function<void(std::string_view bytes)> received;
    /// Number of bytes that the line takes now; after 0, no bytes are read until resume().
    std::function<std::size_t()> room;
    /// Receives one line for a log: a program came, has gone, was refused, or loses bytes.
    std::function<void(const std::string& line)> event;
  };

  LineServer(boost::asio::io_context& context, Functions functions);

  /// Opens a pseudo terminal at the other end. Returns its name. Throws TransportError with one line. The line has one
  /// end: call either this function or listen(), once.
  std::string open_pseudo_terminal();
  /// Opens a TCP port at the other end; further programs are refused while one is connected. host, port and errors are
  /// those of TcpListener. Returns the port.
  std::uint16_t listen(const std::string& host, std::uint16_t port);

  /// Sends bytes to the program.
  void send(std::string_view bytes);
  /// Notes that room() is no longer 0.
  void resume();

 private:
  static constexpr std::size_t max_output = 65'536;

  [[nodiscard]] std::size_t read_room() override { return functions_.room(); }
  void read(std::string_view bytes) override { functions_.received(bytes); }
  [[nodiscard]] std::string take_output(std::size_t max_bytes) override;
  void ended(int error) override;
  void begin(Descriptor descriptor, const std::string& client);
  void accept(Descriptor descriptor, const std::string& client);
  [[nodiscard]] bool has_gone() const;

  boost::asio::io_context& context_;
  Functions functions_;
  std::unique_ptr<PseudoTerminal> terminal_;
  std::unique_ptr<TcpListener> listener_;
  std::unique_ptr<ByteStream> stream_;  ///< null: no program is there
  std::string client_;
  std::string output_;
  bool has_lost_ = false;  ///< bytes for this program were lost
};

}  // namespace proleg::host
