#pragma once

#include "firmware/stm32f405/can.hpp"
#include "firmware/stm32f405/clock.hpp"
#include "firmware/stm32f405/console.hpp"
#include "firmware/stm32f405/flash.hpp"
#include "firmware/stm32f405/gateway_line.hpp"
#include "firmware/stm32f405/program_place.hpp"
#include "firmware/stm32f405/sensors.hpp"
#include "firmware/stm32f405/servo.hpp"
#include "firmware/stm32f405/supply.hpp"

namespace proleg::stm32f405 {

/// All drivers. They are static, so that the interrupts find them.
struct Hardware {
  MicrosecondClock clock;
  Can can;
  Servo servo;
  Contacts contacts;
  Sensors sensors;
  Supply supply;
  Console console;
  GatewayLine line{console};
  BoardRecordFlash board_records;
  ProgramPlace program{servo};
};

/// The drivers; they may be used only after make_hardware().
extern Hardware& hardware;

/// Makes the drivers. Must be called once, before anything else.
void make_hardware();

/// Sets the priorities of all interrupts and enables them. pend_sv_handler() may run from now on.
void enable_interrupts();

/// Requests PendSV: pend_sv_handler() runs as soon as no higher priority does. If it runs now, it runs again
/// afterwards.
void request_pend_sv();

}  // namespace proleg::stm32f405
