// The start of a program: makes the servo's pin low and fills the RAM.

#include <cstdint>

#include "firmware/stm32f405/pins.hpp"
#include "firmware/stm32f405/vector_table.hpp"

extern "C" {

// Places in flash and RAM; the linker script defines them.
extern const std::uint32_t ram_code_load[];
extern std::uint32_t ram_code_start[];
extern std::uint32_t ram_code_end[];
extern const std::uint32_t data_load[];
extern std::uint32_t data_start[];
extern std::uint32_t data_end[];
extern std::uint32_t bss_start[];
extern std::uint32_t bss_end[];

}  // extern "C"

namespace proleg::stm32f405 {
namespace {

void copy(const std::uint32_t* source, std::uint32_t* target, const std::uint32_t* end) {
  while (target != end) {
    *target++ = *source++;
  }
}

}  // namespace
}  // namespace proleg::stm32f405

extern "C" {

// No constructors run: the linker script checks that there are none (all static objects are constinit).
void reset_handler() {
  // First of all: the pin floats, and the RAM takes half a millisecond at the clock after a reset.
  proleg::stm32f405::hold_servo_low();
  proleg::stm32f405::copy(ram_code_load, ram_code_start, ram_code_end);
  proleg::stm32f405::copy(data_load, data_start, data_end);
  for (std::uint32_t* word = bss_start; word != bss_end; ++word) {
    *word = 0;
  }
  run_program();
}

}  // extern "C"
