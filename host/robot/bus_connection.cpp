#include "host/robot/bus_connection.hpp"

#include <algorithm>

#include "shared/canopen/messages.hpp"

namespace proleg::host {
namespace {

/// The node that has sent a frame; 0 if the identifier does not say it.
std::uint8_t sender_of(const CanFrame& frame) {
  namespace identifier = canopen::identifier;
  return identifier::has_one_sender(frame.identifier) ? identifier::node_of(frame.identifier) : std::uint8_t{0};
}

}  // namespace

BusConnection::BusConnection(const Open& open) : transport_(open(*this)) {}

void BusConnection::attach(BusUser& user) { users_.push_back(&user); }

void BusConnection::detach(BusUser& user) {
  std::ranges::replace(users_, &user, nullptr);
  if (calls_ == 0) {
    std::erase(users_, nullptr);
  }
}

template <typename Call>
void BusConnection::for_each_user(Call&& call) {
  /// Counts a call as long as it lasts, also if a user throws.
  struct Calls {
    explicit Calls(BusConnection& connection) : bus(connection) { ++bus.calls_; }
    ~Calls() {
      if (--bus.calls_ == 0) {
        std::erase(bus.users_, nullptr);
      }
    }
    Calls(const Calls&) = delete;
    Calls& operator=(const Calls&) = delete;
    BusConnection& bus;
  };
  const Calls calls(*this);
  for (std::size_t i = 0; i < users_.size(); ++i) {
    if (users_[i] != nullptr) {
      call(*users_[i]);
    }
  }
}

bool BusConnection::send(const CanFrame& frame) {
  if (!transport_->send(frame)) {
    return false;
  }
  ++requested_;
  for_each_user([this, &frame](BusUser& user) { user.requested(now(), frame); });
  return true;
}

void BusConnection::received(Microseconds time, const CanFrame& frame) {
  heard_.set(sender_of(frame));
  for_each_user([&](BusUser& user) { user.receive(time, frame); });
}

void BusConnection::transmitted(Microseconds time, const CanFrame& frame) {
  for_each_user([&](BusUser& user) { user.transmitted(time, frame); });
}

/// After a time in which this program stood still, what was received meanwhile waits. The users get it before they look
/// at the time: else they would take the silence of this program for that of the modules.
void BusConnection::catch_up() {
  constexpr Microseconds standstill_us = 3 * longest_wait_us;
  constexpr unsigned most_reads = 100'000;  // a bus that is never silent must not keep the program here
  if (looked_at_ != never && now() > looked_at_ + standstill_us) {
    std::uint64_t before = 0;
    for (unsigned reads = 0; reads < most_reads && (reads == 0 || statistics().received != before); ++reads) {
      before = statistics().received;
      transport_->run_until(now());
    }
  }
  looked_at_ = now();
}

void BusConnection::poll_users() {
  for_each_user([this](BusUser& user) {
    if (const Microseconds time = now(); user.next_deadline() <= time) {
      user.poll(time);
    }
  });
}

Microseconds BusConnection::next_deadline() const {
  Microseconds next = never;
  for (const BusUser* user : users_) {
    if (user != nullptr) {
      next = std::min(next, user->next_deadline());
    }
  }
  return next;
}

bool BusConnection::run_until(Microseconds deadline, const std::function<bool()>& done) {
  for (;;) {
    catch_up();
    poll_users();
    if (done()) {
      return true;
    }
    const Microseconds time = now();
    if (time >= deadline) {
      return false;
    }
    transport_->run_until(std::min({deadline, next_deadline(), time + longest_wait_us}));
  }
}

std::string BusConnection::diagnosis() const {
  const BusState& bus = state();
  const Statistics numbers = statistics();
  if (!bus.is_connected) {
    return "the connection is lost: " + (bus.reason.empty() ? "no reason is known" : bus.reason);
  }
  if (numbers.received == 0 && numbers.malformed > 0) {
    return "no line of the adapter was understood: received " + numbers.malformed_line +
           ", expected slcan: a line such as t1230 (proleg doctor says what to do)";
  }
  if (requested_ > 0 && numbers.transmitted == 0 && numbers.received > 0) {
    return "the adapter has confirmed no frame, but " + std::to_string(numbers.received) +
           " frames were received: its line loses bytes, or it only listens; what was sent may have arrived: try again";
  }
  if (requested_ > 0 && numbers.transmitted == 0) {
    return "no frame was acknowledged: no other node is on the bus, or it has another bit rate than 1 Mbit/s, or the "
           "cable or a terminator is missing";
  }
  if (!bus.reason.empty()) {
    return bus.reason;
  }
  if (numbers.received == 0) {
    return "no frame was received: is the robot switched on, and is it this bus?";
  }
  std::string nodes;
  for (unsigned node = canopen::min_node_id; node <= canopen::max_node_id; ++node) {
    if (heard_.test(node)) {
      nodes += (nodes.empty() ? "" : ", ") + std::to_string(node);
    }
  }
  return std::to_string(numbers.received) + " frames were received" +
         (nodes.empty() ? ", none of them from a node" : ", from the nodes " + nodes) +
         (numbers.malformed == 0
              ? ""
              : "; " + std::to_string(numbers.malformed) +
                    " lines of the adapter were not understood, the last one was " + numbers.malformed_line);
}

}  // namespace proleg::host
