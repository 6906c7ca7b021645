#pragma once

// A chip around single peripherals; the test moves its time.

#include <gtest/gtest.h>

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "sim/mcu/peripherals/peripheral.hpp"

namespace proleg::sim::test {

class BenchChip final : public ChipServices {
 public:
  [[nodiscard]] LocalTime now() const override { return time; }
  [[nodiscard]] const Clocks& clocks() const override { return clock_source != nullptr ? *clock_source : settings; }
  void set_interrupt(unsigned position, bool high) override {
    if (high) {
      interrupts.insert(position);
    } else {
      interrupts.erase(position);
    }
    interrupt_changes.emplace_back(time, high);
  }
  void set_non_maskable(bool high) override { non_maskable = high; }
  void request_reset(ResetCause cause) override { resets.emplace_back(time, cause); }
  void reschedule() override {}

  /// Lets time pass; the peripheral works at each of its events.
  void run_until(LocalTime end, Peripheral& peripheral) {
    while (peripheral.next_event() <= end) {
      const LocalTime event = peripheral.next_event();
      ASSERT_GE(event, time) << "an event in the past";
      time = event;
      peripheral.advance();
      ASSERT_GT(peripheral.next_event(), event) << "the event is still due";
    }
    time = end;
  }

  LocalTime time = 0;
  Clocks settings;
  const Clocks* clock_source = nullptr;  ///< e.g. an RCC's; else `settings`
  bool non_maskable = false;
  std::set<unsigned> interrupts;  ///< lines that are high
  std::vector<std::pair<LocalTime, bool>> interrupt_changes;
  std::vector<std::pair<LocalTime, ResetCause>> resets;
};

class BenchBoard final : public BoardSignals {
 public:
  [[nodiscard]] std::optional<bool> pin(char port, unsigned number) override {
    const auto found = pins.find({port, number});
    return found == pins.end() ? std::nullopt : std::optional(found->second);
  }
  [[nodiscard]] std::uint32_t analog_uv(unsigned channel) override { return voltages[channel]; }
  [[nodiscard]] std::int32_t chip_temperature() override { return temperature; }
  void serial_output(unsigned usart, std::uint8_t byte) override { sent.emplace_back(usart, byte); }

  std::map<std::pair<char, unsigned>, bool> pins;
  std::map<unsigned, std::uint32_t> voltages;
  std::int32_t temperature = 25'000;
  std::vector<std::pair<unsigned, std::uint8_t>> sent;
};

/// The clocks that the firmware runs with: 168 MHz core, 42 and 84 MHz buses, timers twice as fast.
inline constexpr Clocks full_speed{.core = 6, .apb1 = 24, .apb2 = 12, .apb1_timers = 12, .apb2_timers = 6};

/// The reason why `action` is rejected; empty if it is not.
template <class Action>
[[nodiscard]] std::string rejection(Action action) {
  try {
    action();
  } catch (const UnmodelledAccess& refused) {
    return refused.what();
  }
  return {};
}

struct ResetValue {
  std::uint32_t offset;
  std::uint32_t value;
};

/// Every register reads the value of the table.
inline void expect_values(Peripheral& peripheral, const std::vector<ResetValue>& table) {
  for (const ResetValue& row : table) {
    EXPECT_EQ(peripheral.read(row.offset), row.value) << peripheral.register_name(row.offset);
  }
}

}  // namespace proleg::sim::test
