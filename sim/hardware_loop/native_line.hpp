#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <span>
#include <utility>

#include "firmware/module/ports.hpp"
#include "sim/bus/bus.hpp"
#include "sim/serial/serial_line.hpp"

namespace proleg::sim {

/// The serial line of a native module, as the driver of the chip works it (firmware/stm32f405/gateway_line.hpp): 1
/// Mbaud, a ring for what is received, a buffer for what is sent. The module may look at each character at once: that
/// is simpler than the idle line of the driver, and leads to the same output. There is no console.
class NativeLine final : public firmware::LinePort {
 public:
  static constexpr BusTime bit = 1'000;  ///< 1 Mbaud
  static constexpr std::size_t input_size = 512;
  static constexpr std::size_t output_size = 512;

  /// bus: has the time.
  explicit NativeLine(const Bus& bus) : bus_(bus) {}

  /// Puts the line into its state after a reset of the module. What is being sent is cut off.
  void reset();
  using Watch = std::function<void(BusTime time, std::uint8_t byte)>;
  void watch(Watch watch) { watch_ = std::move(watch); }

  void begin_input(BusTime now, const SerialCharacter& character, BusTime senders_bit);
  /// When characters have been received or sent; never_on_bus if nothing is under way.
  [[nodiscard]] BusTime next_event() const;
  void advance_to(BusTime now);

  // LinePort.
  void connect(bool is_gateway) override;
  [[nodiscard]] std::size_t read_line(std::span<char> characters) override;
  [[nodiscard]] bool take_damage() override { return std::exchange(is_damaged_, false); }
  [[nodiscard]] std::span<char> line_room() override;
  void send_line(std::size_t count) override;

 private:
  void take_character(const SerialCharacter& character);

  const Bus& bus_;
  Watch watch_;
  bool is_connected_ = false;
  SerialReceiver receiver_;
  std::deque<char> input_;
  bool is_damaged_ = false;
  std::array<char, output_size> output_{};
  std::size_t sent_ = 0;
  std::size_t to_send_ = 0;
  BusTime character_end_ = never_on_bus;  ///< end of the character that is being sent
};

}  // namespace proleg::sim
