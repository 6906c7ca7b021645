#pragma once

// Modules in their bootloaders on the simulated bus, and a host.

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <vector>

#include "firmware/bootloader/bootloader.hpp"
#include "shared/broadcast/image_sender.hpp"
#include "shared/computer/master/lss_master.hpp"
#include "shared/computer/master/sdo_transfer.hpp"
#include "sim/bus/bus.hpp"
#include "updated_module.hpp"

namespace proleg::bootloader::test {

using broadcast::ImageSender;
using broadcast::ReceiverState;
using sim::BusTime;

inline constexpr BusTime us = 1'000;
inline constexpr std::uint32_t seed = 5;

/// A module in its bootloader.
class Node final : sim::BusListener, canopen::LssStorage {
 public:
  Node(sim::Bus& bus, std::uint32_t its_serial, std::uint8_t node)
      : serial(its_serial), controller_(bus.attach(*this)) {
    stored_node = node;
    restart(0);
  }

  /// Does what a reset of the chip does.
  void restart(Microseconds now, const Handover& left = {}) {
    bootloader = std::make_unique<Bootloader>(place, serial, Ports{controller_, module.flash, *this, buffer});
    bootloader->power_on(now, stored_node, left);
  }

  const std::uint32_t serial;
  UpdatedModule module;
  std::unique_ptr<Bootloader> bootloader;
  std::uint8_t stored_node = 0;
  /// RAM that keeps its contents over a restart.
  std::vector<std::uint8_t> buffer = std::vector<std::uint8_t>(image::header_size + place.room);

 private:
  void received(BusTime time, const CanFrame& frame) override { bootloader->receive(time / us, frame); }
  void transmitted(BusTime time, const CanFrame& frame) override { bootloader->transmitted(time / us, frame); }
  Result store_node(std::uint8_t node) override {
    stored_node = node;
    return {};
  }

  sim::Controller& controller_;
};

class BootloaderTest : public testing::Test, protected sim::BusListener {
 protected:
  BootloaderTest() : controller(bus.attach(*this)) {}

  Node& add(std::uint8_t node) {
    const auto serial = static_cast<std::uint32_t>(random_());
    nodes.push_back(std::make_unique<Node>(bus, serial, node));
    targets.push_back({serial, {}, false});
    return *nodes.back();
  }

  /// Runs until `done`, or for a minute. `host` is called meanwhile.
  template <typename Done, typename Host>
  void run_until(Done done, Host host) {
    const BusTime end = bus.now() + 60'000'000 * us;
    while (!done()) {
      Microseconds deadline = host.next_deadline();
      for (const auto& node : nodes) {
        deadline = std::min(deadline, node->bootloader->next_deadline());
      }
      const BusTime next = std::max(bus.now(), std::min(bus.next_event(), deadline == never ? end : deadline * us));
      ASSERT_LT(next, end) << "a wait without an end";
      bus.advance_to(next);
      host.poll(now());
      for (const auto& node : nodes) {
        if (node->bootloader->next_deadline() <= now()) {
          node->bootloader->poll(now());
        }
      }
    }
  }
  struct NoHost {
    Microseconds end;
    [[nodiscard]] Microseconds next_deadline() const { return end; }
    void poll(Microseconds) {}
  };
  void run_for(Microseconds time) {
    const Microseconds end = now() + time;
    run_until([&] { return now() >= end; }, NoHost{end});
  }
  [[nodiscard]] Microseconds now() const { return bus.now() / us; }

  /// Sends the bytes to all nodes and lets them install.
  void flash(std::span<const std::uint8_t> bytes) {
    sender = std::make_unique<ImageSender>(controller, bytes, targets, broadcast::SenderOptions{});
    struct Host {
      ImageSender& sender;
      [[nodiscard]] Microseconds next_deadline() const { return sender.next_deadline(); }
      void poll(Microseconds time) { sender.poll(time); }
    };
    sender->start(now());
    run_until([&] { return sender->state() > ImageSender::State::sending; }, Host{*sender});
    ASSERT_EQ(sender->state(), ImageSender::State::complete);
    sender->install(now());
    run_until([&] { return sender->state() == ImageSender::State::done; }, Host{*sender});
  }

  /// A transfer of a tool that knows only CiA 301 and 302.
  canopen::AbortCode transfer(canopen::SdoTransfer& client) {
    transfer_ = &client;
    struct Host {
      canopen::SdoTransfer& client;
      [[nodiscard]] Microseconds next_deadline() const { return client.next_deadline(); }
      void poll(Microseconds time) { client.poll(time); }
    };
    pump();
    run_until(
        [&] {
          pump();
          return client.state() != canopen::SdoTransfer::State::running;
        },
        Host{client});
    transfer_ = nullptr;
    return client.state() == canopen::SdoTransfer::State::done ? canopen::AbortCode::none : client.abort_code();
  }
  canopen::AbortCode download(canopen::Address address, std::span<const std::uint8_t> bytes) {
    canopen::SdoTransfer client;
    client.download(tool_node, address, bytes);
    return transfer(client);
  }
  std::uint32_t upload(const canopen::Object& object) {
    std::array<std::uint8_t, 4> bytes{};
    canopen::SdoTransfer client;
    client.upload(tool_node, object.address, bytes);
    EXPECT_EQ(transfer(client), canopen::AbortCode::none);
    return read_little_endian(bytes, 0, 4);
  }

  /// The last answer to a request.
  template <typename Decode>
  auto ask(const CanFrame& request, Decode decode) {
    heard.clear();
    EXPECT_TRUE(controller.send(request));
    run_for(100'000);
    decltype(decode(CanFrame{})) answer;
    for (const CanFrame& frame : heard) {
      answer = decode(frame) ? decode(frame) : answer;
    }
    EXPECT_TRUE(answer.has_value());
    return answer.value();
  }
  broadcast::StatusAnswer ask_status(const Node& node) {
    return ask(broadcast::status_frame(node.serial), [&](const CanFrame& frame) {
      return broadcast::decode_status(frame, broadcast::Code::status, node.serial);
    });
  }
  std::uint32_t ask_header_word(const Node& node, std::uint8_t word) {
    const auto answer = ask(broadcast::header_frame(node.serial, word),
                            [&](const CanFrame& frame) { return broadcast::decode_header_word(frame, node.serial); });
    EXPECT_EQ(answer.number, word);
    return answer.value;
  }

  static constexpr std::uint8_t tool_node = 9;

  sim::Bus bus;
  sim::Controller& controller;
  std::vector<std::unique_ptr<Node>> nodes;
  std::vector<broadcast::Target> targets;
  std::unique_ptr<ImageSender> sender;
  canopen::LssMaster* lss = nullptr;
  std::vector<CanFrame> heard;

 private:
  void pump() {
    while (transfer_ != nullptr) {
      unsent_ = unsent_ ? unsent_ : transfer_->next_frame(now());
      if (!unsent_ || !controller.send(*unsent_)) {
        return;
      }
      unsent_.reset();
    }
  }
  void received(BusTime time, const CanFrame& frame) override {
    heard.push_back(frame);
    if (sender) {
      sender->receive(time / us, frame);
    }
    if (transfer_ != nullptr) {
      transfer_->receive(time / us, frame);
    }
    if (lss != nullptr) {
      lss->receive(time / us, frame);
    }
  }
  void transmitted(BusTime time, const CanFrame& frame) override {
    if (sender) {
      sender->transmitted(time / us);
    }
    if (lss != nullptr) {
      lss->transmitted(time / us, frame);
    }
  }

  std::mt19937 random_{seed};
  canopen::SdoTransfer* transfer_ = nullptr;
  std::optional<CanFrame> unsent_;
};

}  // namespace proleg::bootloader::test
