#include "firmware/stm32f405/bootloader/program_start.hpp"

#include "firmware/stm32f405/flash_layout.hpp"
#include "firmware/stm32f405/jump.hpp"
#include "firmware/stm32f405/pins.hpp"
#include "firmware/stm32f405/registers/flash.hpp"

namespace proleg::stm32f405 {
namespace {

using flash_layout::image_body;
// The vector table has 98 words, so its address must be a multiple of 512 (PM0214, section 4.4.4).
static_assert(image_body % 512 == 0);

}  // namespace

image::Place image_place() {
  return {board::id, board::revision, image_body, flash_layout::max_image_size - image::header_size};
}

void start_program() {
  // The caches may hold data of an earlier program (RM0090, section 3.5.2). They are off after a reset.
  flash_interface::acr.set(flash_interface::acr_icrst | flash_interface::acr_dcrst);
  flash_interface::acr.clear(flash_interface::acr_icrst | flash_interface::acr_dcrst);
  jump_to(image_body);
}

}  // namespace proleg::stm32f405
