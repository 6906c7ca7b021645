#pragma once

// What a start of a module leaves for the next one, in RAM that keeps its contents over a reset. The program leaves it
// for the bootloader, and the bootloader for the program and for itself.

#include <cstdint>

#include "firmware/bootloader/slots.hpp"
#include "shared/can/can_port.hpp"

namespace proleg::bootloader {

enum class HandoverAction : std::uint32_t {
  none = 0,
  stay = 0xB007'0001,         ///< the bootloader stays on the bus, though there is a program that may run
  start = 0xB007'0002,        ///< the bootloader starts the program in slot A; a start on trial has been counted
  pin_seen = 0xB007'0003,     ///< the reset pin was used a moment ago
  started = 0xB007'0004,      ///< the program was started several times in a row (the argument), and has not reported a
                              ///< good start
  runs = 0xB007'0005,         ///< the program has started well
  install = 0xB007'0006,      ///< an image waits in RAM; the argument is ImageInRam
  window_over = 0xB007'0007,  ///< no host has asked for the bootloader in the window after power on; the argument is
                              ///< WindowEnd
};

struct Handover {
  HandoverAction action = HandoverAction::none;
  std::uint32_t argument = 0;
};

/// Time after the start of a module in which it takes its first key.
inline constexpr Microseconds first_key_time_us = 600'000'000;

/// The argument of HandoverAction::install.
struct ImageInRam {
  std::uint32_t size = 0;    ///< less than 2^22 bytes
  std::uint8_t session = 0;  ///< session of the host that has sent it
  /// The host is on the module's serial line: the bootloader returns to the program without a request.
  bool ends_line = false;
  /// The program has run for less than first_key_time_us: the bytes may be the first key of the module.
  bool may_be_key = false;

  [[nodiscard]] constexpr std::uint32_t argument() const {
    return size | std::uint32_t{session} << session_position | (ends_line ? line_bit : 0) | (may_be_key ? key_bit : 0);
  }
  [[nodiscard]] static constexpr ImageInRam of(std::uint32_t argument) {
    return {argument & (key_bit - 1), static_cast<std::uint8_t>(argument >> session_position),
            (argument & line_bit) != 0, (argument & key_bit) != 0};
  }

 private:
  static constexpr unsigned session_position = 24;
  static constexpr std::uint32_t line_bit = 1U << 23U;
  static constexpr std::uint32_t key_bit = 1U << 22U;
};

/// The argument of HandoverAction::window_over. After the window the chip is reset, so that the program starts with the
/// chip as it is after a reset.
struct WindowEnd {
  /// Starts of the program in a row without a good one, before power on: RAM keeps its contents when the supply is low
  /// for a short time.
  std::uint32_t bad_starts = 0;
  bool starts_program = false;  ///< next_step() was NextStep::start_program: the checksum is right

  [[nodiscard]] constexpr std::uint32_t argument() const { return bad_starts | (starts_program ? starts_bit : 0); }
  [[nodiscard]] static constexpr WindowEnd of(std::uint32_t argument) {
    return {argument & ~starts_bit, (argument & starts_bit) != 0};
  }

 private:
  static constexpr std::uint32_t starts_bit = 1U << 31U;
};

/// Number of starts without the report of a good start after which the program is not started any more: the bootloader
/// stays.
inline constexpr std::uint32_t max_bad_starts = 5;

/// Actions of the bootloader after a reset of the chip.
enum class NextStep : std::uint8_t {
  start_program,  ///< start the program in slot A, with the chip as after a reset; Handover `started` must be left
  prepare,        ///< Slots::prepare_start() decides what runs, and keeps what a confirmed image says about later ones;
                  ///< the program starts after a reset, with Handover `start`
  serve_bus,
};

/// What is left for the start after the window. left: by the start before power on.
[[nodiscard]] constexpr Handover left_by_window(const Handover& left, bool starts_program) {
  const std::uint32_t bad_starts = left.action == HandoverAction::started ? left.argument : 0;
  return {HandoverAction::window_over, WindowEnd{bad_starts, starts_program}.argument()};
}

/// What counts after the window: what was left before power on.
[[nodiscard]] constexpr Handover left_before_window(const Handover& left) {
  const std::uint32_t bad_starts = WindowEnd::of(left.argument).bad_starts;
  return bad_starts != 0 ? Handover{HandoverAction::started, bad_starts} : Handover{};
}

/// What must be left for the next start when the program is started.
[[nodiscard]] constexpr Handover started_after(const Handover& left) {
  return {HandoverAction::started, 1 + (left.action == HandoverAction::started ? left.argument : 0)};
}

/// Whether the program has started badly too often, and must not be started any more.
[[nodiscard]] constexpr bool starts_badly(const Handover& left) {
  return left.action == HandoverAction::started && left.argument >= max_bad_starts;
}

[[nodiscard]] inline NextStep next_step(const Slots& slots, const Handover& left) {
  if (left.action == HandoverAction::stay || left.action == HandoverAction::install || starts_badly(left)) {
    return NextStep::serve_bus;
  }
  // What an image says about later ones waits while it does not start well: its starts are counted.
  const bool has_work = left.action != HandoverAction::started && slots.has_new_trust();
  const bool may_run = left.action == HandoverAction::start || (slots.is_confirmed(FlashSlot::a) && !has_work);
  return may_run && !slots.image_in(FlashSlot::a).empty() ? NextStep::start_program : NextStep::prepare;
}

}  // namespace proleg::bootloader
