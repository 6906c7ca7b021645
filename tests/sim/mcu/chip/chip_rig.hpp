#pragma once

// One chip with the image that is flashed, on a bus with a node that plays the host. The test sets the inputs of the
// chip's pins and reads their outputs.

#include <cstdint>
#include <deque>
#include <functional>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "firmware/module/board_record.hpp"
#include "shared/can/can_frame.hpp"
#include "sim/bus/bus.hpp"
#include "sim/mcu/chip/stm32f405.hpp"
#include "sim/mcu/cpu/flash_image.hpp"

namespace proleg::sim {

inline constexpr BusTime us = 1'000;
inline constexpr BusTime ms = 1'000 * us;

inline constexpr std::uint16_t branch_to_itself = 0xE7FE;
inline constexpr std::uint16_t undefined_instruction = 0xDE00;  // udf #0

/// An image that the preset stm32f405 builds: "proleg_stm32f405", "driver_tests".
const FlashImage& image(const std::string& name);

/// What is wired to the pins, and the output of the console.
struct TestBoard final : BoardSignals {
  [[nodiscard]] std::optional<bool> pin(char port, unsigned number) override;
  [[nodiscard]] std::uint32_t analog_uv(unsigned channel) override {
    return voltage ? voltage(channel) : channel < 16 ? uv.at(channel) : 0;
  }
  [[nodiscard]] std::int32_t chip_temperature() override { return temperature; }
  void serial_output(unsigned usart, std::uint8_t byte) override;

  bool servo_pulls_up = false;      ///< the servo has a pull-up at its signal, as many have
  bool holds_recover = false;       ///< the button at PC13
  std::uint16_t low_pins_of_b = 0;  ///< switches to ground on port B that are closed
  std::array<std::uint32_t, 16> uv{};
  std::function<std::uint32_t(unsigned channel)> voltage;  ///< in microvolts, now; instead of `uv`
  std::function<BusTime()> next_change;                    ///< of `voltage`, after now
  std::int32_t temperature = 25'000;
  std::function<BusTime()> clock;
  std::string console;
  std::vector<BusTime> byte_times;  ///< end of each byte of it
};

/// A frame that went over the bus.
struct LoggedFrame {
  BusTime time;  ///< its end
  CanFrame frame;
  bool by_host;
};

/// Code of an emergency message (CiA 301): its first two bytes.
[[nodiscard]] inline unsigned emergency_code(const LoggedFrame& emergency) {
  return emergency.frame.data[0] | unsigned{emergency.frame.data[1]} << 8U;
}

/// The host's controller: sends a queue back to back in its order, and notes errors.
class HostEnd final : public BusListener {
 public:
  explicit HostEnd(Bus& bus);
  void send(const CanFrame& frame);
  /// Then no node acknowledges what the chip sends.
  void switch_off() { controller_.switch_off(); }
  [[nodiscard]] std::size_t index() const { return controller_.index(); }
  [[nodiscard]] bool is_done() const { return on_way_ == 0; }
  BusTime last_error = 0;

 private:
  void received(BusTime /*time*/, const CanFrame& /*frame*/) override {}
  void transmitted(BusTime time, const CanFrame& frame) override;
  void error_seen(BusTime time, bool was_sending) override;
  void fill();

  Controller& controller_;
  std::deque<CanFrame> queue_;
  std::size_t on_way_ = 0;
};

struct RigSettings {
  std::string image = "proleg_stm32f405";
  std::optional<firmware::BoardRecord> record = firmware::BoardRecord{3, false, 0, 0};
  ChipSettings chip{{0x0123'4567, 0x89AB'CDEF, 0x5A5A'0F0F}, 0, 1};
  std::uint32_t bit_rate = Bus::max_bit_rate;
  /// How far the chip may run ahead of the bus: short, so that what it does is seen at its time.
  BusTime max_lead = us;
};

class ChipRig {
 public:
  static constexpr std::uint8_t node = 3;
  static constexpr std::uint32_t settings_address = 0x0800'8000;
  static constexpr std::uint32_t settings_size = 32 * 1024;

  /// The chip is off.
  explicit ChipRig(const RigSettings& settings = {});

  void power_on() { chip.power_on(bus.now()); }
  void set_max_lead(BusTime lead) { max_lead_ = lead; }
  void run_until(BusTime time);
  void run_for(BusTime time) { run_until(bus.now() + time); }
  /// Whether it became true within `timeout`.
  bool run_until_true(const std::function<bool()>& wanted, BusTime timeout = 1'000 * ms);
  /// Powers on and lets the module boot.
  void boot();

  // SDO as a host does it, with frames made by hand.
  std::uint32_t read(std::uint16_t index, std::uint8_t sub);
  void write(std::uint16_t index, std::uint8_t sub, unsigned size, std::uint32_t value);
  /// From boot to the first SYNC: a robot of this joint alone, with a sine in slot 1, whose module sends the SYNCs
  /// (every 10 ms).
  void start_robot(std::uint32_t servo_period_us);
  void start_booted_robot(std::uint32_t servo_period_us);
  /// Power for the servo, at a direct position (90 degrees = 2^30).
  void enable_servo(std::int32_t target);

  [[nodiscard]] std::vector<LoggedFrame> frames(std::uint16_t identifier, BusTime since = 0) const;
  [[nodiscard]] std::vector<std::uint8_t> memory(std::uint32_t address, std::size_t size) const;
  [[nodiscard]] std::uint32_t word(std::uint32_t address) const;
  [[nodiscard]] std::uint32_t address_of(const std::string& function) const;
  /// Replaces the first instructions of the handlers of PendSV and TIM5, which run all of the module's program.
  void break_program(std::initializer_list<std::uint16_t> instructions);
  void mend_program();

  Bus bus;
  TestBoard board;
  Stm32f405 chip;
  HostEnd host;
  std::vector<LoggedFrame> log;
  std::vector<ChipEvent> events;  ///< of the chip

 private:
  CanFrame transfer(const CanFrame& request);
  void take_step(BusTime time);

  const FlashImage& image_;
  BusTime max_lead_;
  std::vector<std::pair<std::uint32_t, std::vector<std::uint8_t>>> broken_;  ///< what was there
};

}  // namespace proleg::sim
