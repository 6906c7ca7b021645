#pragma once

#include "firmware/stm32f405/can.hpp"
#include "firmware/stm32f405/console.hpp"
#include "firmware/stm32f405/contacts.hpp"
#include "firmware/stm32f405/flash.hpp"
#include "firmware/stm32f405/microsecond_clock.hpp"
#include "firmware/stm32f405/sensors.hpp"
#include "firmware/stm32f405/servo.hpp"

namespace proleg::stm32f405 {

/// All drivers. There is one chip, and its interrupts must find them: so they are static.
struct Hardware {
  MicrosecondClock clock;
  Can can;
  Servo servo;
  Contacts contacts;
  Sensors sensors;
  Console console;
  SettingsFlash settings;
};

extern Hardware hardware;

/// Priorities and enables of all interrupts. From here on they come, and pend_sv_handler() with them.
void enable_interrupts();

/// pend_sv_handler() runs as soon as nothing of a higher priority does; once more if it runs already.
void request_pend_sv();

}  // namespace proleg::stm32f405
