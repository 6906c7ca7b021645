#include "firmware/stm32f405/bootloader/handover.hpp"

namespace proleg::stm32f405 {
namespace {

struct Words {
  std::uint32_t value;
  std::uint32_t complement;
};

/// The linker scripts keep it free of everything else: 256 bytes at 0x2001FF00. Volatile: who reads it is the next
/// start.
[[gnu::section(".handover")]] volatile Words words;

}  // namespace

Handover take_handover() {
  const std::uint32_t value = words.value;
  const bool is_whole = words.complement == ~value;
  leave_handover(Handover::none);
  const auto handover = static_cast<Handover>(value);
  switch (handover) {
    case Handover::stay:
    case Handover::start:
    case Handover::pin_seen:
      return is_whole ? handover : Handover::none;
    default:
      return Handover::none;
  }
}

void leave_handover(Handover handover) {
  const auto value = static_cast<std::uint32_t>(handover);
  words.value = value;
  words.complement = ~value;
}

}  // namespace proleg::stm32f405
