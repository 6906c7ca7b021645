#pragma once

#include <boost/asio/io_context.hpp>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "host/transport/byte_stream.hpp"
#include "host/transport/pseudo_terminal.hpp"
#include "host/transport/tcp_listener.hpp"

namespace proleg::host {

/// The end of a serial line in this process, for one program after the other. It carries bytes and does not look at
/// them. Bytes for the line are lost while no program is there, and if the program lets more than 65,536 wait.
class LineServer final : private ByteStreamOwner {
 public:
  /// All are called from the io_context.
  struct Functions {
    /// The program has sent these bytes, not more than room() said.
    std::function<void(std::string_view bytes)> received;
    /// How many bytes the line takes now. 0: none until resume().
    std::function<std::size_t()> room;
    /// One line for a log: a program came, has gone, was refused, or loses bytes.
    std::function<void(const std::string& line)> event;
  };

  LineServer(boost::asio::io_context& context, Functions functions);

  /// A pseudo terminal at the other end. Returns its name. Throws TransportError with one line. The line has one end:
  /// call this or listen(), once.
  std::string open_pseudo_terminal();
  /// A TCP port at the other end; further programs are refused while one is connected. host, port, errors: as
  /// TcpListener has them. Returns the port.
  std::uint16_t listen(const std::string& host, std::uint16_t port);

  /// Bytes for the program.
  void send(std::string_view bytes);
  /// room() is not 0 any more.
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
  bool has_lost_ = false;  ///< bytes for this program
};

}  // namespace proleg::host
