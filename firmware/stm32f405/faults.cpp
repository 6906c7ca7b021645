#include "firmware/stm32f405/faults.hpp"

#include <bit>

#include "firmware/stm32f405/hardware.hpp"
#include "firmware/stm32f405/registers/core.hpp"
#include "firmware/stm32f405/registers/rcc.hpp"
#include "firmware/stm32f405/reset.hpp"
#include "firmware/stm32f405/vector_table.hpp"

extern "C" {

/// Ends of the RAM that the program uses, from the linker script.
extern const std::uint32_t stack_bottom[];
extern const std::uint32_t ram_end[];

[[gnu::used]] void report_fault(const std::uint32_t* frame);

}  // extern "C"

namespace proleg::stm32f405 {
namespace {

using Words = std::array<std::uint32_t, sizeof(FaultRecord) / 4>;

/// A FaultRecord as words, because nothing here may be initialized.
struct StoredRecord {
  std::uint32_t mark;
  Words record;
  std::uint32_t check;
};

constexpr std::uint32_t valid_mark = 0xFA17'0001;

/// The record. It is not initialized at the start: it has the contents of the RAM, which are arbitrary after power-on.
[[gnu::section(".noinit")]] StoredRecord stored;

std::uint32_t check_of(const Words& record) {
  std::uint32_t sum = valid_mark;
  for (const std::uint32_t word : record) {
    sum = std::rotl(sum, 5) ^ word;
  }
  return sum;
}

void store(const FaultRecord& record) {
  stored.record = std::bit_cast<Words>(record);
  stored.check = check_of(stored.record);
  stored.mark = valid_mark;
}

void add_status(FaultRecord& record) {
  record.configurable_status = scb::cfsr.read();
  record.hard_fault_status = scb::hfsr.read();
  if ((record.configurable_status & scb::cfsr_bfarvalid) != 0) {
    record.address = scb::bfar.read();
  } else if ((record.configurable_status & scb::cfsr_mmarvalid) != 0) {
    record.address = scb::mmfar.read();
  }
}

FaultRecord::Reason reason_of(std::uint32_t exception) {
  constexpr std::uint32_t non_maskable = 2;
  constexpr std::uint32_t first_interrupt = 11;
  if (exception == non_maskable) {
    return rcc::cir.has(rcc::cir_cssf) ? FaultRecord::Reason::crystal_stopped : FaultRecord::Reason::non_maskable;
  }
  return exception < first_interrupt ? FaultRecord::Reason::processor_fault : FaultRecord::Reason::unexpected_interrupt;
}

}  // namespace

std::string_view text_of(FaultRecord::Reason reason) {
  switch (reason) {
    case FaultRecord::Reason::processor_fault:
      return "processor fault";
    case FaultRecord::Reason::non_maskable:
      return "non-maskable interrupt";
    case FaultRecord::Reason::unexpected_interrupt:
      return "unexpected interrupt";
    case FaultRecord::Reason::pure_virtual_call:
      return "pure virtual call";
    case FaultRecord::Reason::no_crystal:
      return "the crystal does not start";
    case FaultRecord::Reason::no_pll:
      return "the PLL does not lock";
    case FaultRecord::Reason::no_can:
      return "the CAN controller does not answer";
    case FaultRecord::Reason::pll_unlocked:
      return "the PLL has lost its lock";
    case FaultRecord::Reason::crystal_stopped:
      return "the crystal has stopped";
    case FaultRecord::Reason::supply_failed:
      return "the supply voltage is too low";
  }
  return "unknown";
}

void guard_stack() {
  constexpr std::uint32_t guarded = 4 * 1024;
  const std::uint32_t bottom = std::bit_cast<std::uint32_t>(&stack_bottom[0]);
  mpu::rbar.write((bottom - guarded) | mpu::rbar_valid);
  mpu::rasr.write(mpu::rasr_xn | mpu::rasr_size_4k | mpu::rasr_enable);
  mpu::ctrl.write(mpu::ctrl_privdefena | mpu::ctrl_enable);
  asm volatile("dsb\n\tisb" : : : "memory");
}

std::optional<FaultRecord> take_fault_record() {
  if (stored.mark != valid_mark || stored.check != check_of(stored.record)) {
    return std::nullopt;
  }
  stored.mark = 0;
  return std::bit_cast<FaultRecord>(stored.record);
}

void record_fault(FaultRecord::Reason reason) {
  FaultRecord record;
  record.reason = reason;
  record.frame[6] = std::bit_cast<std::uint32_t>(__builtin_return_address(0));
  store(record);
}

}  // namespace proleg::stm32f405

extern "C" {

using proleg::stm32f405::FaultRecord;

/// Handles all faults, NMI, and interrupts that the program does not enable. The stack pointer may be wrong, so the
/// record is written with a new stack.
[[gnu::naked]] void fault_handler() {
  asm volatile(
      "mrs r0, msp\n\t"
      "movw r1, #:lower16:stack_top\n\t"
      "movt r1, #:upper16:stack_top\n\t"
      "mov sp, r1\n\t"
      "b report_fault");
}

void report_fault(const std::uint32_t* frame) {
  // The servo comes first: after a clock failure its timer runs at the wrong frequency. A reset would shorten its
  // pulse.
  proleg::stm32f405::hardware.servo.finish_last_pulse();
  FaultRecord record;
  asm volatile("mrs %0, ipsr" : "=r"(record.exception));
  record.reason = proleg::stm32f405::reason_of(record.exception);
  record.stack_pointer = std::bit_cast<std::uint32_t>(frame);
  constexpr std::uint32_t alignment = 4;
  if (frame >= stack_bottom && frame + record.frame.size() <= ram_end && record.stack_pointer % alignment == 0) {
    for (std::uint32_t& word : record.frame) {
      word = *frame++;
    }
  }
  proleg::stm32f405::add_status(record);
  proleg::stm32f405::store(record);
  proleg::stm32f405::reset_chip();
}

/// The compiler's tables contain this function in place of a virtual function that is not overridden.
[[noreturn]] void __cxa_pure_virtual() {
  proleg::stm32f405::hardware.servo.finish_last_pulse();
  proleg::stm32f405::record_fault(FaultRecord::Reason::pure_virtual_call);
  proleg::stm32f405::reset_chip();
}

}  // extern "C"
