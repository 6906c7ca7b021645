#pragma once

// A CAN bus in memory with modules and a host. Every frame takes the same time, and the lowest identifier goes first.
// All other nodes receive a frame at the instant at which its sender is notified that it was sent.

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "module_node.hpp"
#include "tests/support/number_transfer.hpp"

namespace proleg::test {

class TestBus {
 public:
  static constexpr Microseconds frame_time_us = 130;
  static constexpr std::size_t host = ~std::size_t{0};

  struct Sent {
    Microseconds time;
    std::size_t sender;  ///< position of the module, or `host`
    CanFrame frame;
  };

  ModuleNode& add(const firmware::ModuleIdentity& identity, Microseconds clock_offset = 0) {
    nodes.push_back(std::make_unique<ModuleNode>(identity, clock_offset));
    return *nodes.back();
  }

  [[nodiscard]] Microseconds now() const { return now_; }
  void send(const CanFrame& frame) { host_queue_.push_back(frame); }

  void run_until(Microseconds end) {
    arbitrate();
    for (Microseconds time = next_event(); time <= end; time = next_event()) {
      ASSERT_LE(++events_, 10'000'000U) << "time stands still";
      now_ = std::max(now_, time);
      finish_frame();
      beat();
      for (const auto& node : nodes) {
        if (node->next_deadline() <= now_) {
          node->poll(now_);
          EXPECT_GT(node->next_deadline(), now_);
        }
      }
      arbitrate();
    }
    now_ = end;
  }
  void run_for(Microseconds time) { run_until(now_ + time); }
  /// Runs until a frame that `wanted` accepts was sent; false after `longest`.
  bool run_until_sent(const std::function<bool(const CanFrame&)>& wanted, Microseconds longest = 1'000'000) {
    const Microseconds end = now_ + longest;
    std::size_t seen = log.size();
    for (arbitrate(); next_event() <= end;) {
      run_until(next_event());
      for (; seen < log.size(); ++seen) {
        if (wanted(log[seen].frame)) {
          return true;
        }
      }
    }
    run_until(end);
    return false;
  }
  /// Sends a frame of the host, until the modules have received it and handled it.
  void deliver(const CanFrame& frame) {
    send(frame);
    run_until_sent([&](const CanFrame& sent) { return sent == frame; });
  }

  // SDO transfers as a host makes them.
  canopen::AbortCode write(std::uint8_t node, canopen::Address address, std::uint8_t size, std::uint32_t value) {
    return transfer(client_.write(now_, node, address, size, value));
  }
  canopen::AbortCode write(std::uint8_t node, const canopen::Object& entry, std::uint32_t value) {
    return write(node, entry.address, canopen::size_of(entry.type), value);
  }
  canopen::AbortCode read(std::uint8_t node, canopen::Address address, std::uint32_t& value) {
    const canopen::AbortCode code = transfer(client_.read(now_, node, address));
    value = client_.value();
    return code;
  }
  /// Reads a value that must exist.
  std::uint32_t value(std::uint8_t node, canopen::Address address) {
    std::uint32_t value = 0;
    EXPECT_EQ(read(node, address, value), canopen::AbortCode::none)
        << std::hex << address.index << ':' << int{address.sub};
    return value;
  }
  std::uint32_t value(std::uint8_t node, const canopen::Object& entry) { return value(node, entry.address); }

  /// Reads a value of a long type.
  canopen::AbortCode read_text(std::uint8_t node, canopen::Address address, std::string& text,
                               const canopen::SdoTransferOptions& options = {}) {
    std::array<std::uint8_t, 100> buffer{};
    canopen::SdoTransfer& transfer = transfer_;
    transfer.upload(node, address, buffer, options);
    do {
      while (const std::optional<CanFrame> frame = transfer.next_frame(now_)) {
        send(*frame);
      }
      run_for(frame_time_us);
      transfer.poll(now_);
    } while (transfer.state() == canopen::SdoTransfer::State::running || !host_queue_.empty());
    text.assign(buffer.begin(), buffer.begin() + transfer.size());
    return transfer.state() == canopen::SdoTransfer::State::done ? canopen::AbortCode::none : transfer.abort_code();
  }

  // Frames that were sent.
  [[nodiscard]] std::vector<Sent> sent(std::uint16_t identifier, std::size_t from = 0) const {
    std::vector<Sent> found;
    std::copy_if(log.begin() + static_cast<std::ptrdiff_t>(from), log.end(), std::back_inserter(found),
                 [&](const Sent& entry) { return entry.frame.identifier == identifier; });
    return found;
  }
  [[nodiscard]] std::vector<canopen::Emergency> emergencies(std::uint8_t node, std::size_t from = 0) const {
    std::vector<canopen::Emergency> found;
    for (const Sent& entry : sent(static_cast<std::uint16_t>(canopen::identifier::emergency + node), from)) {
      const auto emergency = canopen::decode_emergency(entry.frame);
      EXPECT_TRUE(emergency);
      found.push_back(*emergency);
    }
    return found;
  }

  std::vector<std::unique_ptr<ModuleNode>> nodes;
  /// Whether the host sends its heartbeat.
  bool host_is_alive = true;
  std::vector<Sent> log;
  /// Called with every frame that was sent, before a node receives it.
  std::function<void(const CanFrame&)> on_frame = [](const CanFrame&) {};
  /// Whether a module does not receive a frame.
  std::function<bool(const CanFrame&, std::size_t)> loses = [](const CanFrame&, std::size_t) { return false; };

 private:
  [[nodiscard]] Microseconds next_event() const {
    Microseconds next = std::min(frame_end_, host_is_alive ? next_beat_ : never);
    for (const auto& node : nodes) {
      next = std::min(next, node->next_deadline());
    }
    return next;
  }

  void arbitrate() {
    if (frame_end_ != never) {
      return;
    }
    std::vector<CanFrame>* winner = nullptr;
    std::size_t position = 0;
    const auto ask = [&](std::vector<CanFrame>& queue, std::size_t sender) {
      for (std::size_t i = 0; i < queue.size(); ++i) {
        if (winner == nullptr || queue[i].identifier < (*winner)[position].identifier) {
          winner = &queue;
          position = i;
          sender_ = sender;
        }
      }
    };
    ask(host_queue_, host);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      ask(nodes[i]->pending, i);
    }
    if (winner != nullptr) {
      on_wire_ = (*winner)[position];
      queue_ = winner;
      frame_end_ = now_ + frame_time_us;
    }
  }

  void finish_frame() {
    if (frame_end_ > now_) {
      return;
    }
    frame_end_ = never;
    const CanFrame frame = on_wire_;
    const std::size_t sender = sender_;
    const auto sent = std::find(queue_->begin(), queue_->end(), frame);
    if (sent == queue_->end()) {
      return;  // its sender went bus-off: no node receives it
    }
    queue_->erase(sent);
    on_frame(frame);
    log.push_back({now_, sender, frame});
    if (sender != host) {
      client_.receive(frame);
      transfer_.receive(now_, frame);
      nodes[sender]->transmitted(now_, frame);
    }
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      if (i != sender && !loses(frame, i)) {
        nodes[i]->receive(now_, frame);
      }
    }
  }

  canopen::AbortCode transfer(const CanFrame& request) {
    send(request);
    const Microseconds end = now_ + 2 * NumberTransfer::default_timeout_us;
    while (client_.state() == NumberTransfer::State::running && now_ < end) {
      run_for(frame_time_us);
      client_.poll(now_);
    }
    return client_.state() == NumberTransfer::State::done ? canopen::AbortCode::none : client_.abort_code();
  }

  /// The heartbeat of the host takes no time on this bus, and is in no log.
  void beat() {
    constexpr Microseconds period = 200'000;
    if (now_ < next_beat_) {
      return;
    }
    next_beat_ = now_ + period;
    if (host_is_alive) {
      for (const auto& node : nodes) {
        node->receive(now_, encode(canopen::Heartbeat{canopen::host_node, canopen::NmtState::operational}));
      }
    }
  }

  Microseconds now_ = 0;
  Microseconds next_beat_ = 0;
  std::vector<CanFrame> host_queue_;
  CanFrame on_wire_;
  std::vector<CanFrame>* queue_ = nullptr;
  std::size_t sender_ = host;
  Microseconds frame_end_ = never;
  NumberTransfer client_;
  canopen::SdoTransfer transfer_;
  std::uint64_t events_ = 0;
};

}  // namespace proleg::test
