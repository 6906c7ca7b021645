#pragma once

#include <boost/asio/io_context.hpp>
#include <memory>
#include <string>
#include <string_view>

#include "host/transport/descriptor.hpp"

namespace proleg::host {

/// What is at this end of a stream of bytes.
class ByteStreamOwner {
 public:
  /// The connection of a descriptor that was being connected is there.
  virtual void connected() {}
  /// How many bytes may be read now. 0: none until ByteStream::resume().
  [[nodiscard]] virtual std::size_t read_room() { return 4'096; }
  virtual void read(std::string_view bytes) = 0;
  /// At most this many bytes to write; empty: none until ByteStream::flush().
  [[nodiscard]] virtual std::string take_output(std::size_t max_bytes) = 0;
  /// The stream has ended and does nothing any more. error: of the system; 0: the other end closed it.
  virtual void ended(int error) = 0;

 protected:
  ~ByteStreamOwner() = default;
};

/// A serial line, a socket or a pipe. Its events come from the io_context; the owner is called from there only. The
/// owner may destroy the stream in any of its functions.
class ByteStream {
 public:
  /// descriptor: its reads and writes return at once. is_connecting: connect() returned EINPROGRESS.
  ByteStream(boost::asio::io_context& context, Descriptor descriptor, bool is_connecting, ByteStreamOwner& owner);
  /// Closes the descriptor. What the system has not taken is lost.
  ~ByteStream();
  ByteStream(const ByteStream&) = delete;
  ByteStream& operator=(const ByteStream&) = delete;

  /// There is output. It is written soon, not in this call.
  void flush();
  /// There is room for input again.
  void resume();
  /// Writes now what the system takes at once, for a last message.
  void write_last(std::string_view bytes);
  [[nodiscard]] int descriptor() const;

 private:
  class Events;
  std::shared_ptr<Events> events_;
};

}  // namespace proleg::host
