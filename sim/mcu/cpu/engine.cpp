#include "sim/mcu/cpu/engine.hpp"

#include <cstring>
#include <stdexcept>
#include <string>

#include "sim/mcu/cpu/cpu_surroundings.hpp"
#include "sim/mcu/cpu/thumb.hpp"

namespace proleg::sim {
namespace {

constexpr std::uint32_t peripherals_start = 0x4000'0000;
constexpr std::uint32_t peripherals_size = 0x2000'0000;
constexpr std::uint32_t private_bus_start = 0xE000'0000;
constexpr std::uint32_t private_bus_size = 0x0010'0000;
constexpr std::uint32_t ram_bits_start = 0x2200'0000;
constexpr std::uint32_t ram_bits_size = ChipMemory::ram_size * 32;
constexpr std::uint32_t distance_start = 0xA000'0000;
constexpr std::uint32_t distance_size = 4 * 1024 * 1024;

/// Where Unicorn ends a run by itself; there is no memory, so that only a program that jumped to an invalid address
/// gets there.
constexpr std::uint32_t never_executed = 0;

// Numbers of UC_HOOK_INTR.
constexpr std::uint32_t supervisor_call_number = 2;
constexpr std::uint32_t prefetch_abort_number = 3;
constexpr std::uint32_t data_abort_number = 4;
constexpr std::uint32_t breakpoint_number = 7;
constexpr std::uint32_t exception_return_number = 8;

void check(uc_err error, const char* action) {
  if (error != UC_ERR_OK) {
    throw std::runtime_error(std::string("emulator: ") + action + ": " + uc_strerror(error));
  }
}

bool is_flash(std::uint32_t address) { return address - ChipMemory::flash_start < ChipMemory::flash_size; }

bool lies_in(std::uint32_t address, std::uint64_t size, std::uint32_t start, std::uint32_t length) {
  return address >= start && std::uint64_t{address} + size <= std::uint64_t{start} + length;
}

}  // namespace

/// RAM belongs to the engine, so that stack frames can be copied; Unicorn has the flash, which it must map as
/// read-only.
struct Engine::Memory {
  alignas(4096) std::array<std::uint8_t, ChipMemory::ram_size> ram;
  alignas(4096) std::array<std::uint8_t, ChipMemory::ccm_size> ccm;
};

Engine::Engine(EngineClient& client)
    : client_(client),
      flash_blocks_(ChipMemory::flash_start, ChipMemory::flash_size),
      memory_(std::make_unique<Memory>()) {
  check(uc_open(UC_ARCH_ARM, UC_MODE_THUMB, &uc_), "open");
  try {
    // The mode for microcontrollers would silently choose a Cortex-M33; the model brings the mode with it.
    check(uc_ctl_set_cpu_model(uc_, UC_CPU_ARM_CORTEX_M4), "CPU model");
    map_memory();
    map_registers(peripherals_start, peripherals_size);
    map_registers(private_bus_start, private_bus_size);
    map_registers(ram_bits_start, ram_bits_size);
    uc_hook hook = 0;
    check(uc_hook_add(uc_, &hook, UC_HOOK_BLOCK, reinterpret_cast<void*>(&on_block), this, 1, 0), "watch blocks");
    check(uc_hook_add(uc_, &hook, UC_HOOK_INTR, reinterpret_cast<void*>(&on_interrupt), this, 1, 0),
          "watch exceptions");
    check(uc_hook_add(uc_, &hook, UC_HOOK_MEM_INVALID, reinterpret_cast<void*>(&on_bad_access), this, 1, 0),
          "watch bad accesses");
  } catch (...) {
    uc_close(uc_);
    throw;
  }
}

Engine::~Engine() { uc_close(uc_); }

void Engine::map_memory() {
  // At every store Unicorn looks up the code in its page. That is a third faster if no code lies in the same 4 MB of
  // Unicorn's own memory, which it fills in the order of mapping.
  check(uc_mem_map_ptr(uc_, ChipMemory::ram_start, ChipMemory::ram_size, UC_PROT_ALL, memory_->ram.data()), "map RAM");
  // The core-coupled memory is on the data bus alone.
  check(uc_mem_map_ptr(uc_, ChipMemory::ccm_start, ChipMemory::ccm_size, UC_PROT_READ | UC_PROT_WRITE,
                       memory_->ccm.data()),
        "map the core-coupled memory");
  check(uc_mem_map(uc_, distance_start, distance_size, UC_PROT_NONE), "map distance");
  check(uc_mem_map(uc_, ChipMemory::flash_start, ChipMemory::flash_size, UC_PROT_READ | UC_PROT_EXEC), "map flash");
  check(uc_mem_map(uc_, ChipMemory::system_memory_start, ChipMemory::system_memory_size, UC_PROT_READ),
        "map system memory");
  check(uc_mem_map(uc_, ChipMemory::reserved_start, ChipMemory::reserved_size, UC_PROT_READ), "map reserved addresses");
}

void Engine::map_registers(std::uint32_t start, std::uint32_t size) {
  registers_.push_back(std::make_unique<Registers>(Registers{this, start}));
  void* const region = registers_.back().get();
  check(uc_mmio_map(uc_, start, size, &on_load, region, &on_store, region), "map registers");
}

int Engine::id(CoreRegister name) {
  constexpr std::array<int, 23> ids{
      UC_ARM_REG_R0,  UC_ARM_REG_R1,      UC_ARM_REG_R2,      UC_ARM_REG_R3,        UC_ARM_REG_R4,     UC_ARM_REG_R5,
      UC_ARM_REG_R6,  UC_ARM_REG_R7,      UC_ARM_REG_R8,      UC_ARM_REG_R9,        UC_ARM_REG_R10,    UC_ARM_REG_R11,
      UC_ARM_REG_R12, UC_ARM_REG_SP,      UC_ARM_REG_LR,      UC_ARM_REG_PC,        UC_ARM_REG_XPSR,   UC_ARM_REG_MSP,
      UC_ARM_REG_PSP, UC_ARM_REG_PRIMASK, UC_ARM_REG_BASEPRI, UC_ARM_REG_FAULTMASK, UC_ARM_REG_CONTROL};
  return ids[static_cast<std::size_t>(name)];
}

int Engine::id_to_write(CoreRegister name) {
  return name == CoreRegister::xpsr ? static_cast<int>(UC_ARM_REG_XPSR_NZCVQG) : id(name);
}

void Engine::read_batch(int* ids, void** places, int count) const { uc_reg_read_batch(uc_, ids, places, count); }

void Engine::write_batch(int* ids, void* const* places, int count) { uc_reg_write_batch(uc_, ids, places, count); }

std::uint32_t Engine::read(CoreRegister name) const {
  if (name == CoreRegister::pc) {
    return pc_;
  }
  std::array<std::uint32_t, 1> value{};
  read(std::array{name}, value);
  return value[0];
}

void Engine::write(CoreRegister name, std::uint32_t value) {
  if (name == CoreRegister::pc) {
    set_pc(value);
    return;
  }
  write(std::array{name}, std::array{value});
}

std::uint8_t* Engine::ram(std::uint32_t address, std::uint32_t size) const {
  if (lies_in(address, size, ChipMemory::ram_start, ChipMemory::ram_size)) {
    return memory_->ram.data() + (address - ChipMemory::ram_start);
  }
  if (lies_in(address, size, ChipMemory::ccm_start, ChipMemory::ccm_size)) {
    return memory_->ccm.data() + (address - ChipMemory::ccm_start);
  }
  return nullptr;
}

bool Engine::is_memory(std::uint32_t address, std::uint64_t size) {
  return lies_in(address, size, ChipMemory::ram_start, ChipMemory::ram_size) ||
         lies_in(address, size, ChipMemory::ccm_start, ChipMemory::ccm_size) ||
         lies_in(address, size, ChipMemory::flash_start, ChipMemory::flash_size) ||
         lies_in(address, size, ChipMemory::system_memory_start, ChipMemory::system_memory_size);
}

bool Engine::read_memory(std::uint32_t address, std::span<std::uint8_t> bytes) const {
  if (!is_memory(address, bytes.size())) {
    return false;
  }
  if (const std::uint8_t* const place = ram(address, static_cast<std::uint32_t>(bytes.size()))) {
    std::memcpy(bytes.data(), place, bytes.size());
    return true;
  }
  return uc_mem_read(uc_, address, bytes.data(), bytes.size()) == UC_ERR_OK;
}

bool Engine::write_memory(std::uint32_t address, std::span<const std::uint8_t> bytes) {
  if (!is_memory(address, bytes.size())) {
    return false;
  }
  if (bytes.empty()) {
    return true;
  }
  const auto size = static_cast<std::uint32_t>(bytes.size());
  if (std::uint8_t* const place = ram(address, size)) {
    std::memcpy(place, bytes.data(), bytes.size());
    if (code_in_ram_) {
      discard_code(address, size);
    }
    return true;
  }
  check(uc_mem_write(uc_, address, bytes.data(), bytes.size()), "write memory");
  if (lies_in(address, size, ChipMemory::flash_start, ChipMemory::flash_size)) {
    flash_blocks_.discard(address, size);
    discard_code(address, size);
  }
  return true;
}

void Engine::discard_code(std::uint32_t address, std::uint32_t size) {
  uc_ctl_remove_cache(uc_, std::uint64_t{address}, std::uint64_t{address} + size);
}

std::vector<std::uint8_t> Engine::code(std::uint32_t address, std::uint32_t size) const {
  std::vector<std::uint8_t> bytes(size);
  if (!read_memory(address, bytes)) {
    bytes.clear();
  }
  return bytes;
}

CodeBlock Engine::examine(std::uint32_t address, std::uint32_t size) {
  const CodeBlock block = examine_block(code(address, size));
  if (lies_in(address, size, ChipMemory::flash_start, ChipMemory::flash_size)) {
    const auto [begin, length] = flash_blocks_.memory_for(address);
    flash_blocks_.add(address, block, code(begin, length));
  } else {
    code_in_ram_ = true;
  }
  return block;
}

inline void Engine::enter_block(std::uint32_t address, std::uint32_t size) {
  block_address_ = address;
  const unsigned count = is_flash(address) ? flash_blocks_.find_plain(address, size) : 0;
  if (count == 0) [[unlikely]] {
    enter_special_block(address, size);
    return;
  }
  block_ = {static_cast<std::uint16_t>(size), static_cast<std::uint16_t>(count)};
  instructions_ += count;
}

void Engine::on_block(uc_engine* /*uc*/, std::uint64_t address64, std::uint32_t size, void* self) {
  Engine& engine = *static_cast<Engine*>(self);
  const auto address = static_cast<std::uint32_t>(address64);
  // Every few instructions: without the other cases, which are calls at its end, this function saves no registers.
  if (engine.instructions_ >= engine.limit_) [[unlikely]] {
    engine.stop_or_enter_block(address, size);
  } else {
    engine.enter_block(address, size);
  }
}

void Engine::stop_or_enter_block(std::uint32_t address, std::uint32_t size) {
  if (stepping_) {
    if (step_begun_) {
      stop(End::stepped, address);
      return;
    }
    step_begun_ = true;
  } else if (client_.stops()) {
    stop(End::stopped, address);
    return;
  }
  enter_block(address, size);
}

void Engine::enter_special_block(std::uint32_t address, std::uint32_t size) {
  const std::optional<CodeBlock> known = is_flash(address) ? flash_blocks_.find_special(address, size) : std::nullopt;
  block_ = known ? *known : examine(address, size);
  if (block_.has_coprocessor_instruction && !client_.coprocessor_allowed()) {
    const std::vector<std::uint8_t> bytes = code(address, block_.size);
    for (std::size_t offset = 0; offset + 1 < bytes.size(); offset += instruction_size(halfword_at(bytes, offset))) {
      if (is_coprocessor_instruction(halfword_at(bytes, offset))) {
        until_ = address + static_cast<std::uint32_t>(offset);
        break;
      }
    }
    block_ = {};
    stop(End::no_coprocessor, address);
    return;
  }
  if (block_.has_sev) {
    client_.send_event();
  }
  instructions_ += block_.instructions;
}

void Engine::on_instruction(uc_engine* /*uc*/, std::uint64_t address64, std::uint32_t /*size*/, void* self) {
  Engine& engine = *static_cast<Engine*>(self);
  const auto address = static_cast<std::uint32_t>(address64);
  if (engine.end_) {
    return;
  }
  if (engine.pass_ == address) {
    engine.pass_.reset();
    return;
  }
  engine.uncount_from(address);
  engine.stop(engine.stepping_ ? End::stepped : End::breakpoint, address);
}

void Engine::stop(End end, std::uint32_t address) {
  end_ = end;
  end_address_ = address;
  uc_emu_stop(uc_);
}

void Engine::on_interrupt(uc_engine* uc, std::uint32_t number, void* self) {
  Engine& engine = *static_cast<Engine*>(self);
  if (!engine.end_) {
    uc_reg_read(uc, UC_ARM_REG_PC, &engine.end_address_);
    switch (number) {
      case supervisor_call_number:
        engine.end_ = End::supervisor_call;
        break;
      case breakpoint_number:
        engine.end_ = End::breakpoint_instruction;
        break;
      case exception_return_number:
        engine.end_ = End::exception_return;
        break;
      case prefetch_abort_number:
        // The architecture forbids execution there.
        engine.fault_ = {engine.end_address_, 2, false, true};
        engine.end_ = End::memory_fault;
        break;
      case data_abort_number:
        // Exclusive accesses are the only ones that must be aligned.
        engine.end_ = End::unaligned_exclusive;
        break;
      default:
        engine.end_ = End::failed;
        break;
    }
  }
  uc_emu_stop(uc);
}

bool Engine::on_bad_access(uc_engine* /*uc*/, uc_mem_type type, std::uint64_t address64, int size, std::int64_t value,
                           void* self) {
  Engine& engine = *static_cast<Engine*>(self);
  const auto address = static_cast<std::uint32_t>(address64);
  const auto bytes = static_cast<unsigned>(size);
  if (engine.has_fault_) {
    return false;
  }
  if (type == UC_MEM_WRITE_PROT && lies_in(address, bytes, ChipMemory::flash_start, ChipMemory::flash_size)) {
    const auto word = static_cast<std::uint32_t>(value);
    // True: Unicorn drops the store and continues.
    if (engine.client_.store_to_flash(address, bytes, bytes < 4 ? word & ((1U << 8U * bytes) - 1U) : word)) {
      return true;
    }
  }
  if (type == UC_MEM_WRITE_PROT && lies_in(address, bytes, ChipMemory::reserved_start, ChipMemory::reserved_size) &&
      !engine.client_.is_forbidden(address)) {
    return true;
  }
  engine.has_fault_ = true;
  engine.fault_ = {address, bytes, type == UC_MEM_WRITE_UNMAPPED || type == UC_MEM_WRITE_PROT,
                   type == UC_MEM_FETCH_UNMAPPED || type == UC_MEM_FETCH_PROT};
  return false;
}

std::uint64_t Engine::on_load(uc_engine* /*uc*/, std::uint64_t offset, unsigned size, void* region) {
  const Registers& registers = *static_cast<Registers*>(region);
  return registers.engine->client_.load(registers.start + static_cast<std::uint32_t>(offset), size);
}

void Engine::on_store(uc_engine* /*uc*/, std::uint64_t offset, unsigned size, std::uint64_t value, void* region) {
  const Registers& registers = *static_cast<Registers*>(region);
  registers.engine->client_.store(registers.start + static_cast<std::uint32_t>(offset), size,
                                  static_cast<std::uint32_t>(value));
}

Engine::End Engine::run() {
  std::uint32_t until = never_executed;
  for (;;) {
    end_.reset();
    has_fault_ = false;
    running_ = true;
    const uc_err error = uc_emu_start(uc_, pc_ | 1U, until, 0, 0);
    running_ = false;
    const End end = finish(error, until);
    if (end == End::no_coprocessor && until_ && *until_ != pc_) {
      // The instructions before it in the block come first.
      until = *until_;
      until_.reset();
      discard_code(pc_, 2);
      continue;
    }
    until_.reset();
    if (end != End::yielded) {
      return end;
    }
  }
}

Engine::End Engine::fetch_or_state() const {
  // Checks the state first: a call of a null pointer is a call of code that is not Thumb.
  return fault_.is_fetch && (read(CoreRegister::xpsr) & thumb_state) == 0 ? End::invalid_state : End::memory_fault;
}

Engine::End Engine::finish(uc_err error, std::uint32_t until) {
  if (end_) {
    if (*end_ == End::exception_return) {
      exception_return_ = end_address_ | 1U;
    } else {
      set_pc(end_address_);
    }
    if (*end_ == End::breakpoint_instruction || *end_ == End::unaligned_exclusive) {
      uncount_from(pc_);
    }
    return *end_ == End::memory_fault ? fetch_or_state() : *end_;
  }
  if (has_fault_) {
    pc_ = fault_.is_fetch ? fault_.address & ~1U : locate_fault();
    uncount_from(pc_);
    return fetch_or_state();
  }
  std::uint32_t address = 0;
  uc_reg_read(uc_, UC_ARM_REG_PC, &address);
  set_pc(address);
  const bool at_end = pc_ == block_address_ + block_.size;
  if (error == UC_ERR_OK && at_end && block_.ends_in_wfi) {
    return End::wait_for_interrupt;
  }
  if (error == UC_ERR_OK && pc_ == until && until != never_executed) {
    return End::no_coprocessor;
  }
  if ((read(CoreRegister::xpsr) & thumb_state) == 0) {
    uncount_from(pc_);
    return End::invalid_state;
  }
  if (error == UC_ERR_OK && pc_ == never_executed) {
    fault_ = {pc_, 2, false, true};
    return End::memory_fault;
  }
  if (error == UC_ERR_INSN_INVALID) {
    if (at_end) {
      return block_.ends_in_wfe ? End::wait_for_event : End::yielded;
    }
    uncount_from(pc_);
    return End::undefined_instruction;
  }
  return End::failed;
}

Engine::End Engine::step() {
  const std::vector<std::uint8_t> bytes = code(pc_, 2);
  if (bytes.empty()) {
    return run();
  }
  const std::uint32_t next = pc_ + static_cast<std::uint32_t>(instruction_size(halfword_at(bytes, 0)));
  uc_hook hook = 0;
  check(uc_hook_add(uc_, &hook, UC_HOOK_CODE, reinterpret_cast<void*>(&on_instruction), this, next, next), "step");
  discard_code(pc_, next - pc_ + 2);
  stepping_ = true;
  step_begun_ = false;
  const std::uint64_t limit = limit_;
  limit_ = 0;
  const std::uint32_t start = pc_;
  const End end = run();
  limit_ = limit;
  stepping_ = false;
  check(uc_hook_del(uc_, hook), "step");
  discard_code(start, next - start + 2);
  return end;
}

void Engine::uncount_from(std::uint32_t address) {
  if (address >= block_address_ && address - block_address_ < block_.size) {
    const std::uint32_t rest = block_address_ + block_.size - address;
    instructions_ -= count_instructions(code(address, rest));
    block_ = {};
  }
}

std::uint32_t Engine::locate_fault() const {
  // Unicorn reports the begin of the block, but the registers of the instruction.
  std::array<std::uint32_t, 16> registers{};
  for (std::size_t i = 0; i < 15; ++i) {
    registers[i] = read(static_cast<CoreRegister>(i));
  }
  const std::vector<std::uint8_t> bytes = code(block_address_, block_.size);
  for (std::size_t offset = 0; offset + 1 < bytes.size();) {
    const std::uint16_t first = halfword_at(bytes, offset);
    const std::uint16_t second = offset + 3 < bytes.size() ? halfword_at(bytes, offset + 2) : std::uint16_t{0};
    registers[15] = block_address_ + static_cast<std::uint32_t>(offset);
    const std::optional<MemoryAccess> access = memory_access(first, second, registers);
    if (access && access->is_store == fault_.is_store && fault_.address - access->first < access->size) {
      return registers[15];
    }
    offset += instruction_size(first);
  }
  return block_address_;
}

void Engine::set_breakpoints(std::span<const std::uint32_t> addresses) {
  for (const uc_hook hook : breakpoints_) {
    check(uc_hook_del(uc_, hook), "remove a breakpoint");
  }
  for (const std::uint32_t address : breakpoint_addresses_) {
    discard_code(address, 2);
  }
  breakpoints_.clear();
  breakpoint_addresses_.clear();
  for (const std::uint32_t given : addresses) {
    const std::uint32_t address = given & ~1U;
    uc_hook hook = 0;
    check(uc_hook_add(uc_, &hook, UC_HOOK_CODE, reinterpret_cast<void*>(&on_instruction), this, address, address),
          "set a breakpoint");
    breakpoints_.push_back(hook);
    breakpoint_addresses_.push_back(address);
    discard_code(address, 2);
  }
}

}  // namespace proleg::sim
