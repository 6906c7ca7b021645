#include "firmware/stm32f405/bootloader/program_start.hpp"

#include "firmware/stm32f405/flash_layout.hpp"
#include "firmware/stm32f405/pins.hpp"
#include "firmware/stm32f405/registers/core.hpp"
#include "firmware/stm32f405/watchdog.hpp"

namespace proleg::stm32f405 {
namespace {

constexpr std::uint32_t body = flash_layout::slot_a + image::header_size;
// PM0214, section 4.4.4: the table has 98 words, so its address is a multiple of 512.
static_assert(body % 512 == 0);

}  // namespace

image::Place image_place() {
  return {board::id, board::revision, body, flash_layout::max_image_size - image::header_size};
}

void start_program() {
  feed_watchdog();
  const std::uint32_t stack = Register(body).read();
  const std::uint32_t entry = Register(body + 4).read();
  scb::vtor.write(body);
  asm volatile("dsb\n\tmsr msp, %0\n\tbx %1" : : "r"(stack), "r"(entry));
  __builtin_unreachable();
}

}  // namespace proleg::stm32f405
