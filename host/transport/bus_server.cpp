#include "host/transport/bus_server.hpp"

#include <boost/system/system_error.hpp>
#include <utility>

#include "host/transport/transport.hpp"

namespace proleg::host {
namespace {

constexpr std::size_t max_clients = 32;

void add(BusServer::Totals& totals, const SlcanAdapter::Counters& counters) {
  totals.frames_from_clients += counters.frames_sent;
  totals.frames_refused += counters.frames_refused;
  totals.frames_dropped += counters.frames_dropped + counters.state_frames_dropped;
}

}  // namespace

BusServer::BusServer(boost::asio::io_context& context, BusServerListener& listener,
                     const SlcanAdapter::Settings& settings)
    : context_(context), listener_(listener), settings_(settings) {}

std::string BusServer::add_pseudo_terminal() {
  const std::size_t index = terminals_.size();
  terminals_.push_back(std::make_unique<PseudoTerminal>(context_, [this, index](Descriptor descriptor) {
    add_session(std::move(descriptor), terminals_[index]->name(), [this, index] { terminals_[index]->client_gone(); });
  }));
  return terminals_.back()->name();
}

std::uint16_t BusServer::add_tcp(const std::string& host, std::uint16_t port) {
  tcp_listeners_.push_back(
      std::make_unique<TcpListener>(context_, host, port, [this](Descriptor descriptor, const std::string& address) {
        if (clients_.size() >= max_clients) {
          listener_.client_event("tcp client " + address + " is refused: there are " + std::to_string(max_clients));
          return;
        }
        add_session(std::move(descriptor), "tcp client " + address, [] {});
      }));
  return tcp_listeners_.back()->port();
}

void BusServer::add_descriptor(int descriptor) {
  const std::string name = "fd:" + std::to_string(descriptor);
  Descriptor owned(descriptor);
  if (!make_private(owned)) {
    static_cast<void>(owned.release());
    throw TransportError(name + ": this process has not inherited such a descriptor");
  }
  try {
    add_session(std::move(owned), name, [this] { listener_.descriptor_closed(); });
  } catch (const boost::system::system_error& error) {
    throw TransportError(name + ": it is no socket, pipe or line: " + system_text(error.code().value()));
  }
}

void BusServer::add_can(const std::string& interface) {
  const BusClient client = ++last_client_;
  CanNode::Functions functions;
  functions.received = [this, client](const CanFrame& frame) {
    ++past_.frames_from_clients;
    past_.frames_refused += listener_.frame_from_client(client, frame) ? 0U : 1U;
  };
  functions.changed = [this, interface](const std::string& failure) {
    listener_.client_event(failure.empty() ? interface + ": the interface is back" : failure);
  };
  can_nodes_[client] = std::make_unique<CanNode>(context_, interface, std::move(functions));
}

void BusServer::add_session(Descriptor descriptor, const std::string& name, std::function<void()> ended) {
  const BusClient client = ++last_client_;
  SlcanSession::Functions functions;
  functions.send = [this, client](const CanFrame& frame) { return listener_.frame_from_client(client, frame); };
  functions.ended = [this, client, ended = std::move(ended)](int /*error*/) {
    end_session(client);
    ended();
  };
  auto session = std::make_unique<SlcanSession>(context_, std::move(descriptor), settings_, std::move(functions));
  session->status_changed(status_);
  clients_[client] = {name, std::move(session)};
  listener_.client_event(name + ": client " + std::to_string(client) + " is connected");
}

void BusServer::end_session(BusClient client) {
  const auto place = clients_.find(client);
  add(past_, place->second.session->counters());
  const std::string name = place->second.name;
  clients_.erase(place);
  listener_.client_event(name + ": client " + std::to_string(client) + " has gone");
}

void BusServer::broadcast(Microseconds time, const CanFrame& frame, BusClient except) {
  for (const auto& [client, entry] : clients_) {
    if (client != except) {
      entry.session->received(time, frame);
    }
  }
  for (const auto& [client, node] : can_nodes_) {
    if (client != except) {
      node->send(frame);
    }
  }
}

void BusServer::status_changed(const CanStatus& status) {
  status_ = status;
  for (const auto& [client, entry] : clients_) {
    entry.session->status_changed(status);
  }
}

void BusServer::errors_occurred(CanErrors errors) {
  for (const auto& [client, entry] : clients_) {
    entry.session->errors_occurred(errors);
  }
}

std::size_t BusServer::open_clients() const {
  std::size_t count = 0;
  for (const auto& [client, entry] : clients_) {
    count += entry.session->is_open() ? 1U : 0U;
  }
  return count;
}

BusServer::Totals BusServer::totals() const {
  Totals totals = past_;
  for (const auto& [client, entry] : clients_) {
    add(totals, entry.session->counters());
  }
  for (const auto& [client, node] : can_nodes_) {
    totals.frames_dropped += node->dropped();
  }
  return totals;
}

}  // namespace proleg::host
