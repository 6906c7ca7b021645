#include "firmware/stm32f405/reset.hpp"

#include "firmware/stm32f405/registers/core.hpp"

namespace proleg::stm32f405 {

void reset_chip() {
  asm volatile("dsb" : : : "memory");
  scb::aircr.write(scb::aircr_sysresetreq);
  for (;;) {
    asm volatile("wfi");  // the reset takes a few cycles
  }
}

}  // namespace proleg::stm32f405
