#include "sim/mcu/cpu/system_control.hpp"

#include <sstream>
#include <utility>

namespace proleg::sim {
namespace {

// Addresses (DDI 0403, tables B3-4 to B3-8, C1-21).
constexpr std::uint32_t dwt_ctrl = 0xE000'1000;
constexpr std::uint32_t dwt_cyccnt = 0xE000'1004;
constexpr std::uint32_t ictr = 0xE000'E004;
constexpr std::uint32_t actlr = 0xE000'E008;
constexpr std::uint32_t syst_csr = 0xE000'E010;
constexpr std::uint32_t syst_rvr = 0xE000'E014;
constexpr std::uint32_t syst_cvr = 0xE000'E018;
constexpr std::uint32_t syst_calib = 0xE000'E01C;
constexpr std::uint32_t nvic_iser = 0xE000'E100;
constexpr std::uint32_t nvic_icer = 0xE000'E180;
constexpr std::uint32_t nvic_ispr = 0xE000'E200;
constexpr std::uint32_t nvic_icpr = 0xE000'E280;
constexpr std::uint32_t nvic_iabr = 0xE000'E300;
constexpr std::uint32_t nvic_ipr = 0xE000'E400;
constexpr std::uint32_t cpuid = 0xE000'ED00;
constexpr std::uint32_t icsr = 0xE000'ED04;
constexpr std::uint32_t vtor = 0xE000'ED08;
constexpr std::uint32_t aircr = 0xE000'ED0C;
constexpr std::uint32_t scr = 0xE000'ED10;
constexpr std::uint32_t ccr = 0xE000'ED14;
constexpr std::uint32_t shpr1 = 0xE000'ED18;
constexpr std::uint32_t shcsr = 0xE000'ED24;
constexpr std::uint32_t cfsr = 0xE000'ED28;
constexpr std::uint32_t hfsr = 0xE000'ED2C;
constexpr std::uint32_t mmfar = 0xE000'ED34;
constexpr std::uint32_t bfar = 0xE000'ED38;
constexpr std::uint32_t afsr = 0xE000'ED3C;
constexpr std::uint32_t cpacr = 0xE000'ED88;
constexpr std::uint32_t mpu_type = 0xE000'ED90;
constexpr std::uint32_t mpu_ctrl = 0xE000'ED94;
constexpr std::uint32_t mpu_rnr = 0xE000'ED98;
constexpr std::uint32_t mpu_rbar = 0xE000'ED9C;
constexpr std::uint32_t mpu_rasr = 0xE000'EDA0;
constexpr std::uint32_t dhcsr = 0xE000'EDF0;
constexpr std::uint32_t demcr = 0xE000'EDFC;
constexpr std::uint32_t stir = 0xE000'EF00;

/// Cortex-M4 r0p1, as in the STM32F405 (PM0214, 4.4.2).
constexpr std::uint32_t cpuid_value = 0x410F'C241;
/// For 1 ms at HCLK / 8 = 18.75 MHz (RM0090, 12.1.2).
constexpr std::uint32_t calibration = 18'750;
/// INTLINESNUM: up to 96 lines.
constexpr std::uint32_t interrupt_words = Nvic::interrupt_count / 32;

constexpr std::uint32_t aircr_key = 0x05FA;
constexpr std::uint32_t aircr_key_read = 0xFA05;
constexpr std::uint32_t first_priority = 4;  ///< exception of the first byte of SHPR1

/// Which unit a part of the bus belongs to.
const char* unit_at(std::uint32_t address) {
  struct Unit {
    std::uint32_t start;
    std::uint32_t end;
    const char* name;
  };
  constexpr Unit units[]{{0xE000'0000, 0xE000'1000, "ITM"},
                         {0xE000'1000, 0xE000'2000, "DWT"},
                         {0xE000'2000, 0xE000'3000, "FPB"},
                         {0xE000'ED90, 0xE000'EDC0, "MPU"},
                         {0xE000'EDF0, 0xE000'EE00, "debug control"},
                         {0xE000'EF34, 0xE000'EF48, "FPU"},
                         {0xE000'E000, 0xE000'F000, "System Control Space"},
                         {0xE004'0000, 0xE004'1000, "TPIU"},
                         {0xE004'1000, 0xE004'2000, "ETM"},
                         {0xE004'2000, 0xE004'3000, "DBGMCU"},
                         {0xE00F'F000, 0xE010'0000, "ROM table"}};
  for (const Unit& unit : units) {
    if (address >= unit.start && address < unit.end) {
      return unit.name;
    }
  }
  return "reserved";
}

bool is_in(std::uint32_t address, std::uint32_t start, std::uint32_t bytes) {
  return address >= start && address < start + bytes;
}

}  // namespace

void SystemControl::reset() {
  *this = SystemControl(*owner_, *nvic_);
  system_tick_.reset();
}

bool SystemControl::fpu_enabled(bool privileged) const {
  const std::uint32_t access = coprocessor_access_ >> 20U & 3U;
  return access == 3 || (access == 1 && privileged);
}

void SystemControl::collect_system_tick() {
  if (system_tick_.take_exception()) {
    nvic_->set_pending(exception::system_tick, true);
    owner_->attend();
  }
}

void SystemControl::halt(std::uint32_t address, const char* what) {
  std::ostringstream text;
  text << what << " 0x" << std::hex << std::uppercase << address << " (private peripheral bus, " << unit_at(address)
       << "), which is not modelled";
  owner_->halt(text.str());
}

void SystemControl::check_protection() {
  if (std::optional<std::string> obstacle = protection_.obstacle()) {
    owner_->halt(std::move(*obstacle));
  }
}

std::uint32_t SystemControl::load(std::uint32_t address, unsigned size) {
  const std::uint32_t word = read_word(address & ~3U);
  const std::uint32_t shifted = word >> 8U * (address & 3U);
  return size == 4 ? shifted : shifted & ((1U << 8U * size) - 1U);
}

void SystemControl::store(std::uint32_t address, unsigned size, std::uint32_t value) {
  if (size == 4 && (address & 3U) == 0) {
    write_word(address, value);
    return;
  }
  for (unsigned i = 0; i < size; ++i) {
    if (!write_byte(address + i, static_cast<std::uint8_t>(value >> 8U * i & 0xFFU))) {
      halt(address, "store of less than a word to");
      return;
    }
  }
}

std::uint32_t SystemControl::interrupts(std::uint32_t word, bool (Nvic::*is)(unsigned) const) const {
  std::uint32_t value = 0;
  for (unsigned i = 0; i < 32 && 32 * word + i < Nvic::interrupt_count; ++i) {
    value |= (nvic_->*is)(exception::first_interrupt + 32 * word + i) ? 1U << i : 0U;
  }
  return value;
}

void SystemControl::change_interrupts(std::uint32_t word, std::uint32_t value, void (Nvic::*change)(unsigned, bool),
                                      bool to) {
  for (unsigned i = 0; i < 32 && 32 * word + i < Nvic::interrupt_count; ++i) {
    if ((value >> i & 1U) != 0) {
      (nvic_->*change)(exception::first_interrupt + 32 * word + i, to);
    }
  }
  owner_->attend();
}

std::uint32_t SystemControl::read_word(std::uint32_t address) {
  if (is_in(address, nvic_iser, 0x40) || is_in(address, nvic_icer, 0x40)) {
    return interrupts((address & 0x3FU) / 4, &Nvic::is_enabled);
  }
  if (is_in(address, nvic_ispr, 0x40) || is_in(address, nvic_icpr, 0x40)) {
    return interrupts((address & 0x3FU) / 4, &Nvic::is_pending);
  }
  if (is_in(address, nvic_iabr, 0x40)) {
    return interrupts((address & 0x3FU) / 4, &Nvic::is_active);
  }
  if (is_in(address, nvic_ipr, 240) || is_in(address, shpr1, 12)) {
    const unsigned first =
        address >= shpr1 ? first_priority + (address - shpr1) : exception::first_interrupt + (address - nvic_ipr);
    std::uint32_t value = 0;
    for (unsigned i = 0; i < 4 && first + i < Nvic::exception_count; ++i) {
      value |= std::uint32_t{nvic_->priority_register(first + i)} << 8U * i;
    }
    return value;
  }
  switch (address) {
    case dwt_ctrl:
      return cycle_counter_.control();
    case dwt_cyccnt:
      return cycle_counter_.value(owner_->instructions());
    case ictr:
      return interrupt_words;
    case actlr:
      return auxiliary_control_;
    case syst_csr: {
      const std::uint32_t value = system_tick_.read_control(owner_->now());
      collect_system_tick();
      return value;
    }
    case syst_rvr:
      return system_tick_.reload();
    case syst_cvr: {
      const std::uint32_t value = system_tick_.read_value(owner_->now());
      collect_system_tick();
      return value;
    }
    case syst_calib:
      return calibration;
    case cpuid:
      return cpuid_value;
    case icsr:
      return interrupt_control_state();
    case vtor:
      return vector_table_;
    case aircr:
      return aircr_key_read << 16U | std::uint32_t{nvic_->priority_group()} << 8U;
    case scr:
      return control_;
    case ccr:
      return configuration_;
    case shcsr:
      return handler_control();
    case cfsr:
      return configurable_status_;
    case hfsr:
      return hard_status_;
    case mmfar:
      return memory_fault_address_;
    case bfar:
      return bus_fault_address_;
    case cpacr:
      return coprocessor_access_;
    case demcr:
      return cycle_counter_.debug_control();
    case mpu_type:
      return MemoryProtection::type;
    case mpu_ctrl:
      return protection_.control();
    case mpu_rnr:
      return protection_.number();
    case mpu_rbar:
      return protection_.base();
    case mpu_rasr:
      return protection_.attributes();
    case afsr:
    case dhcsr:  // no debugger
    case stir:
      return 0;
    default:
      halt(address, "load from");
      return 0;
  }
}

void SystemControl::write_word(std::uint32_t address, std::uint32_t value) {
  if (is_in(address, nvic_iser, 0x40)) {
    change_interrupts((address - nvic_iser) / 4, value, &Nvic::set_enabled, true);
    return;
  }
  if (is_in(address, nvic_icer, 0x40)) {
    change_interrupts((address - nvic_icer) / 4, value, &Nvic::set_enabled, false);
    return;
  }
  if (is_in(address, nvic_ispr, 0x40)) {
    change_interrupts((address - nvic_ispr) / 4, value, &Nvic::set_pending, true);
    return;
  }
  if (is_in(address, nvic_icpr, 0x40)) {
    change_interrupts((address - nvic_icpr) / 4, value, &Nvic::set_pending, false);
    return;
  }
  if (is_in(address, nvic_ipr, 240) || is_in(address, shpr1, 12)) {
    for (unsigned i = 0; i < 4; ++i) {
      static_cast<void>(write_byte(address + i, static_cast<std::uint8_t>(value >> 8U * i & 0xFFU)));
    }
    return;
  }
  switch (address) {
    case dwt_ctrl:
      cycle_counter_.write_control(value, owner_->instructions());
      break;
    case demcr:
      cycle_counter_.write_debug_control(value, owner_->instructions());
      break;
    case dwt_cyccnt:
      cycle_counter_.write_value(value, owner_->instructions());
      break;
    case actlr:
      auxiliary_control_ = value;
      break;
    case syst_csr:
      system_tick_.write_control(value, owner_->now(), owner_->core_period());
      collect_system_tick();
      owner_->reschedule();
      break;
    case syst_rvr:
      system_tick_.write_reload(value, owner_->now());
      collect_system_tick();
      owner_->reschedule();
      break;
    case syst_cvr:
      system_tick_.write_value(owner_->now());
      collect_system_tick();
      owner_->reschedule();
      break;
    case icsr:
      write_interrupt_control_state(value);
      break;
    case vtor:
      vector_table_ = value & 0xFFFF'FF80U;
      break;
    case aircr:
      write_application_interrupt_control(value);
      break;
    case scr:
      control_ = value & 0x16U;
      break;
    case ccr:
      configuration_ = value & 0x31BU;
      break;
    case shcsr:
      write_handler_control(value);
      break;
    case cfsr:
      configurable_status_ &= ~value;
      break;
    case hfsr:
      hard_status_ &= ~value;
      break;
    case mmfar:
      memory_fault_address_ = value;
      break;
    case bfar:
      bus_fault_address_ = value;
      break;
    case cpacr:
      coprocessor_access_ = value & 0x00F0'0000U;
      break;
    case mpu_ctrl:
      protection_.write_control(value);
      check_protection();
      break;
    case mpu_rnr:
      protection_.write_number(value);
      break;
    case mpu_rbar:
      protection_.write_base(value);
      check_protection();
      break;
    case mpu_rasr:
      protection_.write_attributes(value);
      check_protection();
      break;
    case stir:
      if ((value & 0x1FFU) < Nvic::interrupt_count) {
        nvic_->set_pending(exception::first_interrupt + (value & 0x1FFU), true);
        owner_->attend();
      }
      break;
    case cpuid:
    case ictr:
    case syst_calib:
    case afsr:
    case mpu_type:
      break;  // read only
    default:
      halt(address, "store to");
      break;
  }
}

bool SystemControl::write_byte(std::uint32_t address, std::uint8_t value) {
  if (is_in(address, nvic_ipr, 240)) {
    const unsigned number = exception::first_interrupt + (address - nvic_ipr);
    if (number < Nvic::exception_count) {
      nvic_->set_priority(number, value);
    }
  } else if (is_in(address, shpr1, 12)) {
    // Only the bytes of exceptions that exist can be written.
    const unsigned number = first_priority + (address - shpr1);
    if (number <= exception::usage_fault || number == exception::supervisor_call ||
        number == exception::debug_monitor || number >= exception::pending_supervisor) {
      nvic_->set_priority(number, value);
    }
  } else if (is_in(address, cfsr, 4)) {
    configurable_status_ &= ~(std::uint32_t{value} << 8U * (address - cfsr));
  } else {
    return false;
  }
  owner_->attend();
  return true;
}

std::uint32_t SystemControl::interrupt_control_state() const {
  const unsigned active = owner_->active_exception();
  std::uint32_t value = active;
  if (active != 0 && nvic_->active_count() == 1) {
    value |= 1U << 11U;  // RETTOBASE
  }
  value |= nvic_->next() << 12U;
  value |= nvic_->any_interrupt_pending() ? 1U << 22U : 0U;
  value |= nvic_->is_pending(exception::system_tick) ? 1U << 26U : 0U;
  value |= nvic_->is_pending(exception::pending_supervisor) ? 1U << 28U : 0U;
  value |= nvic_->is_pending(exception::nmi) ? 1U << 31U : 0U;
  return value;
}

void SystemControl::write_interrupt_control_state(std::uint32_t value) {
  constexpr struct {
    unsigned bit;
    unsigned number;
    bool to;
  } actions[]{{25, exception::system_tick, false},
              {26, exception::system_tick, true},
              {27, exception::pending_supervisor, false},
              {28, exception::pending_supervisor, true},
              {31, exception::nmi, true}};
  for (const auto& action : actions) {
    if ((value >> action.bit & 1U) != 0) {
      nvic_->set_pending(action.number, action.to);
    }
  }
  owner_->attend();
}

void SystemControl::write_application_interrupt_control(std::uint32_t value) {
  if (value >> 16U != aircr_key) {
    return;
  }
  nvic_->set_priority_group(static_cast<std::uint8_t>(value >> 8U & 7U));
  if ((value & 4U) != 0) {
    owner_->request_reset();
  }
  owner_->attend();
}

namespace {

/// Bits of SHCSR (DDI 0403, B3.2.13).
struct HandlerBit {
  unsigned bit;
  unsigned number;
};
constexpr HandlerBit active_bits[]{{0, exception::memory_management}, {1, exception::bus_fault},
                                   {3, exception::usage_fault},       {7, exception::supervisor_call},
                                   {8, exception::debug_monitor},     {10, exception::pending_supervisor},
                                   {11, exception::system_tick}};
constexpr HandlerBit pending_bits[]{{12, exception::usage_fault},
                                    {13, exception::memory_management},
                                    {14, exception::bus_fault},
                                    {15, exception::supervisor_call}};
constexpr HandlerBit enable_bits[]{
    {16, exception::memory_management}, {17, exception::bus_fault}, {18, exception::usage_fault}};

}  // namespace

std::uint32_t SystemControl::handler_control() const {
  std::uint32_t value = 0;
  for (const HandlerBit& each : active_bits) {
    value |= nvic_->is_active(each.number) ? 1U << each.bit : 0U;
  }
  for (const HandlerBit& each : pending_bits) {
    value |= nvic_->is_pending(each.number) ? 1U << each.bit : 0U;
  }
  for (const HandlerBit& each : enable_bits) {
    value |= nvic_->is_enabled(each.number) ? 1U << each.bit : 0U;
  }
  return value;
}

void SystemControl::write_handler_control(std::uint32_t value) {
  for (const HandlerBit& each : active_bits) {
    const bool to = (value >> each.bit & 1U) != 0;
    if (nvic_->is_active(each.number) != to) {
      halt(shcsr, "change of an active bit by a store to");
    }
  }
  for (const HandlerBit& each : pending_bits) {
    nvic_->set_pending(each.number, (value >> each.bit & 1U) != 0);
  }
  for (const HandlerBit& each : enable_bits) {
    nvic_->set_enabled(each.number, (value >> each.bit & 1U) != 0);
  }
  owner_->attend();
}

}  // namespace proleg::sim
