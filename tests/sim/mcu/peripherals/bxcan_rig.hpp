#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "sim/mcu/peripherals/bxcan.hpp"

namespace proleg::sim {

/// Offsets and bits as in RM0090, 32.9.
namespace can1 {
constexpr std::uint32_t mcr = 0x00;
constexpr std::uint32_t msr = 0x04;
constexpr std::uint32_t tsr = 0x08;
constexpr std::uint32_t rf0r = 0x0C;
constexpr std::uint32_t rf1r = 0x10;
constexpr std::uint32_t ier = 0x14;
constexpr std::uint32_t esr = 0x18;
constexpr std::uint32_t btr = 0x1C;
constexpr std::uint32_t ti0r = 0x180;
constexpr std::uint32_t ri0r = 0x1B0;
constexpr std::uint32_t fmr = 0x200;
constexpr std::uint32_t fm1r = 0x204;
constexpr std::uint32_t fs1r = 0x20C;
constexpr std::uint32_t ffa1r = 0x214;
constexpr std::uint32_t fa1r = 0x21C;
constexpr std::uint32_t f0r1 = 0x240;

constexpr std::uint32_t inrq = 1;
constexpr std::uint32_t sleep = 2;
constexpr std::uint32_t txfp = 4;
constexpr std::uint32_t rflm = 8;
constexpr std::uint32_t nart = 0x10;
constexpr std::uint32_t awum = 0x20;
constexpr std::uint32_t abom = 0x40;

constexpr std::uint32_t inak = 1;
constexpr std::uint32_t slak = 2;
constexpr std::uint32_t erri = 4;
constexpr std::uint32_t wkui = 8;
constexpr std::uint32_t slaki = 0x10;

/// 42 MHz / 3 / (1 + 11 + 2) = 1 Mbit/s.
constexpr std::uint32_t megabit = (1U << 20U) | (10U << 16U) | 2U;
constexpr std::uint32_t silm = 1U << 31U;
constexpr std::uint32_t lbkm = 1U << 30U;
}  // namespace can1

/// A chip whose clock is exact, and whose program is the test.
class TestChip final : public ChipServices {
 public:
  TestChip() { clocks_.apb1 = local_time_per_us / 42; }

  [[nodiscard]] LocalTime now() const override { return local(time); }
  [[nodiscard]] const Clocks& clocks() const override { return clocks_; }
  void set_interrupt(unsigned position, bool high) override { lines.at(position) = high; }
  void set_non_maskable(bool /*high*/) override {}
  void request_reset(ResetCause /*cause*/) override {}
  void reschedule() override {}

  /// 126 units are 125 ns; times in the tests are multiples of that.
  [[nodiscard]] static LocalTime local(BusTime time) { return time / 125 * 126; }
  [[nodiscard]] static BusTime true_time(LocalTime time) { return (time + 125) / 126 * 125; }

  BusTime time = 0;
  std::array<bool, 32> lines{};
  Clocks clocks_;
};

/// Another node on the bus.
class TestPartner final : public BusListener {
 public:
  explicit TestPartner(Bus& bus) : controller(bus.attach(*this)) {}
  void received(BusTime time, const CanFrame& frame) override { received_frames.emplace_back(time, frame); }
  void transmitted(BusTime time, const CanFrame& frame) override { sent.emplace_back(time, frame); }

  [[nodiscard]] std::vector<std::uint16_t> identifiers() const {
    std::vector<std::uint16_t> result;
    std::ranges::transform(received_frames, std::back_inserter(result),
                           [](const auto& entry) { return entry.second.identifier; });
    return result;
  }

  Controller& controller;
  std::vector<std::pair<BusTime, CanFrame>> received_frames;
  std::vector<std::pair<BusTime, CanFrame>> sent;
};

class BxCanRig : public testing::Test {
 protected:
  [[nodiscard]] std::uint32_t read(std::uint32_t offset) { return can.read(offset); }
  void write(std::uint32_t offset, std::uint32_t value) { can.write(offset, value); }

  /// Advances chip and bus together.
  void run_until(BusTime end) {
    for (;;) {
      BusTime next = std::min(bus.next_event(), can.next_request());
      if (can.next_event() != never_on_chip) {
        next = std::min(next, TestChip::true_time(can.next_event()));
      }
      if (next > end) {
        break;
      }
      bus.advance_to(next);
      chip.time = std::max(chip.time, next);
      can.submit(next);
      if (can.next_event() <= chip.now()) {
        can.advance();
      }
    }
    bus.advance_to(end);
    chip.time = end;
  }
  void run_for(BusTime duration) { run_until(bus.now() + duration); }

  void enter_initialisation() {
    write(can1::mcr, can1::inrq);
    run_for(500'000);
    ASSERT_EQ(read(can1::msr) & (can1::inak | can1::slak), can1::inak);
  }
  /// Normal mode, everything into FIFO 0.
  void start(std::uint32_t control = 0, std::uint32_t timing = can1::megabit) {
    enter_initialisation();
    write(can1::btr, timing);
    write(can1::fs1r, 1);
    write(can1::f0r1, 0);
    write(can1::f0r1 + 4, 0);
    write(can1::fa1r, 1);
    write(can1::fmr, 0x2A1C'0000U | 28U << 8U);
    write(can1::mcr, control);
    run_for(200'000);
    ASSERT_EQ(read(can1::msr) & (can1::inak | can1::slak), 0U);
  }
  void request(unsigned mailbox, std::uint16_t identifier, std::uint32_t length = 0, std::uint32_t low = 0,
               std::uint32_t high = 0) {
    const std::uint32_t base = can1::ti0r + 0x10 * mailbox;
    write(base + 4, length);
    write(base + 8, low);
    write(base + 12, high);
    write(base, (std::uint32_t{identifier} << 21U) | 1U);
  }
  void partner_sends(std::uint16_t identifier, std::uint8_t length = 0) {
    ASSERT_TRUE(partner.controller.send({identifier, length, {1, 2, 3, 4, 5, 6, 7, 8}}));
  }
  /// The mailbox's byte of TSR.
  [[nodiscard]] std::uint32_t outcome(unsigned mailbox) { return (read(can1::tsr) >> (8 * mailbox)) & 0xFFU; }
  [[nodiscard]] bool is_empty(unsigned mailbox) { return ((read(can1::tsr) >> (26 + mailbox)) & 1U) != 0; }
  void expect_rejected(std::uint32_t offset, std::uint32_t value, const std::vector<std::string>& words) {
    try {
      write(offset, value);
      ADD_FAILURE() << "accepted: " << std::hex << value << " at " << offset;
    } catch (const UnmodelledAccess& rejection) {
      for (const std::string& word : words) {
        EXPECT_NE(std::string(rejection.what()).find(word), std::string::npos)
            << rejection.what() << "; expected " << word;
      }
    }
  }

  Bus bus;
  TestChip chip;
  BxCan can{chip, bus, TestChip::true_time};
  TestPartner partner{bus};
};

}  // namespace proleg::sim
