#include "host/transport/line_server.hpp"

#include <poll.h>

#include <utility>

namespace proleg::host {

LineServer::LineServer(boost::asio::io_context& context, Functions functions)
    : context_(context), functions_(std::move(functions)) {}

std::string LineServer::open_pseudo_terminal() {
  terminal_ = std::make_unique<PseudoTerminal>(
      context_, [this](Descriptor descriptor) { begin(std::move(descriptor), terminal_->name()); });
  return terminal_->name();
}

std::uint16_t LineServer::listen(const std::string& host, std::uint16_t port) {
  listener_ =
      std::make_unique<TcpListener>(context_, host, port, [this](Descriptor descriptor, const std::string& address) {
        accept(std::move(descriptor), "tcp client " + address);
      });
  return listener_->port();
}

void LineServer::accept(Descriptor descriptor, const std::string& client) {
  // The end of the previous program and the beginning of the next one may be reported in either order.
  if (stream_ && has_gone()) {
    ended(0);
  }
  if (stream_) {
    functions_.event(client + " is refused: " + client_ + " uses the line");
    return;
  }
  begin(std::move(descriptor), client);
}

bool LineServer::has_gone() const {
  pollfd request{stream_->descriptor(), POLLRDHUP, 0};
  return poll(&request, 1, 0) > 0 && (request.revents & (POLLRDHUP | POLLHUP | POLLERR)) != 0;
}

void LineServer::begin(Descriptor descriptor, const std::string& client) {
  output_.clear();
  has_lost_ = false;
  client_ = client;
  ByteStreamOwner& owner = *this;
  stream_ = std::make_unique<ByteStream>(context_, std::move(descriptor), false, owner);
  functions_.event(client_ + " is connected to the line");
}

void LineServer::send(std::string_view bytes) {
  if (!stream_) {
    return;
  }
  if (output_.size() + bytes.size() > max_output) {
    if (!std::exchange(has_lost_, true)) {
      functions_.event(client_ + " reads too slowly: bytes of the line are lost");
    }
    return;
  }
  output_ += bytes;
  stream_->flush();
}

void LineServer::resume() {
  if (stream_) {
    stream_->resume();
  }
}

std::string LineServer::take_output(std::size_t max_bytes) {
  std::string taken = output_.substr(0, max_bytes);
  output_.erase(0, taken.size());
  return taken;
}

void LineServer::ended(int /*error*/) {
  stream_.reset();
  functions_.event(client_ + " has gone from the line");
  if (terminal_) {
    terminal_->client_gone();
  }
}

}  // namespace proleg::host
