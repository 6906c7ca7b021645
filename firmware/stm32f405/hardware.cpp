#include "firmware/stm32f405/hardware.hpp"

#include "firmware/stm32f405/handlers.hpp"
#include "firmware/stm32f405/registers/core.hpp"

namespace proleg::stm32f405 {

constinit Hardware hardware;

void request_pend_sv() { scb::icsr.write(scb::icsr_pendsvset); }

void enable_interrupts() {
  constexpr std::uint32_t first = 0;
  constexpr std::uint32_t middle = 8;
  constexpr std::uint32_t last = 15;  // PendSV and the deadline: neither interrupts the other
  scb::shpr3.write(last << (scb::shpr3_pendsv_position + 4U));
  nvic::set_priority(Interrupt::usart2, middle);
  nvic::enable(Interrupt::usart2);
  nvic::set_priority(Interrupt::timer_5, last);
  nvic::enable(Interrupt::timer_5);
  for (const Interrupt interrupt : {Interrupt::pvd, Interrupt::can1_tx, Interrupt::can1_rx0, Interrupt::can1_sce}) {
    nvic::set_priority(interrupt, first);
    nvic::enable(interrupt);
  }
}

}  // namespace proleg::stm32f405

// The interrupts of the CAN controller only record the event and its time.

using namespace proleg::stm32f405;

extern "C" {

void can1_tx_handler() {
  hardware.can.on_transmit_interrupt(MicrosecondClock::stamp());
  request_pend_sv();
}

void can1_rx0_handler() {
  hardware.can.on_receive_interrupt(MicrosecondClock::stamp());
  request_pend_sv();
}

void can1_sce_handler() {
  hardware.can.on_status_interrupt();
  request_pend_sv();
}

void pvd_handler() {
  hardware.supply.on_interrupt();
  request_pend_sv();
}

void tim5_handler() {
  MicrosecondClock::on_interrupt();
  pend_sv_handler();
}

void usart2_handler() { hardware.console.on_interrupt(); }

}  // extern "C"
