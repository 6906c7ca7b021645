// Gives the servo the pulses of a list, each at its time. The test writes the list into the RAM and looks at the pin.

#include <array>

#include "firmware/stm32f405/clock.hpp"
#include "firmware/stm32f405/hardware.hpp"
#include "firmware/stm32f405/pins.hpp"
#include "firmware/stm32f405/vector_table.hpp"

namespace {

using namespace proleg;
using namespace proleg::stm32f405;

struct Request {
  volatile std::uint32_t at_us;  ///< since the begin of the list
  volatile std::uint32_t width;  ///< twelfths of a microsecond; 0: no pulses from now on
  volatile std::uint32_t period_us;
};

struct List {
  volatile std::uint32_t count;  ///< to be written last
  std::array<Request, 1'000> requests;
};

}  // namespace

extern "C" {

[[gnu::used]] constinit List servo_requests{};
/// Number of requests that were made.
[[gnu::used]] constinit volatile std::uint32_t servo_requests_made = 0;

void run_program() {
  make_hardware();
  start_pins();
  while (start_clocks() != ClockResult::ok) {
  }
  hardware.clock.start();
  hardware.servo.start();
  while (servo_requests.count == 0) {
  }
  const std::uint32_t begin = MicrosecondClock::stamp();
  for (std::uint32_t i = 0; i < servo_requests.count; ++i) {
    const Request& request = servo_requests.requests[i];
    while (MicrosecondClock::stamp() - begin < request.at_us) {
    }
    if (request.width == 0) {
      hardware.servo.off();
    } else {
      hardware.servo.pulse(static_cast<std::int32_t>(request.width), request.period_us);
    }
    servo_requests_made = i + 1;
  }
  for (;;) {
  }
}

void pend_sv_handler() {}

}  // extern "C"
