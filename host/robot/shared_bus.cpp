#include "host/robot/shared_bus.hpp"

#include <algorithm>
#include <utility>

namespace proleg::host {

SharedBus::SharedBus(boost::asio::io_context& context, BusConnection& bus)
    : context_(context), bus_(bus), attachment_(bus, *this) {
  server_.emplace(context_, static_cast<BusServerListener&>(*this));
}

void SharedBus::add(Descriptor end) { server_->add_descriptor(end.release()); }

void SharedBus::look_at_connection(Microseconds longest_loss) {
  if (bus_.state().is_connected) {
    connected_at_ = bus_.now();
  } else if (programs() > 0 && bus_.now() - connected_at_ >= longest_loss) {
    server_.reset();
    server_.emplace(context_, static_cast<BusServerListener&>(*this));
    sent_.clear();
  }
}

void SharedBus::receive(Microseconds now, const CanFrame& frame) { server_->broadcast(now, frame); }

void SharedBus::transmitted(Microseconds now, const CanFrame& frame) {
  const auto sent = std::ranges::find(sent_, frame, &Sent::frame);
  if (sent == sent_.end()) {
    server_->broadcast(now, frame);  // of this program
    return;
  }
  const BusClient client = sent->client;
  sent_.erase(sent_.begin(), sent + 1);  // what was sent before was lost: the bus keeps the order
  server_->broadcast(now, frame, client);
}

bool SharedBus::frame_from_client(BusClient client, const CanFrame& frame) {
  sent_.push_back({frame, client});  // first, because the transport may confirm it at once
  if (!bus_.send(frame)) {
    sent_.pop_back();
    return false;
  }
  if (sent_.size() > max_sent) {
    sent_.pop_front();
  }
  return true;
}

}  // namespace proleg::host
