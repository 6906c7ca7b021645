#include "host/transport/byte_stream.hpp"

#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <cerrno>

namespace proleg::host {
namespace {

using boost::asio::posix::stream_descriptor;
using boost::system::error_code;

constexpr std::size_t max_transfer = 4'096;

bool must_wait(int error) { return error == EAGAIN || error == EINTR; }

bool is_socket(int descriptor) {
  int type = 0;
  socklen_t size = sizeof type;
  return getsockopt(descriptor, SOL_SOCKET, SO_TYPE, &type, &size) == 0;
}

}  // namespace

/// The handlers own this, so that one that is under way when the stream is destroyed finds `owner_` empty.
class ByteStream::Events : public std::enable_shared_from_this<ByteStream::Events> {
 public:
  Events(boost::asio::io_context& context, Descriptor descriptor, ByteStreamOwner& owner)
      : is_socket_(is_socket(descriptor.number())),
        descriptor_(context.get_executor(), descriptor.number()),
        owner_(&owner) {
    static_cast<void>(descriptor.release());
  }

  void start(bool is_connecting) {
    if (is_connecting) {
      descriptor_.async_wait(stream_descriptor::wait_write,
                             [self = shared_from_this()](const error_code& error) { self->finish_connect(error); });
    } else {
      resume();
    }
  }

  void resume() {
    if (owner_ == nullptr || is_reading_) {
      return;
    }
    is_reading_ = true;
    descriptor_.async_wait(stream_descriptor::wait_read, [self = shared_from_this()](const error_code& error) {
      self->is_reading_ = false;
      self->read(error);
    });
  }

  void flush() {
    if (owner_ != nullptr && !is_writing_) {
      wait_to_write();
    }
  }

  void write_last(std::string_view bytes) {
    if (owner_ != nullptr) {
      // A message that the system does not take is lost, as if the cable had been pulled.
      static_cast<void>(write_some(rest_ + std::string(bytes)));
    }
  }

  void close() {
    owner_ = nullptr;
    error_code ignored;
    descriptor_.close(ignored);
  }

  [[nodiscard]] int descriptor() { return descriptor_.native_handle(); }

 private:
  void finish_connect(const error_code& wait_error) {
    if (owner_ == nullptr) {
      return;
    }
    int error = wait_error.value();
    socklen_t size = sizeof error;
    if (!wait_error) {
      getsockopt(descriptor_.native_handle(), SOL_SOCKET, SO_ERROR, &error, &size);
    }
    if (error != 0) {
      end(error);
      return;
    }
    resume();
    flush();
    owner_->connected();
  }

  void read(const error_code& wait_error) {
    if (owner_ == nullptr) {
      return;
    }
    if (wait_error) {
      end(wait_error.value());
      return;
    }
    std::array<char, max_transfer> bytes{};
    const std::size_t room = std::min(owner_->read_room(), bytes.size());
    if (room == 0) {
      return;  // the owner calls resume()
    }
    const ssize_t length = ::read(descriptor_.native_handle(), bytes.data(), room);
    if (length == 0 || (length < 0 && !must_wait(errno))) {
      end(length == 0 ? 0 : errno);
      return;
    }
    resume();
    if (length > 0) {
      owner_->read({bytes.data(), static_cast<std::size_t>(length)});
    }
  }

  void write() {
    while (owner_ != nullptr) {
      if (rest_.empty()) {
        rest_ = owner_->take_output(max_transfer);
      }
      if (owner_ == nullptr || rest_.empty()) {
        return;
      }
      const ssize_t length = write_some(rest_);
      if (length < 0 && !must_wait(errno)) {
        end(errno);
        return;
      }
      rest_.erase(0, length > 0 ? static_cast<std::size_t>(length) : 0U);
      if (!rest_.empty()) {
        wait_to_write();
        return;
      }
    }
  }

  ssize_t write_some(std::string_view bytes) {
    // A socket whose other end is closed sends no SIGPIPE.
    return is_socket_ ? ::send(descriptor_.native_handle(), bytes.data(), bytes.size(), MSG_NOSIGNAL)
                      : ::write(descriptor_.native_handle(), bytes.data(), bytes.size());
  }

  void wait_to_write() {
    is_writing_ = true;
    descriptor_.async_wait(stream_descriptor::wait_write, [self = shared_from_this()](const error_code& error) {
      self->is_writing_ = false;
      if (!error && self->owner_ != nullptr) {
        self->write();
      }
    });
  }

  void end(int error) {
    ByteStreamOwner* const owner = owner_;
    close();
    owner->ended(error);
  }

  const bool is_socket_;
  stream_descriptor descriptor_;
  ByteStreamOwner* owner_;
  std::string rest_;  ///< bytes that were taken from the owner and are not written yet
  bool is_reading_ = false;
  bool is_writing_ = false;
};

ByteStream::ByteStream(boost::asio::io_context& context, Descriptor descriptor, bool is_connecting,
                       ByteStreamOwner& owner)
    : events_(std::make_shared<Events>(context, std::move(descriptor), owner)) {
  events_->start(is_connecting);
}

ByteStream::~ByteStream() { events_->close(); }

void ByteStream::flush() { events_->flush(); }

void ByteStream::resume() { events_->resume(); }

void ByteStream::write_last(std::string_view bytes) { events_->write_last(bytes); }

int ByteStream::descriptor() const { return events_->descriptor(); }

}  // namespace proleg::host
