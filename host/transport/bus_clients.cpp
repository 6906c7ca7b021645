#include "host/transport/bus_clients.hpp"

#include <cerrno>
#include <utility>

#include "host/transport/transport.hpp"

namespace proleg::host {
namespace {

constexpr std::size_t node_queue = 1'024;
constexpr Microseconds node_retry_pause = 500;  // a full queue (ENOBUFS) cannot be waited for
constexpr Microseconds reconnect_pause = 500'000;
constexpr unsigned node_reads_in_a_row = 64;  // frames that are read before other work of the context runs

}  // namespace

SlcanSession::SlcanSession(boost::asio::io_context& context, Descriptor descriptor,
                           const SlcanAdapter::Settings& settings, Functions functions)
    : functions_(std::move(functions)),
      adapter_(buffer_, *this, settings),
      stream_(context, std::move(descriptor), false, *this) {}

void SlcanSession::received(Microseconds time, const CanFrame& frame) {
  adapter_.received(time, frame);
  flush();
}

void SlcanSession::status_changed(const CanStatus& status) {
  adapter_.status_changed(status);
  flush();
}

void SlcanSession::errors_occurred(CanErrors errors) {
  adapter_.errors_occurred(errors);
  flush();
}

std::size_t SlcanSession::read_room() {
  const std::size_t room = adapter_.input_room();
  is_waiting_ = room == 0;
  return room;
}

void SlcanSession::read(std::string_view bytes) {
  adapter_.input(bytes);
  flush();
}

std::string SlcanSession::take_output(std::size_t max_bytes) {
  std::string output(max_bytes, '\0');
  output.resize(adapter_.take(output));
  if (is_waiting_ && adapter_.input_room() > 0) {
    is_waiting_ = false;
    stream_.resume();
  }
  return output;
}

void SlcanSession::ended(int error) {
  // A copy is called, because the function may destroy the session.
  const auto function = functions_.ended;
  function(error);
}

void SlcanSession::flush() {
  if (adapter_.has_output()) {
    stream_.flush();
  }
}

CanNode::CanNode(boost::asio::io_context& context, std::string interface, Functions functions)
    : context_(context),
      interface_(std::move(interface)),
      functions_(std::move(functions)),
      retry_(context, [this] { write(); }),
      reconnect_(context, [this] { reconnect(); }) {
  try {
    connect();
  } catch (const TransportError& error) {
    throw TransportError(interface_ + ": " + error.what(), error.problem());
  }
}

void CanNode::connect() {
  socket_ = std::make_unique<CanSocket>(interface_,
                                        CanSocket::Options{.has_error_frames = false, .receives_own_frames = false});
  watch_ = std::make_unique<DescriptorWatch>(context_, socket_->descriptor(), [this] { read(); });
}

void CanNode::reconnect() {
  try {
    connect();
    functions_.changed({});
  } catch (const TransportError&) {
    reconnect_.set(steady_now() + reconnect_pause);
  }
}

void CanNode::lose(int error) {
  watch_.reset();
  socket_.reset();
  dropped_ += queue_.size();
  queue_.clear();
  retry_.set(never);
  reconnect_.set(steady_now() + reconnect_pause);
  functions_.changed(interface_ + ": " + can_failure(interface_, error));
}

void CanNode::read() {
  for (unsigned i = 0; i < node_reads_in_a_row && socket_; ++i) {
    const auto received = socket_->read();
    if (!received) {
      if (socket_->error() != 0) {
        lose(socket_->error());
      }
      return;
    }
    if (const auto frame = protocol_frame(received->frame)) {
      functions_.received(*frame);
    }
  }
}

void CanNode::send(const CanFrame& frame) {
  if (!socket_ || queue_.size() >= node_queue) {
    ++dropped_;
    return;
  }
  queue_.push_back(frame);
  if (queue_.size() == 1) {
    retry_.set(steady_now());  // the next attempt is not in this call, because the interface may have failed
  }
}

void CanNode::write() {
  while (socket_ && !queue_.empty()) {
    const int error = socket_->write(queue_.front());
    if (error == ENOBUFS || error == EAGAIN) {
      retry_.set(steady_now() + node_retry_pause);
      return;
    }
    if (error != 0 && error != EINTR) {
      lose(error);
      return;
    }
    if (error == 0) {
      queue_.pop_front();
    }
  }
}

}  // namespace proleg::host
