#pragma once

#include <cstdint>

namespace proleg::sim {

/// The cycle counter CYCCNT of the DWT (ARMv7-M Architecture Reference Manual, DDI 0403, C1.8). An instruction is a
/// cycle; `now`: instructions executed so far.
class CycleCounter {
 public:
  /// DWT_CTRL.
  [[nodiscard]] std::uint32_t control() const { return control_; }
  void write_control(std::uint32_t value, std::uint64_t now) {
    const std::uint32_t cycles = this->value(now);
    control_ = (control_ & ~cycle_enable) | (value & cycle_enable);
    write_value(cycles, now);
  }
  /// DEMCR.
  [[nodiscard]] std::uint32_t debug_control() const { return debug_control_; }
  void write_debug_control(std::uint32_t value, std::uint64_t now) {
    const std::uint32_t cycles = this->value(now);
    debug_control_ = value & trace_enable;
    write_value(cycles, now);
  }
  /// DWT_CYCCNT.
  [[nodiscard]] std::uint32_t value(std::uint64_t now) const {
    const bool counts = (control_ & cycle_enable) != 0 && (debug_control_ & trace_enable) != 0;
    return counts ? static_cast<std::uint32_t>(now - base_) : stopped_value_;
  }
  void write_value(std::uint32_t value, std::uint64_t now) {
    stopped_value_ = value;
    base_ = now - value;
  }

 private:
  static constexpr std::uint32_t cycle_enable = 1;          ///< DWT_CTRL.CYCCNTENA
  static constexpr std::uint32_t trace_enable = 1U << 24U;  ///< DEMCR.TRCENA

  std::uint32_t control_ = 0x4000'0000;  ///< NUMCOMP = 4
  std::uint32_t debug_control_ = 0;
  std::uint64_t base_ = 0;           ///< instructions when it was 0, while it counts
  std::uint32_t stopped_value_ = 0;  ///< while it does not
};

}  // namespace proleg::sim
