#include "firmware/stm32f405/bootloader/program_start.hpp"

#include "firmware/stm32f405/flash_layout.hpp"
#include "firmware/stm32f405/pins.hpp"
#include "firmware/stm32f405/registers/core.hpp"

namespace proleg::stm32f405 {
namespace {

using flash_layout::image_body;
// PM0214, section 4.4.4: the table has 98 words, so its address is a multiple of 512.
static_assert(image_body % 512 == 0);

}  // namespace

image::Place image_place() {
  return {board::id, board::revision, image_body, flash_layout::max_image_size - image::header_size};
}

void start_program() {
  const std::uint32_t stack = Register(image_body).read();
  const std::uint32_t entry = Register(image_body + 4).read();
  scb::vtor.write(image_body);
  asm volatile("dsb\n\tmsr msp, %0\n\tbx %1" : : "r"(stack), "r"(entry));
  __builtin_unreachable();
}

}  // namespace proleg::stm32f405
