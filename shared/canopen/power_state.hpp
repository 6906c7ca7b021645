#pragma once

#include <cstdint>

namespace proleg::canopen {

// Values that a host writes to the controlword of a drive (0x6040; CiA 402, table 27).
inline constexpr std::uint16_t shutdown_controlword = 0x0006;
inline constexpr std::uint16_t switch_on_controlword = 0x0007;
inline constexpr std::uint16_t enable_operation_controlword = 0x000F;
inline constexpr std::uint16_t quick_stop_controlword = 0x0002;

/// States of a drive (CiA 402, section 8.4; IEC 61800-7-201): only Operation enabled and Quick stop active give the
/// servo pulses.
enum class PowerState : std::uint8_t {
  switch_on_disabled,
  ready_to_switch_on,
  switched_on,
  operation_enabled,
  quick_stop_active,
  fault,
};

/// Bits 0-3, 5 and 6 of the statusword, which are the state of a drive (CiA 402, state coding).
inline constexpr std::uint16_t drive_state_bits = 0x6F;
inline constexpr std::uint16_t drive_operation_enabled = 0x27;
inline constexpr std::uint16_t drive_quick_stop_active = 0x07;

/// The state machine behind controlword (0x6040) and statusword (0x6041).
class PowerControl {
 public:
  /// Executes the command in bits 0-3 and 7 of the controlword. A rising edge of bit 7 clears a fault and a quick stop,
  /// which both need the decision of a person.
  void command(std::uint16_t controlword);
  /// Must be called when SYNC or the host is lost, or at bus-off: Operation enabled becomes Quick stop active. Other
  /// states stay.
  void quick_stop();
  /// Must be called when the servo's power is taken away: the state becomes Switch on disabled. A fault stays.
  void disable_voltage();
  /// Must be called at over-current and similar faults: the pulses are off until the fault is cleared.
  void fault();
  /// Returns to the state after switching on.
  void reset();

  [[nodiscard]] PowerState state() const { return state_; }
  [[nodiscard]] std::uint16_t controlword() const { return controlword_; }
  [[nodiscard]] std::uint16_t statusword() const;

 private:
  PowerState state_ = PowerState::switch_on_disabled;
  std::uint16_t controlword_ = 0;
};

}  // namespace proleg::canopen
