#include "host/server/control_lease.hpp"

#include <algorithm>

namespace proleg::host {

using nlohmann::json;

void ControlLease::take(ServerTime now, ClientId client, const std::string& name, std::uint64_t operation) {
  advance(now);
  if (is_held_by(client)) {
    finish(client, operation);
  } else if (request_) {
    // A second request of the same viewer does not prolong the time of the holder.
    finish(client, operation, request_->from.name + " has already asked " + holder_->name + " for control");
  } else if (!holder_ || is_away_) {
    begin_epoch(now, {client, name});
    finish(client, operation);
  } else {
    request_ = Request{{client, name}, operation, now + answer_timeout};
    ++revision_;
  }
}

void ControlLease::give(ServerTime now, ClientId client, const std::string& name) {
  advance(now);
  if (!holder_ || is_away_) {
    begin_epoch(now, {client, name});
  }
}

void ControlLease::answer(ServerTime now, ClientId client, std::uint64_t epoch, std::uint64_t operation,
                          bool is_granted) {
  advance(now);
  std::string error = refusal(client, epoch);
  if (error.empty() && !request_) {
    error = "nobody asks for control";
  }
  finish(client, operation, error);
  if (!error.empty()) {
    return;
  }
  if (is_granted) {
    vacate(now);
    return;
  }
  finish(request_->from.client, request_->operation, holder_->name + " keeps control");
  request_.reset();
  ++revision_;
}

void ControlLease::release(ServerTime now, ClientId client, std::uint64_t epoch, std::uint64_t operation) {
  advance(now);
  const std::string error = refusal(client, epoch);
  finish(client, operation, error);
  if (error.empty()) {
    vacate(now);
  }
}

void ControlLease::beat(ServerTime now, ClientId client, double age_ms) {
  advance(now);
  if (!is_held_by(client) || age_ms >= static_cast<double>(longest_pause.count())) {
    return;
  }
  last_sign_ = now;
  if (is_away_) {
    is_away_ = false;
    ++revision_;
  }
}

void ControlLease::leave(ServerTime now, ClientId client) {
  advance(now);
  if (request_ && request_->from.client == client) {
    request_.reset();
    ++revision_;
  }
  if (is_held_by(client)) {
    vacate(now);
  }
}

void ControlLease::advance(ServerTime now) {
  if (!holder_) {
    return;
  }
  if (!is_away_ && now >= last_sign_ + away_timeout) {
    is_away_ = true;
    ++revision_;
  }
  if (request_ && (is_away_ || now >= request_->deadline)) {
    vacate(now);
  }
}

ServerTime ControlLease::deadline() const {
  if (!holder_ || is_away_) {
    return no_deadline;
  }
  const ServerTime away = last_sign_ + away_timeout;
  return request_ ? std::min(away, request_->deadline) : away;
}

std::string ControlLease::refusal(ClientId client, std::uint64_t epoch) const {
  if (!holder_) {
    return "nobody has control: take it first";
  }
  if (holder_->client != client) {
    return "control is with " + holder_->name;
  }
  return epoch == epoch_ ? ""
                         : "found epoch " + std::to_string(epoch) + " of control, expected " + std::to_string(epoch_);
}

json ControlLease::document(ServerTime now) const {
  const auto party = [](const Party& who) { return json{{"client", who.client}, {"name", who.name}}; };
  json value{{"epoch", epoch_}, {"holder", nullptr}, {"away", is_away_}, {"request", nullptr}};
  if (holder_) {
    value["holder"] = party(*holder_);
  }
  if (request_) {
    value["request"] = party(request_->from);
    value["request"]["ms"] = std::max(request_->deadline - now, ServerTime(0)).count();
  }
  return value;
}

void ControlLease::finish(ClientId client, std::uint64_t operation, std::string error) {
  results_.push_back({client, operation, std::move(error)});
}

void ControlLease::vacate(ServerTime now) {
  holder_.reset();
  is_away_ = false;
  ++revision_;
  if (request_) {
    const Request request = *std::exchange(request_, std::nullopt);
    begin_epoch(now, request.from);
    finish(request.from.client, request.operation);
  }
}

void ControlLease::begin_epoch(ServerTime now, Party holder) {
  holder_ = std::move(holder);
  ++epoch_;
  is_away_ = false;
  last_sign_ = now;
  ++revision_;
}

}  // namespace proleg::host
