// Flash sector 0, from which the chip starts: it jumps to the image in slot A. It is for boards without the bootloader,
// which receives and verifies images (bootloader/).

#include <cstdint>

#include "firmware/stm32f405/flash_layout.hpp"
#include "firmware/stm32f405/vector_table.hpp"

namespace proleg::stm32f405 {
namespace {

using flash_layout::image_body;
using flash_layout::slot_a;
using flash_layout::slot_size;
constexpr std::uint32_t ram = 0x2000'0000;
constexpr std::uint32_t ram_size = 128 * 1024;

/// Whether stack and entry can be those of a program. Erased flash (all bits 1) has neither.
[[gnu::always_inline]] inline bool is_plausible(std::uint32_t stack, std::uint32_t entry) {
  constexpr std::uint32_t stack_alignment = 8;
  return stack > ram && stack <= ram + ram_size && stack % stack_alignment == 0 && entry >= slot_a &&
         entry < slot_a + slot_size && entry % 2 == 1;
}

}  // namespace
}  // namespace proleg::stm32f405

extern "C" {

/// Stops after an exception, or without an image: only a debugger or a programmer can help.
[[gnu::section(".stub.text"), noreturn]] void stub_stop() {
  for (;;) {
    asm volatile("wfi");
  }
}

[[gnu::section(".stub.text"), noreturn]] void stub_reset() {
  using namespace proleg::stm32f405;
  const std::uint32_t stack = Register(image_body).read();
  const std::uint32_t entry = Register(image_body + 4).read();
  if (is_plausible(stack, entry)) {
    jump_to(image_body);
  }
  stub_stop();
}

}  // extern "C"

namespace {

struct StubVectors {
  std::uint32_t initial_stack;
  void (*handlers[3])();  ///< handlers of reset, NMI, HardFault
};

[[gnu::section(".stub.vectors"), gnu::used]] constinit const StubVectors stub_vectors{
    0x2002'0000, {stub_reset, stub_stop, stub_stop}};

}  // namespace
