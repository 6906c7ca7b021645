#pragma once

// A module with its surroundings: a controller of three mailboxes, a servo whose pulses are recorded, touch sensors.

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "firmware/module/module.hpp"
#include "flash_memory.hpp"

namespace proleg::test {

/// The module's sensors, whose readings a test sets.
struct Meters final : firmware::SensorPort {
  [[nodiscard]] ServoReadings take_readings() override {
    ++count;
    return readings;
  }
  ServoReadings readings;
  std::size_t count = 0;  ///< number of times that they were read
};

/// A command to the servo.
struct Pulse {
  Microseconds time;                  ///< time on the bus
  std::optional<std::int32_t> width;  ///< width of the pulse; nothing: off

  friend bool operator==(const Pulse&, const Pulse&) = default;
};

/// The place of the program in flash, and the requests to the bootloader.
struct ProgramPlace final : firmware::ProgramPort {
  std::span<std::uint8_t> buffer() override { return ram; }
  [[nodiscard]] std::span<const std::uint8_t> header() const override { return header_bytes; }
  [[nodiscard]] bool has_bootloader() const override { return is_bootloader_there; }
  [[nodiscard]] bool is_confirmed() const override { return confirmations > 0; }
  void confirm() override { ++confirmations; }
  void note_good_start() override { ++good_starts; }
  [[nodiscard]] broadcast::TrustSummary trust_summary() const override { return trusted; }
  void install(const firmware::Installation& what) override {
    installed = {what.size, what.session, what.ends_line};
    run_time = what.run_time;
  }
  void enter_bootloader() override { ++entries; }

  struct Installed {
    std::size_t size;
    std::uint8_t session;
    bool ends_line;

    friend bool operator==(const Installed&, const Installed&) = default;
  };
  broadcast::TrustSummary trusted;
  Microseconds run_time = 0;  ///< of the program, at the request to install
  std::array<std::uint8_t, 2'000> ram{};
  std::array<std::uint8_t, 512> header_bytes{};
  bool is_bootloader_there = true;
  unsigned confirmations = 0;
  unsigned good_starts = 0;
  unsigned entries = 0;
  std::optional<Installed> installed;
};

class ModuleNode final : CanPort, firmware::ServoPort, firmware::ContactPort {
 public:
  static constexpr std::size_t mailboxes = 3;

  /// clock_offset: time on the module's clock when that of the bus is 0.
  explicit ModuleNode(const firmware::ModuleIdentity& identity, Microseconds clock_offset = 0)
      : clock_offset_(clock_offset), module(identity, {*this, *this, *this, meters, flash, nullptr, &program}) {
    // The board was made for this module.
    firmware::BoardRecord board;
    board.node = identity.node;
    board.has_feedback = (identity.capabilities & canopen::measures_angle) != 0;
    board.feedback_at_plus_90 = board.has_feedback ? firmware::BoardRecord::max_reading : std::uint16_t{0};
    EXPECT_EQ(firmware::append(flash, board), firmware::AppendResult::ok);
  }
  ModuleNode(const ModuleNode&) = delete;

  // Events from outside; times are those of the bus.
  void power_on(Microseconds now) { at(now).power_on(local(now)); }
  void receive(Microseconds now, const CanFrame& frame) { at(now).receive(local(now), frame); }
  void transmitted(Microseconds now, const CanFrame& frame) { at(now).transmitted(local(now), frame); }
  void poll(Microseconds now) { at(now).poll(local(now)); }
  /// Makes the controller drop its pending frames.
  void bus_off(Microseconds now) {
    pending.clear();
    at(now).bus_off(local(now));
  }
  void frames_lost(Microseconds now, std::uint32_t count) { at(now).frames_lost(local(now), count); }
  void supply_low(Microseconds now) { at(now).supply_low(local(now)); }
  void supply_good(Microseconds now) { at(now).supply_good(local(now)); }
  void bus_back(Microseconds now) { at(now).bus_back(local(now)); }
  [[nodiscard]] Microseconds next_deadline() const {
    const Microseconds deadline = module.next_deadline();
    return deadline == never ? never : (deadline < clock_offset_ ? 0 : deadline - clock_offset_);
  }

  /// Frames in the mailboxes, in the order in which they were handed over; no two with one identifier.
  std::vector<CanFrame> pending;
  /// Identifiers of the state frames that the module listens to.
  std::vector<std::uint16_t> listened;
  /// The node of which the module expects a heartbeat, or CanPort::every_node.
  std::uint8_t expected_heartbeat = 0;
  /// Times at which the controller was asked to recover.
  std::vector<Microseconds> recoveries;
  /// Pulses and switches to off since the start, including those that change nothing.
  std::vector<Pulse> pulses;
  [[nodiscard]] bool is_pulsing() const { return !pulses.empty() && pulses.back().width.has_value(); }
  [[nodiscard]] std::size_t pulse_count() const {
    std::size_t count = 0;
    for (const Pulse& pulse : pulses) {
      count += pulse.width ? 1U : 0U;
    }
    return count;
  }
  std::uint32_t pulse_period_us = 0;  ///< period of the last pulse
  /// Whether the servo has its supply. It is an error if a pulse comes without.
  bool has_supply = false;
  unsigned supply_changes = 0;
  Meters meters;
  FlashMemory flash;
  ProgramPlace program;
  /// Present state of the touch sensors.
  std::uint8_t sensors = 0;
  /// Times at which the touch sensors were read.
  std::vector<Microseconds> readings;

 private:
  [[nodiscard]] Microseconds local(Microseconds now) const { return now + clock_offset_; }
  firmware::Module& at(Microseconds now) {
    now_ = now;
    return module;
  }

  void listen(std::span<const std::uint16_t> identifiers) override {
    listened.assign(identifiers.begin(), identifiers.end());
  }
  void expect_heartbeat(std::uint8_t other) override { expected_heartbeat = other; }
  [[nodiscard]] bool send(const CanFrame& frame) override {
    const bool is_twice = std::any_of(pending.begin(), pending.end(),
                                      [&](const CanFrame& other) { return other.identifier == frame.identifier; });
    if (is_twice || pending.size() == mailboxes) {
      return false;
    }
    pending.push_back(frame);
    return true;
  }
  void recover() override { recoveries.push_back(now_); }
  void switch_supply(bool is_on) override {
    EXPECT_NE(is_on, has_supply) << "the port is called for changes only";
    has_supply = is_on;
    ++supply_changes;
  }
  void pulse(std::int32_t width, std::uint32_t period_us) override {
    EXPECT_TRUE(has_supply);
    pulses.push_back({now_, width});
    pulse_period_us = period_us;
  }
  void off() override { pulses.push_back({now_, std::nullopt}); }
  [[nodiscard]] std::uint8_t read_contacts() override {
    readings.push_back(now_);
    return sensors;
  }

  Microseconds clock_offset_;
  Microseconds now_ = 0;

 public:
  firmware::Module module;
};

}  // namespace proleg::test
