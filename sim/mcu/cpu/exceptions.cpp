#include "sim/mcu/cpu/exceptions.hpp"

#include <cstring>
#include <utility>

#include "shared/computer/text/text.hpp"

namespace proleg::sim {
namespace {

using enum CoreRegister;

constexpr std::uint32_t it_state_mask = 0x0600'FC00;
constexpr std::uint32_t unprivileged = 1;
constexpr std::uint32_t process_stack = 2;

constexpr std::uint32_t return_to_handler = 0xFFFF'FFF1;
constexpr std::uint32_t return_to_thread = 0xFFFF'FFF9;
constexpr std::uint32_t return_to_process = 0xFFFF'FFFD;

// CFSR (DDI 0403, B3.2.15).
constexpr std::uint32_t iaccviol = 1U << 0U;
constexpr std::uint32_t daccviol = 1U << 1U;
constexpr std::uint32_t mstkerr = 1U << 4U;
constexpr std::uint32_t mmarvalid = 1U << 7U;
constexpr std::uint32_t ibuserr = 1U << 8U;
constexpr std::uint32_t preciserr = 1U << 9U;
constexpr std::uint32_t unstkerr = 1U << 11U;
constexpr std::uint32_t stkerr = 1U << 12U;
constexpr std::uint32_t bfarvalid = 1U << 15U;
constexpr std::uint32_t undefinstr = 1U << 16U;
constexpr std::uint32_t invstate = 1U << 17U;
constexpr std::uint32_t invpc = 1U << 18U;
constexpr std::uint32_t nocp = 1U << 19U;
constexpr std::uint32_t unaligned = 1U << 24U;
constexpr std::uint32_t divbyzero = 1U << 25U;
// HFSR (DDI 0403, B3.2.16).
constexpr std::uint32_t vecttbl = 1U << 1U;
constexpr std::uint32_t forced = 1U << 30U;
constexpr std::uint32_t debugevt = 1U << 31U;

bool is_execute_never(std::uint32_t address) {
  return (address >= 0x4000'0000 && address < 0x6000'0000) || address >= 0xA000'0000;
}

std::string describe(const MemoryFault& fault) {
  const std::string place = hexadecimal(fault.address);
  if (fault.is_fetch) {
    return "execution at " + place +
           (Engine::is_memory(fault.address, 1) || is_execute_never(fault.address) ? ", where execution is not possible"
                                                                                   : ", where there is no memory");
  }
  const std::string what = fault.is_store ? "store to " : "load from ";
  if (fault.is_store && Engine::is_memory(fault.address, 1)) {
    return what + place + ", where a store is not possible now";
  }
  return what + place + ", where there is no memory";
}

using Frame = std::array<std::uint32_t, 8>;  ///< r0-r3, r12, lr, return address, xPSR

}  // namespace

Exceptions::Exceptions(Engine& engine, Nvic& nvic, SystemControl& system_control)
    : engine_(&engine), nvic_(&nvic), system_control_(&system_control) {}

void Exceptions::reset() {
  locked_up_ = false;
  event_ = false;
  fault_count_ = 0;
  vectors_known_.reset();
  nvic_->reset();
  system_control_->reset();
  for (unsigned i = 0; i <= 12; ++i) {
    engine_->write(static_cast<CoreRegister>(i), 0);
  }
  set_mode(0, thumb_state, 0);
  engine_->write(std::array{primask, basepri, faultmask, msp, psp, lr},
                 std::array<std::uint32_t, 6>{0, 0, 0, vector(0).address & ~3U, 0, 0xFFFF'FFFF});
  const Vector start = vector(exception::reset);
  engine_->set_pc(start.address);
  if ((start.address & 1U) == 0) {
    raise(exception::usage_fault, invstate,
          "the vector table sends the reset to " + hexadecimal(start.address) + ", which is not Thumb code");
  }
}

void Exceptions::set_mode(unsigned number, std::uint32_t flags, std::uint32_t new_control) {
  engine_->write(std::array{control, xpsr}, std::array{new_control, (flags & ~exception_number_mask) | number});
  engine_->clear_exclusive();
  current_ = number;
}

ExceptionMasks Exceptions::masks() const {
  std::array<std::uint32_t, 3> values{};
  engine_->read(std::array{primask, basepri, faultmask}, values);
  return {values[0], values[1], values[2]};
}

bool Exceptions::takes_next() const {
  return nvic_->wants_attention() && nvic_->next_priority() < nvic_->execution_priority(masks());
}

void Exceptions::take_next() { enter(nvic_->next()); }

Exceptions::Vector Exceptions::vector(unsigned number) {
  const std::uint32_t table = system_control_->vector_table();
  if (table != vector_table_) {
    vector_table_ = table;
    vectors_known_.reset();
  }
  if (vectors_known_[number]) {
    return {true, vectors_[number]};
  }
  // After reset the table is at 0, where the chip shows the flash (RM0090, 2.4).
  const std::uint32_t place = (table < ChipMemory::flash_size ? table + ChipMemory::flash_start : table) + 4 * number;
  std::array<std::uint8_t, 4> bytes{};
  if (!engine_->read_memory(place, bytes)) {
    return {false, 0};
  }
  const std::uint32_t address =
      bytes[0] | std::uint32_t{bytes[1]} << 8U | std::uint32_t{bytes[2]} << 16U | std::uint32_t{bytes[3]} << 24U;
  if (engine_->ram(place, 4) == nullptr) {
    vectors_[number] = address;
    vectors_known_.set(number);
  }
  return {true, address};
}

void Exceptions::enter(unsigned number) {
  constexpr std::array names{r0, r1, r2, r3, r12, lr, sp, xpsr, control};
  std::array<std::uint32_t, names.size()> values{};
  engine_->read(names, values);
  const std::uint32_t old_sp = values[6];
  const std::uint32_t flags = values[7];
  const std::uint32_t old_control = values[8];

  const bool forces_alignment = system_control_->aligns_stack();
  const bool aligned = forces_alignment && (old_sp & 4U) != 0;
  const std::uint32_t place = (old_sp - frame_size) & (forces_alignment ? ~4U : ~0U);
  std::uint32_t exc_return = return_to_thread;
  if (current_ != 0) {
    exc_return = return_to_handler;
  } else if ((old_control & process_stack) != 0) {
    exc_return = return_to_process;
  }

  std::uint8_t* const memory = engine_->ram(place, frame_size);
  if (memory != nullptr) {
    const Frame frame{
        values[0], values[1], values[2],     values[3],
        values[4], values[5], engine_->pc(), (flags & ~frame_was_aligned) | (aligned ? frame_was_aligned : 0U)};
    std::memcpy(memory, frame.data(), frame_size);
  }
  const std::uint32_t new_flags = (flags & ~(exception_number_mask | it_state_mask)) | thumb_state;
  engine_->write(std::array{sp, lr}, std::array{place, exc_return});
  // The handler keeps nPRIV, and works on the main stack.
  set_mode(number, new_flags, old_control & unprivileged);
  event_ = true;
  const bool is_forbidden = system_control_->protection().forbids(place);
  const bool is_lost = place >= ChipMemory::reserved_start && !is_forbidden && place < ChipMemory::ram_start;
  if (memory == nullptr && !is_lost) {
    const std::string cause = "the stack at " + hexadecimal(place) +
                              (is_forbidden ? ", which the MPU forbids" : ", where there is no memory") +
                              ", at the entry of exception " + std::to_string(number);
    const unsigned derived = is_forbidden ? exception::memory_management : exception::bus_fault;
    nvic_->activate(number);
    system_control_->note_configurable(is_forbidden ? mstkerr : stkerr);
    note(cause);
    if (nvic_->active_priority() < 0) {
      lock_up();
      return;
    }
    // The first exception waits until the derived one has been handled.
    nvic_->deactivate(number);
    nvic_->set_pending(number, true);
    const bool is_enabled =
        nvic_->is_enabled(derived) && nvic_->group_priority(derived) < nvic_->group_priority(number);
    if (!is_enabled) {
      system_control_->note_hard(forced);
    }
    enter_without_frame(is_enabled ? derived : exception::hard_fault, exc_return);
    return;
  }
  nvic_->activate(number);
  go_to(vector(number));
}

void Exceptions::enter_without_frame(unsigned number, std::uint32_t exc_return) {
  engine_->write(lr, exc_return);
  set_mode(number, (engine_->read(xpsr) & ~it_state_mask) | thumb_state, engine_->read(control));
  nvic_->activate(number);
  event_ = true;
  go_to(vector(number));
}

void Exceptions::go_to(const Vector& vector) {
  if (!vector.exists) {
    note("the vector of exception " + std::to_string(current_) + " lies where there is no memory");
    raise_hard_fault(vecttbl);
    return;
  }
  engine_->set_pc(vector.address);
  if ((vector.address & 1U) == 0) {
    raise(exception::usage_fault, invstate,
          "the vector of exception " + std::to_string(current_) + " is " + hexadecimal(vector.address) +
              ", which is not Thumb code");
  }
}

bool Exceptions::is_valid_return(std::uint32_t exc_return) const {
  const bool may_be_thread = nvic_->active_count() == 1 || system_control_->allows_any_thread_entry();
  switch (exc_return) {
    case return_to_handler:
      return nvic_->active_count() > 1;
    case return_to_thread:
    case return_to_process:
      return may_be_thread;
    default:
      return false;
  }
}

void Exceptions::return_from_handler(std::uint32_t exc_return) {
  std::array<std::uint32_t, 4> values{};
  engine_->read(std::array{sp, psp, control, faultmask}, values);
  const unsigned number = current_;
  const bool is_valid = nvic_->is_active(number) && is_valid_return(exc_return);
  nvic_->deactivate(number);
  if (values[3] != 0 && number != exception::nmi) {
    engine_->write(faultmask, 0);
  }
  if (!is_valid) {
    fail_return(number, exc_return, invpc,
                "return from exception " + std::to_string(number) + " by " + hexadecimal(exc_return));
    return;
  }
  if (takes_next()) {  // tail-chaining
    enter_without_frame(nvic_->next(), exc_return);
    return;
  }

  const std::uint32_t place = exc_return == return_to_process ? values[1] : values[0];
  const std::uint8_t* const memory = engine_->ram(place, frame_size);
  if (memory == nullptr) {
    fail_return(number, exc_return, unstkerr,
                "the stack at " + hexadecimal(place) + ", where there is no memory, at the return from exception " +
                    std::to_string(number));
    return;
  }
  Frame frame;
  std::memcpy(frame.data(), memory, frame_size);
  const unsigned returned_to = frame[7] & exception_number_mask;
  if ((returned_to != 0) != (exc_return == return_to_handler)) {
    fail_return(number, exc_return, invpc,
                "return from exception " + std::to_string(number) + " by " + hexadecimal(exc_return) +
                    " to an xPSR of " + hexadecimal(frame[7]));
    return;
  }
  const bool was_aligned = system_control_->aligns_stack() && (frame[7] & frame_was_aligned) != 0;
  const std::uint32_t new_sp = place + frame_size + (was_aligned ? 4U : 0U);
  const std::uint32_t flags = frame[7] & ~frame_was_aligned;
  engine_->set_pc(frame[6]);
  engine_->write(std::array{r0, r1, r2, r3, r12, lr, exc_return == return_to_process ? psp : msp},
                 std::array{frame[0], frame[1], frame[2], frame[3], frame[4], frame[5], new_sp});
  set_mode(returned_to, flags | thumb_state,
           (values[2] & unprivileged) | (exc_return == return_to_process ? process_stack : 0U));
  event_ = true;
  if ((flags & thumb_state) == 0) {
    raise_invalid_state();
  }
}

void Exceptions::fail_return(unsigned number, std::uint32_t exc_return, std::uint32_t status, std::string cause) {
  const unsigned wanted = status == invpc ? exception::usage_fault : exception::bus_fault;
  // The handler has returned: only the exceptions that it interrupted count.
  engine_->set_pc(exc_return);
  note(std::move(cause));
  system_control_->note_configurable(status);
  if (number == exception::hard_fault && nvic_->execution_priority(masks()) < 0) {
    lock_up();
    return;
  }
  const bool as_wanted = may_raise(wanted);
  if (!as_wanted) {
    system_control_->note_hard(forced);
    if (nvic_->execution_priority(masks()) <= -1) {
      lock_up();
      return;
    }
  }
  enter_without_frame(as_wanted ? wanted : exception::hard_fault, exc_return);
}

void Exceptions::call_supervisor() {
  if (nvic_->group_priority(exception::supervisor_call) < nvic_->execution_priority(masks())) {
    enter(exception::supervisor_call);
    return;
  }
  note("SVC where its priority does not allow it");
  raise_hard_fault(forced);
}

bool Exceptions::may_raise(unsigned number) const {
  return nvic_->is_enabled(number) && nvic_->group_priority(number) < nvic_->execution_priority(masks());
}

void Exceptions::raise(unsigned number, std::uint32_t status, std::string cause) {
  note(std::move(cause));
  system_control_->note_configurable(status);
  if (may_raise(number)) {
    enter(number);
    return;
  }
  raise_hard_fault(forced);
}

void Exceptions::raise_hard_fault(std::uint32_t status) {
  if (nvic_->execution_priority(masks()) <= -1) {
    lock_up();
    return;
  }
  system_control_->note_hard(status);
  enter(exception::hard_fault);
}

void Exceptions::note(std::string cause) {
  ++fault_count_;
  CpuFault fault;
  fault.cause = std::move(cause);
  for (unsigned i = 0; i <= 16; ++i) {
    fault.registers.push_back(engine_->read(static_cast<CoreRegister>(i)));
  }
  faults_.push_back(std::move(fault));
}

void Exceptions::lock_up() {
  locked_up_ = true;
  faults_.back().locked_up = true;
}

std::vector<CpuFault> Exceptions::take_faults() { return std::exchange(faults_, {}); }

bool Exceptions::take_event() { return std::exchange(event_, false); }

void Exceptions::raise_memory_fault(const MemoryFault& fault) {
  const std::string cause = describe(fault);
  if (fault.is_fetch) {
    if (is_execute_never(fault.address)) {
      raise(exception::memory_management, iaccviol, cause);
    } else {
      raise(exception::bus_fault, ibuserr, cause);
    }
    return;
  }
  if (system_control_->protection().forbids(fault.address)) {
    system_control_->set_memory_fault_address(fault.address);
    raise(exception::memory_management, daccviol | mmarvalid, cause);
    return;
  }
  system_control_->set_bus_fault_address(fault.address);
  raise(exception::bus_fault, preciserr | bfarvalid, cause);
}

void Exceptions::raise_undefined_instruction() { raise(exception::usage_fault, undefinstr, "undefined instruction"); }

void Exceptions::raise_invalid_state() {
  raise(exception::usage_fault, invstate, "a branch to an even address, which is not Thumb code");
}

void Exceptions::raise_no_coprocessor() {
  raise(exception::usage_fault, nocp, "FPU or coprocessor instruction while CPACR forbids it");
}

void Exceptions::raise_unaligned_access(const MemoryFault& fault) {
  raise(
      exception::usage_fault, unaligned,
      "access of " + std::to_string(fault.size) + " bytes at " + hexadecimal(fault.address) + ", which is not aligned");
}

void Exceptions::raise_divide_by_zero() { raise(exception::usage_fault, divbyzero, "division by zero"); }

void Exceptions::raise_breakpoint() {
  note("BKPT without a debugger");
  raise_hard_fault(debugevt);
}

}  // namespace proleg::sim
