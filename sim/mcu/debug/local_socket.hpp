#pragma once

// TCP on 127.0.0.1 for one client; only wait() waits. It needs Linux and POSIX.1-2008 sockets.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

namespace proleg::sim {

/// Owns a file descriptor, from open() or socket().
class FileDescriptor {
 public:
  explicit FileDescriptor(int number) : number_(number) {}
  FileDescriptor(FileDescriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  FileDescriptor& operator=(FileDescriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  ~FileDescriptor();

  [[nodiscard]] int number() const { return number_; }

 private:
  int number_;
};

/// The connection to a client.
class LocalConnection {
 public:
  explicit LocalConnection(FileDescriptor socket);

  /// Send and receive return the number of bytes, 0 if the call would have to wait or the connection is lost.
  std::size_t send(std::string_view bytes);
  std::size_t receive(std::span<char> bytes);
  /// False once send() or receive() has found the connection closed or broken.
  [[nodiscard]] bool open() const { return open_; }
  [[nodiscard]] int descriptor() const { return socket_.number(); }

 private:
  [[nodiscard]] std::size_t result(std::ptrdiff_t length);

  FileDescriptor socket_;
  bool open_ = true;
};

class LocalListener {
 public:
  /// Listens on a port; 0: any free port. Throws std::runtime_error with one line if the port is not available.
  explicit LocalListener(std::uint16_t port);

  [[nodiscard]] std::uint16_t port() const { return port_; }
  [[nodiscard]] std::optional<LocalConnection> accept();
  [[nodiscard]] int descriptor() const { return socket_.number(); }

 private:
  FileDescriptor socket_;
  std::uint16_t port_ = 0;
};

/// Shows which of the two can be used without waiting.
struct Ready {
  bool listener = false;    ///< a client wants to connect
  bool connection = false;  ///< bytes can be received (or sent, if to_send), or the connection is lost
};

/// Waits until one of them is ready, at most a given time; 0 does not wait. connection may be null.
[[nodiscard]] Ready wait(const LocalListener& listener, const LocalConnection* connection, bool to_send,
                         int milliseconds);

}  // namespace proleg::sim
