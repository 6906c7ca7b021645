#include "firmware/stm32f405/hardware.hpp"

#include <cstddef>
#include <memory>

#include "firmware/stm32f405/registers/core.hpp"
#include "firmware/stm32f405/vector_table.hpp"

namespace proleg::stm32f405 {
namespace {

/// Memory for Hardware without an initial value, so that the zeros of which it mainly consists need no flash.
union HardwareStorage {
  constexpr HardwareStorage() : nothing() {}
  std::byte nothing;
  Hardware hardware;
};

constinit HardwareStorage storage;

}  // namespace

constinit Hardware& hardware = storage.hardware;

void make_hardware() { std::construct_at(&storage.hardware); }

void request_pend_sv() { scb::icsr.write(scb::icsr_pendsvset); }

void enable_interrupts() {
  constexpr std::uint32_t first = 0;
  constexpr std::uint32_t middle = 8;
  constexpr std::uint32_t last = 15;  // priority of PendSV, the deadline and the line's DMA: none interrupts another
  scb::shpr3.write(last << (scb::shpr3_pendsv_position + 4U));
  nvic::set_priority(Interrupt::usart2, middle);
  nvic::enable(Interrupt::usart2);
  for (const Interrupt interrupt : {Interrupt::timer_5, Interrupt::dma1_stream_5, Interrupt::dma1_stream_6}) {
    nvic::set_priority(interrupt, last);
    nvic::enable(interrupt);
  }
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
  end_handler();
}

void can1_rx0_handler() {
  hardware.can.on_receive_interrupt(MicrosecondClock::stamp());
  request_pend_sv();
  end_handler();
}

void can1_sce_handler() {
  hardware.can.on_status_interrupt();
  request_pend_sv();
  end_handler();
}

void pvd_handler() {
  hardware.supply.on_interrupt();
  request_pend_sv();
  end_handler();
}

void tim5_handler() {
  MicrosecondClock::on_interrupt();
  pend_sv_handler();
}

void usart2_handler() {
  if (hardware.line.is_connected()) {
    hardware.line.on_line_interrupt();
    request_pend_sv();
  } else {
    hardware.console.on_interrupt();
  }
  end_handler();
}

void dma1_stream5_handler() {
  hardware.line.on_receive_interrupt();
  request_pend_sv();
  end_handler();
}

void dma1_stream6_handler() {
  hardware.line.on_transmit_interrupt();
  request_pend_sv();
  end_handler();
}

}  // extern "C"
