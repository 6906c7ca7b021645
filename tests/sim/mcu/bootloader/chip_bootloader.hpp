#pragma once

// A virtual chip with the bootloader, and hosts that flash it.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <random>

#include "firmware/bootloader/slots.hpp"
#include "firmware/module/module_identity.hpp"
#include "host/flash/image_file.hpp"
#include "shared/broadcast/image_sender.hpp"
#include "shared/fixed/little_endian.hpp"
#include "tests/sim/mcu/chip/chip_rig.hpp"

namespace proleg::sim {

using broadcast::ImageSender;
using broadcast::ReceiverState;

inline constexpr BusTime s = 1'000 * ms;
inline constexpr std::uint32_t slot_a = 0x0802'0000;  // docs/board.md
inline constexpr std::uint32_t slot_b = 0x0808'0000;
inline constexpr std::uint32_t slot_size = 128 * 1024;

/// A controller of its own, beside the one that the rig has for frames made by hand.
class FlashingHost final : BusListener {
 public:
  FlashingHost(ChipRig& rig, std::span<const std::uint8_t> image, std::uint32_t serial)
      : rig_(rig), controller_(rig.bus.attach(*this)), image_(image) {
    target_[0].serial = serial;
  }
  FlashingHost(const FlashingHost&) = delete;
  FlashingHost& operator=(const FlashingHost&) = delete;

  /// The state of the module at the end.
  ReceiverState flash() {
    transfer();
    return finish();
  }
  /// To be called again and again.
  [[nodiscard]] bool is_installed() {
    if (sender_.next_deadline() <= now()) {
      sender_.poll(now());
    }
    return target_[0].status.state == ReceiverState::installed;
  }
  ReceiverState finish() {
    wait_for(ImageSender::State::done);
    return target_[0].status.state;
  }
  /// Until the module begins to install.
  void transfer() {
    sender_.start(now());
    wait_for(ImageSender::State::complete);
    sender_.install(now());
  }

 private:
  static constexpr std::uint8_t session = 1;

  [[nodiscard]] Microseconds now() const { return rig_.bus.now() / us; }
  void wait_for(ImageSender::State state) {
    EXPECT_TRUE(rig_.run_until_true(
        [&] {
          if (sender_.next_deadline() <= now()) {
            sender_.poll(now());
          }
          return sender_.state() == state;
        },
        30 * s));
  }
  void received(BusTime time, const CanFrame& frame) override { sender_.receive(time / us, frame); }
  void transmitted(BusTime time, const CanFrame& /*frame*/) override { sender_.transmitted(time / us); }

  ChipRig& rig_;
  Controller& controller_;
  std::span<const std::uint8_t> image_;
  std::array<broadcast::Target, 1> target_{};
  ImageSender sender_{controller_, image_, target_, {.session = session}};
};

/// The image of a module, as the build makes it.
inline const std::vector<std::uint8_t>& program() {
  static const std::vector<std::uint8_t> bytes =
      host::read_image(std::filesystem::path(PROLEG_STM32F405_BIN) / "proleg_stm32f405.pimg").bytes;
  return bytes;
}

/// An image of the program that another version of it would be; `change` changes its body.
template <typename Change>
std::vector<std::uint8_t> other_program(Change change) {
  image::Header header = image::decode(program()).header;
  std::vector<std::uint8_t> body(program().begin() + image::header_size, program().end());
  change(header, body);
  image::describe_body(header, body);
  const image::HeaderBytes header_bytes = image::encode(header);
  body.insert(body.begin(), header_bytes.begin(), header_bytes.end());
  return body;
}
inline std::vector<std::uint8_t> newer_program() {
  return other_program([](image::Header& header, std::vector<std::uint8_t>& /*body*/) { ++header.version.minor; });
}
/// Its first instruction is replaced.
inline std::vector<std::uint8_t> program_that_starts_with(std::uint16_t instruction) {
  return other_program([instruction](const image::Header& header, std::vector<std::uint8_t>& body) {
    const std::uint32_t entry = (read_little_endian(body, 4, 4) & ~1U) - header.address;
    write_little_endian(body, entry, 2, instruction);
  });
}

class ChipBootloader : public testing::Test {
 protected:
  static constexpr std::uint16_t heartbeat = 0x700 + ChipRig::node;
  const std::uint32_t serial = firmware::serial_number({.unique_id = RigSettings().chip.unique_id});

  ChipBootloader() { make_chip(); }

  void make_chip(std::optional<firmware::BoardRecord> record = firmware::BoardRecord{ChipRig::node, false, 0, 0}) {
    RigSettings settings;
    settings.image = "proleg_boot_stm32f405";
    settings.record = std::move(record);
    settings.chip.brown_out_level = 0;
    settings.max_lead = 200 * us;
    rig = std::make_unique<ChipRig>(settings);
    hosts_.clear();
  }
  [[nodiscard]] bool sends_boot_up(BusTime timeout = 100 * ms) {
    const BusTime start = rig->bus.now();
    return rig->run_until_true(
        [&] {
          return std::ranges::any_of(rig->frames(heartbeat, start),
                                     [](const LoggedFrame& logged) { return logged.frame.data[0] == 0; });
        },
        timeout);
  }
  void start_bootloader() {
    rig->power_on();
    ASSERT_TRUE(sends_boot_up());
    ASSERT_FALSE(is_program());
  }
  /// Both send a boot-up. Only the program has a device profile (CiA 402).
  [[nodiscard]] bool is_program() {
    rig->run_for(20 * ms);
    return (rig->read(0x1000, 0) & 0xFFFFU) == 402;
  }
  [[nodiscard]] bool starts_program(BusTime timeout = 500 * ms) { return sends_boot_up(timeout) && is_program(); }

  /// As a programmer does it.
  void write_slot(std::uint32_t address, std::span<const std::uint8_t> image, bool is_confirmed) {
    rig->chip.write(address, image);
    if (is_confirmed) {
      std::array<std::uint8_t, 4> confirmed{};
      write_little_endian(confirmed, 0, 4, bootloader::Slots::confirmed_word);
      rig->chip.write(address + slot_size - bootloader::Slots::words_size, confirmed);
    }
  }
  [[nodiscard]] bool holds(std::uint32_t slot, const std::vector<std::uint8_t>& image) const {
    return rig->memory(slot, image.size()) == image;
  }
  /// It stays on the bus as long as the chip.
  FlashingHost& host_with(std::span<const std::uint8_t> image) {
    hosts_.push_back(std::make_unique<FlashingHost>(*rig, image, serial));
    return *hosts_.back();
  }
  ReceiverState flash(std::span<const std::uint8_t> image) { return host_with(image).flash(); }
  void start_program() {
    rig->power_on();
    ASSERT_TRUE(starts_program());
  }
  /// From a program that runs.
  void enter_bootloader() {
    start_program();
    rig->host.send(broadcast::enter_frame(serial));
    ASSERT_TRUE(sends_boot_up());
    ASSERT_FALSE(is_program());
  }
  /// What program or bootloader say of themselves.
  [[nodiscard]] std::uint8_t flags() {
    const BusTime start = rig->bus.now();
    rig->host.send(broadcast::status_frame(serial));
    rig->run_for(20 * ms);
    for (const LoggedFrame& logged : rig->frames(broadcast::module_identifier, start)) {
      if (const auto status = broadcast::decode_status(logged.frame, broadcast::Code::status, serial)) {
        return status->condition.flags;
      }
    }
    ADD_FAILURE() << "no answer";
    return 0;
  }
  /// Of all frames a tenth, to any node.
  void lose_frames(unsigned seed) {
    auto random = std::make_shared<std::mt19937>(seed);
    rig->bus.set_loss_rule([random](const CanFrame& frame, std::size_t /*receiver*/) {
      return frame.identifier != heartbeat && (*random)() % 10 == 0;
    });
  }
  void leave_bootloader() { rig->host.send({broadcast::host_identifier, 2, {7, 1}}); }

  std::unique_ptr<ChipRig> rig;

 private:
  std::vector<std::unique_ptr<FlashingHost>> hosts_;
};

}  // namespace proleg::sim
