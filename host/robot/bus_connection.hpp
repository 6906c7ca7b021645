#pragma once

// A bus that the state machines of a host program share. It passes frames and times to them, in one thread.

#include <array>
#include <bitset>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "host/robot/bus_user.hpp"
#include "host/transport/transport.hpp"

namespace proleg::host {

class BusConnection final : public CanPort, private TransportListener {
 public:
  /// Opens a transport that reports to the given listener. Throws TransportError.
  using Open = std::function<std::unique_ptr<Transport>(TransportListener& listener)>;
  /// Longest time after which signals of the operating system are noticed.
  static constexpr Microseconds longest_wait_us = 20'000;

  explicit BusConnection(const Open& open);
  BusConnection(const BusConnection&) = delete;
  BusConnection& operator=(const BusConnection&) = delete;

  /// Sends a frame of any user.
  [[nodiscard]] bool send(const CanFrame& frame) override;

  [[nodiscard]] Microseconds now() const { return transport_->now(); }
  /// Lets time pass until `done` returns true, at most until the deadline. Returns whether it is done.
  bool run_until(Microseconds deadline, const std::function<bool()>& done);
  /// Lets time pass for a duration.
  void run_for(Microseconds duration) {
    run_until(now() + duration, [] { return false; });
  }

  [[nodiscard]] const BusState& state() const { return transport_->state(); }
  [[nodiscard]] Statistics statistics() const { return transport_->statistics(); }
  [[nodiscard]] std::string description() const { return transport_->description(); }

  /// Nodes that have sent a frame of their own (heartbeat, EMCY, SDO answer, state frame, monitoring).
  [[nodiscard]] const std::bitset<128>& heard() const { return heard_; }
  /// What is known about the bus and what to check: one line, in lower case, to follow the message of a timeout.
  [[nodiscard]] std::string diagnosis() const;

 private:
  friend class BusAttachment;

  void attach(BusUser& user);
  void detach(BusUser& user);
  void received(Microseconds time, const CanFrame& frame) override;
  void transmitted(Microseconds time, const CanFrame& frame) override;
  void catch_up();
  void poll_users();
  [[nodiscard]] Microseconds next_deadline() const;
  template <typename Call>
  void for_each_user(Call&& call);

  std::vector<BusUser*> users_;  ///< null: a user that was detached while users are called
  unsigned calls_ = 0;           ///< number of nested calls of for_each_user()
  std::bitset<128> heard_;
  std::uint64_t requested_ = 0;     ///< number of frames that the transport took
  Microseconds looked_at_ = never;  ///< time of the last look at the bus
  std::unique_ptr<Transport> transport_;
};

/// While this object exists, the bus hands frames and times to a user; those attached first get them first. A user may
/// attach and detach others while it is called.
class BusAttachment {
 public:
  /// bus, user: must outlive this.
  BusAttachment(BusConnection& bus, BusUser& user) : bus_(bus), user_(user) { bus_.attach(user_); }
  ~BusAttachment() { bus_.detach(user_); }
  BusAttachment(const BusAttachment&) = delete;
  BusAttachment& operator=(const BusAttachment&) = delete;

 private:
  BusConnection& bus_;
  BusUser& user_;
};

}  // namespace proleg::host
