#include "firmware/stm32f405/handover.hpp"

namespace proleg::stm32f405 {
namespace {

using bootloader::Handover;
using bootloader::HandoverAction;

struct Words {
  std::uint32_t action;
  std::uint32_t argument;
  std::uint32_t check;
};

/// The words, 256 bytes at 0x2001FF00. The linker scripts keep this memory free of everything else. They are volatile,
/// because the next start reads them.
[[gnu::section(".handover")]] volatile Words words;

/// Check value of the words. Arbitrary contents have the right one once in 2^32.
constexpr std::uint32_t check_of(std::uint32_t action, std::uint32_t argument) {
  constexpr std::uint32_t factor = 0x9E37'79B1;  // it is odd, so that different arguments have different checks
  return ~(action ^ argument * factor);
}

}  // namespace

Handover read_handover() {
  const std::uint32_t action = words.action;
  const std::uint32_t argument = words.argument;
  return words.check == check_of(action, argument) ? Handover{static_cast<HandoverAction>(action), argument}
                                                   : Handover{};
}

Handover take_handover() {
  const Handover left = read_handover();
  leave_handover({});
  return left;
}

void leave_handover(const Handover& handover) {
  const auto action = static_cast<std::uint32_t>(handover.action);
  words.action = action;
  words.argument = handover.argument;
  words.check = check_of(action, handover.argument);
}

}  // namespace proleg::stm32f405
