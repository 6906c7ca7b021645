#pragma once

#include <boost/asio/io_context.hpp>
#include <memory>
#include <string>
#include <string_view>

#include "host/transport/descriptor.hpp"

namespace proleg::host {

/// The object at this end of a stream of bytes.
class ByteStreamOwner {
 public:
  /// The descriptor, which was being connected, is connected.
  virtual void connected() {}
  /// Number of bytes that may be read now; after 0, no bytes are read until ByteStream::resume().
  [[nodiscard]] virtual std::size_t read_room() { return 4'096; }
  virtual void read(std::string_view bytes) = 0;
  /// Returns at most this many bytes to write; after an empty string, no bytes are taken until ByteStream::flush().
  [[nodiscard]] virtual std::string take_output(std::size_t max_bytes) = 0;
  /// The stream has ended. error: error of the system; 0: the other end closed the stream.
  virtual void ended(int error) = 0;

 protected:
  ~ByteStreamOwner() = default;
};

/// A serial line, a socket or a pipe. Its events come from the io_context; the owner is called from there only. The
/// owner may destroy the stream in any of its functions.
class ByteStream {
 public:
  /// descriptor: a descriptor whose reads and writes return at once. is_connecting: connect() returned EINPROGRESS.
  ByteStream(boost::asio::io_context& context, Descriptor descriptor, bool is_connecting, ByteStreamOwner& owner);
  /// Closes the descriptor. Bytes that the system has not taken are lost.
  ~ByteStream();
  ByteStream(const ByteStream&) = delete;
  ByteStream& operator=(const ByteStream&) = delete;

  /// Notes that the owner has output. It is written soon, not in this call.
  void flush();
  /// Notes that the owner has room for input again.
  void resume();
  /// Writes a last message: as many of the bytes as the system takes at once.
  void write_last(std::string_view bytes);
  [[nodiscard]] int descriptor() const;

 private:
  class Events;
  std::shared_ptr<Events> events_;
};

}  // namespace proleg::host
