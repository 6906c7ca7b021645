// The program that is flashed into a module.

#include "firmware/stm32f405/clock.hpp"
#include "firmware/stm32f405/factory_data.hpp"
#include "firmware/stm32f405/faults.hpp"
#include "firmware/stm32f405/module_task.hpp"
#include "firmware/stm32f405/pins.hpp"
#include "firmware/stm32f405/registers/core.hpp"
#include "firmware/stm32f405/registers/flash.hpp"
#include "firmware/stm32f405/reset.hpp"
#include "firmware/stm32f405/vector_table.hpp"
#include "shared/canopen/declared_objects.hpp"
#include "shared/kernel/fingerprint.hpp"

namespace proleg::stm32f405 {
namespace {

constexpr std::uint32_t watchdog_ms = 200;

constinit firmware::TickRecord the_last_tick;
constinit ModuleTask the_module_task;

using firmware::ResetCause;

/// The cause of the program's start, and the record of the fault that stopped it before.
struct Start {
  ResetCause cause = ResetCause::power_on;
  std::optional<FaultRecord> fault;
};

ResetCause cause_of(FaultRecord::Reason reason) {
  if (reason == FaultRecord::Reason::supply_failed) {
    return ResetCause::power_on;
  }
  return is_clock_failure(reason) ? ResetCause::clock : ResetCause::fault;
}

Start find_start() {
  Start start;
  start.cause = reset_cause_of(rcc::csr.read());
  rcc::csr.set(rcc::csr_rmvf);
  start.fault = take_fault_record();
  if (start.fault) {
    start.cause = cause_of(start.fault->reason);
  }
  return start;
}

FaultRecord::Reason reason_of(ClockResult result) {
  switch (result) {
    case ClockResult::no_supply:
      return FaultRecord::Reason::supply_failed;
    case ClockResult::no_crystal:
      return FaultRecord::Reason::no_crystal;
    case ClockResult::no_pll:
    case ClockResult::ok:
      break;
  }
  return FaultRecord::Reason::no_pll;
}

std::string_view text_of(ResetCause cause) {
  switch (cause) {
    case ResetCause::power_on:
      return "power on";
    case ResetCause::pin:
      return "reset pin";
    case ResetCause::software:
      return "software";
    case ResetCause::watchdog:
      return "watchdog";
    case ResetCause::fault:
      return "fault";
    case ResetCause::clock:
      return "clock failure";
  }
  return "unknown";
}

void print(const FaultRecord& fault) {
  Console& console = hardware.console;
  console.write("stopped by: ");
  console.write(text_of(fault.reason));
  if (fault.reason == FaultRecord::Reason::unexpected_interrupt) {
    console.write(" ");
    console.write_decimal(fault.exception);
  }
  const struct {
    std::string_view name;
    std::uint32_t value;
  } words[]{{", pc ", fault.pc()},
            {", lr ", fault.lr()},
            {", sp ", fault.stack_pointer},
            {", cfsr ", fault.configurable_status},
            {", hfsr ", fault.hard_fault_status},
            {", address ", fault.address}};
  for (const auto& word : words) {
    console.write(word.name);
    console.write_hex(word.value);
  }
  console.write("\r\n");
}

void print(const Start& start, const std::optional<firmware::BoardRecord>& record) {
  Console& console = hardware.console;
  console.write("proleg module, ");
  if (record && record->node != 0) {
    console.write("node ");
    console.write_decimal(record->node);
  } else {
    console.write("no node id, waits for LSS (docs/board.md)");
  }
  console.write(", board ");
  console.write_decimal(board::id);
  console.write(", core ");
  console.write_hex(core_fingerprint);
  console.write(", started by ");
  console.write(text_of(start.cause));
  console.write("\r\n");
  if (start.fault) {
    print(*start.fault);
  }
}

/// Waits until the watchdog restarts the chip; the clocks may start then.
[[noreturn]] void wait_for_watchdog() {
  for (;;) {
    asm volatile("wfi");
  }
}

[[noreturn]] void give_up(FaultRecord::Reason reason) {
  record_fault(reason);
  hardware.console.write("proleg module: ");
  hardware.console.write(text_of(reason));
  hardware.console.write("\r\n");
  hardware.console.flush();
  wait_for_watchdog();
}

void start_clocks_or_give_up(const Start& start) {
  const ClockResult result = start_clocks();
  if (result != ClockResult::ok) {
    hardware.console.start(board::internal_oscillator, board::console_baud);
    if (start.fault) {
      print(*start.fault);
    }
    hardware.program
        .note_good_start();  // the board has failed, not the program: the bootloader must not count a bad start
    give_up(reason_of(result));
  }
}

void start_module(const Start& start) {
  hardware.servo.start();
  if (!is_pll_locked()) {
    give_up(FaultRecord::Reason::pll_unlocked);
  }
  if (!hardware.can.start()) {
    give_up(FaultRecord::Reason::no_can);
  }
  firmware::ModuleIdentity identity;
  identity.board_id = board::id;
  const bool has_brown_out_reset = (flash_interface::optcr.read() & flash_interface::optcr_bor_lev_mask) == 0;
  identity.capabilities = (has_brown_out_reset ? canopen::has_brown_out_reset : 0U) |
                          (board::profile.servo_current ? 0U : canopen::has_no_current_sensor);
  identity.unique_id = factory::unique_id();
  identity.core_fingerprint = core_fingerprint;
  identity.reset_cause = start.cause;
  identity.reset_detail = start.fault ? start.fault->pc() : 0;
  the_module_task.start(identity, the_last_tick);
}

}  // namespace
}  // namespace proleg::stm32f405

using namespace proleg::stm32f405;

extern "C" {

/// The address of the module's last tick, in flash. A debugger and the simulator find it by this name.
[[gnu::section(".tick_record"),
  gnu::used]] extern constinit const proleg::firmware::TickRecord* const proleg_tick_record = &the_last_tick;

void run_program() {
  make_hardware();
  static_cast<void>(start_watchdog(watchdog_ms));  // if it fails, the watchdog has 512 ms, which is enough
  guard_stack();
  const Start start = find_start();
  start_pins();
  start_clocks_or_give_up(start);
  hardware.clock.start();
  const auto record = proleg::firmware::newest(hardware.board_records.contents(0), hardware.board_records.contents(1));
  hardware.console.start(board::apb1, record && record->is_gateway ? GatewayLine::baud : board::console_baud);
  print(start, record);
  hardware.sensors.start();
  hardware.supply.start();
  start_module(start);
  enable_interrupts();
  scb::scr.write(scb::scr_sleeponexit);
  request_pend_sv();
  for (;;) {
    asm volatile("wfi");
  }
}

void pend_sv_handler() {
  the_module_task.run();
  end_handler();
}

}  // extern "C"
