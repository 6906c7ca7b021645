#pragma once

// An SDO client and a server on a simulated bus that can lose frames.

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "device_memory.hpp"
#include "shared/computer/master/sdo_transfer.hpp"
#include "sim/bus/bus.hpp"

namespace proleg::test {

using Bytes = std::vector<std::uint8_t>;

inline constexpr canopen::Address domain{0x1F50, 1};

inline Bytes random_bytes(std::size_t size, std::uint32_t seed = 1) {
  std::mt19937 random(seed);
  Bytes bytes(size);
  for (std::uint8_t& byte : bytes) {
    byte = static_cast<std::uint8_t>(random());
  }
  return bytes;
}

/// A client and a server, each with a controller, and the frames between them.
class SdoLink {
 public:
  static constexpr std::uint8_t node = 9;

  SdoLink() {
    device.add_entry(domain, canopen::DataType::domain, 0, 0xFFFFFFFF);
    bus.set_loss_rule([this](const CanFrame& sent, std::size_t receiver) {
      sends.push_back(sent);
      return receiver < 2 && loses && loses(sent, sends.size() - 1);
    });
  }

  void run(Microseconds longest = 3'600'000'000) {
    const sim::BusTime end = bus.now() + longest * 1'000;
    pump();
    while (client.state() == canopen::SdoTransfer::State::running || server.next_deadline() != never || !is_quiet()) {
      const sim::BusTime next = std::min({bus.next_event(), at(client.next_deadline()), at(server.next_deadline())});
      ASSERT_LE(next, end) << "the transfer does not end";
      bus.advance_to(next);
      if (client.next_deadline() <= now()) {
        client.poll(now());
      }
      if (const std::optional<CanFrame> sent = server.poll(now())) {
        answers.push_back(*sent);
      }
      pump();
      if (client.state() != canopen::SdoTransfer::State::running && finished_at == 0) {
        finished_at = bus.now();
      }
    }
  }
  /// Uploads a value of `bytes` bytes, and checks the result.
  void download(const Bytes& bytes, const canopen::SdoTransferOptions& options = {}) {
    begin();
    client.download(node, domain, bytes, options);
    run();
  }
  Bytes upload(std::size_t capacity, const canopen::SdoTransferOptions& options = {}) {
    begin();
    Bytes buffer(capacity);
    client.upload(node, domain, buffer, options);
    run();
    buffer.resize(client.state() == canopen::SdoTransfer::State::done ? client.size() : 0);
    return buffer;
  }
  Bytes& value() { return device.long_values[DeviceMemory::key(domain)]; }
  [[nodiscard]] double seconds() const { return static_cast<double>(finished_at - started_at) * 1e-9; }

  sim::Bus bus;
  DeviceMemory device;
  canopen::SdoServer server{node, device};
  canopen::SdoTransfer client;
  std::vector<CanFrame> sends;  ///< frames that were sent, in order
  std::function<bool(const CanFrame& sent, std::size_t position)> loses;
  /// Makes the answer in place of the server, if it returns a frame.
  std::function<std::optional<CanFrame>(const CanFrame& request)> answers_instead;

 private:
  struct Node final : sim::BusListener {
    explicit Node(std::function<void(const CanFrame&)> handler) : on_frame(std::move(handler)) {}
    void received(sim::BusTime /*time*/, const CanFrame& frame) override { on_frame(frame); }
    void transmitted(sim::BusTime /*time*/, const CanFrame& /*frame*/) override {}
    std::function<void(const CanFrame&)> on_frame;
  };

  void begin() {
    sends.clear();
    started_at = bus.now();
    finished_at = 0;
  }
  [[nodiscard]] Microseconds now() const { return bus.now() / 1'000; }
  static sim::BusTime at(Microseconds time) { return time == never ? sim::never_on_bus : time * 1'000; }
  /// Whether the program sends a frame. Like a program that keeps the bus busy, it has two frames at the controller.
  static bool has_room(const sim::Controller& controller) { return controller.free_mailboxes() > 1; }
  [[nodiscard]] bool is_quiet() const {
    return client_controller.free_mailboxes() == 3 && server_controller.free_mailboxes() == 3;
  }
  void pump() {
    while (has_room(client_controller)) {
      const std::optional<CanFrame> sent = client.next_frame(now());
      if (!sent) {
        break;
      }
      ASSERT_TRUE(client_controller.send(*sent));
    }
    while (has_room(server_controller) && (!answers.empty() || server.has_segment())) {
      if (answers.empty()) {
        ASSERT_TRUE(server_controller.send(server.next_segment(now())));
      } else {
        ASSERT_TRUE(server_controller.send(answers.front()));
        answers.erase(answers.begin());
      }
    }
  }

 public:
  std::vector<CanFrame> answers;
  sim::BusTime started_at = 0;
  sim::BusTime finished_at = 0;

 private:
  Node client_node{[this](const CanFrame& frame) { client.receive(now(), frame); }};
  Node server_node{[this](const CanFrame& frame) {
    std::optional<CanFrame> answer;
    if (answers_instead) {
      answer = answers_instead(frame);
    }
    answer = answer ? answer : server.receive(now(), frame);
    if (answer) {
      answers.push_back(*answer);
    }
  }};
  sim::Controller& client_controller = bus.attach(client_node);
  sim::Controller& server_controller = bus.attach(server_node);
};

}  // namespace proleg::test
