#include "tests/cortex_m/machine.hpp"

#include <unicorn/unicorn.h>

#include <algorithm>
#include <array>
#include <optional>
#include <sstream>
#include <string>

#include "sim/mcu/cpu/thumb.hpp"

namespace proleg::cortex_m {
namespace {

/// A called function returns to here; there is room for one instruction, which is never executed.
constexpr std::uint32_t trap_address = 0x1FFF'0000;
constexpr std::uint32_t page_size = 4096;
constexpr std::uint32_t distance_start = 0xA000'0000;
constexpr std::uint32_t distance_size = 4 * 1024 * 1024;
constexpr std::array<std::uint8_t, 2> branch_to_itself{0xFE, 0xE7};

constexpr std::uint8_t paint = 0xC5;
constexpr std::uint16_t wait_for_interrupt = 0xBF30;
constexpr std::uint64_t start_up_budget = 1'000'000;

void check(uc_err error, const char* action) {
  if (error != UC_ERR_OK) {
    throw RunError(std::string("emulator: ") + action + ": " + uc_strerror(error));
  }
}

}  // namespace

/// The emulator behind the machine.
class Machine::Engine {
 public:
  enum class End : std::uint8_t { returned, waiting, budget_used, fault };

  explicit Engine(Cpu cpu) : blocks_(flash_size / 2) {
    check(uc_open(UC_ARCH_ARM, UC_MODE_THUMB, &uc_), "open");
    // The mode for microcontrollers would silently choose a Cortex-M33; the model brings the mode with it.
    check(uc_ctl_set_cpu_model(uc_, cpu == Cpu::cortex_m4 ? UC_CPU_ARM_CORTEX_M4 : UC_CPU_ARM_CORTEX_M0), "CPU model");
    // At every store Unicorn 2.0.1 looks up the code in its page. That is a third faster if no code lies in the same 4
    // MB of Unicorn's own memory, which it fills in the order of mapping.
    check(uc_mem_map(uc_, ram_start, ram_size, UC_PROT_READ | UC_PROT_WRITE), "map RAM");
    check(uc_mem_map(uc_, distance_start, distance_size, UC_PROT_NONE), "map distance");
    check(uc_mem_map(uc_, flash_start, flash_size, UC_PROT_READ | UC_PROT_EXEC), "map flash");
    check(uc_mem_map(uc_, trap_address, page_size, UC_PROT_READ | UC_PROT_EXEC), "map the trap");
    write(trap_address, branch_to_itself);
    uc_hook hook = 0;
    check(uc_hook_add(uc_, &hook, UC_HOOK_BLOCK, reinterpret_cast<void*>(&on_block), this, 1, 0), "watch blocks");
    check(uc_hook_add(uc_, &hook, UC_HOOK_MEM_INVALID, reinterpret_cast<void*>(&on_bad_access), this, 1, 0),
          "watch bad accesses");
  }
  ~Engine() { uc_close(uc_); }
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;

  void read(std::uint32_t address, std::span<std::uint8_t> bytes) const {
    check(uc_mem_read(uc_, address, bytes.data(), bytes.size()), "read memory");
  }
  void write(std::uint32_t address, std::span<const std::uint8_t> bytes) {
    check(uc_mem_write(uc_, address, bytes.data(), bytes.size()), "write memory");
  }

  [[nodiscard]] std::uint32_t reg(int id) const {
    std::uint32_t value = 0;
    check(uc_reg_read(uc_, id, &value), "read a register");
    return value;
  }
  void set_reg(int id, std::uint32_t value) { check(uc_reg_write(uc_, id, &value), "write a register"); }

  /// Runs from an address until something ends it. The program counter is then where it ended.
  End run(std::uint32_t address, std::uint64_t budget) {
    instructions_ = 0;
    budget_ = budget;
    stop_ = Stop::none;
    bad_address_.reset();
    error_ = uc_emu_start(uc_, address | 1U, 0, 0, 0);
    if (stop_ == Stop::trap) {
      return End::returned;
    }
    if (stop_ == Stop::budget) {
      return End::budget_used;
    }
    if (error_ == UC_ERR_OK && is_wait(reg(UC_ARM_REG_PC) - 2)) {
      return End::waiting;
    }
    return End::fault;
  }

  [[nodiscard]] std::uint64_t instructions() const { return instructions_; }
  [[nodiscard]] std::string fault() const {
    std::ostringstream text;
    text << uc_strerror(error_);
    if (bad_address_) {
      text << ", address 0x" << std::hex << *bad_address_;
    }
    return text.str();
  }

 private:
  enum class Stop : std::uint8_t { none, trap, budget };

  struct Block {
    std::uint32_t size = 0;
    std::uint32_t instructions = 0;
  };

  static void on_block(uc_engine* uc, std::uint64_t address, std::uint32_t size, void* engine) {
    static_cast<Engine*>(engine)->enter_block(uc, static_cast<std::uint32_t>(address), size);
  }

  static bool on_bad_access(uc_engine* /*uc*/, uc_mem_type /*type*/, std::uint64_t address, int /*size*/,
                            std::int64_t /*value*/, void* engine) {
    static_cast<Engine*>(engine)->bad_address_ = static_cast<std::uint32_t>(address);
    return false;
  }

  void enter_block(uc_engine* uc, std::uint32_t address, std::uint32_t size) {
    if (address == trap_address) {
      stop_ = Stop::trap;
      uc_emu_stop(uc);
      return;
    }
    instructions_ += instructions_in(address, size);
    if (instructions_ > budget_) {
      stop_ = Stop::budget;
      uc_emu_stop(uc);
    }
  }

  std::uint32_t instructions_in(std::uint32_t address, std::uint32_t size) {
    const std::uint32_t index = (address - flash_start) / 2;
    if (index >= blocks_.size()) {
      return count(address, size);
    }
    Block& block = blocks_[index];
    if (block.size != size) {
      block = {size, count(address, size)};
    }
    return block.instructions;
  }

  [[nodiscard]] std::uint32_t count(std::uint32_t address, std::uint32_t size) const {
    std::vector<std::uint8_t> code(size);
    read(address, code);
    return static_cast<std::uint32_t>(sim::count_instructions(code));
  }

  [[nodiscard]] bool is_wait(std::uint32_t address) const {
    std::array<std::uint8_t, 2> code{};
    return uc_mem_read(uc_, address, code.data(), code.size()) == UC_ERR_OK &&
           sim::halfword_at(code, 0) == wait_for_interrupt;
  }

  uc_engine* uc_ = nullptr;
  std::vector<Block> blocks_;  ///< by halfword of flash where they begin
  std::uint64_t instructions_ = 0;
  std::uint64_t budget_ = 0;
  Stop stop_ = Stop::none;
  std::optional<std::uint32_t> bad_address_;
  uc_err error_ = UC_ERR_OK;
};

Machine::Machine(const ElfImage& image, Cpu cpu)
    : image_(image),
      engine_(std::make_unique<Engine>(cpu)),
      stack_bottom_(address_of("stack_bottom")),
      stack_top_(address_of("stack_top")),
      stack_at_call_(stack_top_) {
  for (const ElfImage::Segment& segment : image.segments()) {
    engine_->write(segment.load_address, segment.bytes);
  }
  // A Cortex-M reads its stack pointer and its first address from the vector table.
  engine_->set_reg(UC_ARM_REG_SP, read_word(flash_start));
  const Engine::End end = engine_->run(read_word(flash_start + 4), start_up_budget);
  if (end != Engine::End::waiting) {
    throw RunError(
        "the start-up code ended at " + image_.describe(engine_->reg(UC_ARM_REG_PC)) +
        " instead of waiting for calls: " + (end == Engine::End::budget_used ? "endless loop" : engine_->fault()));
  }
}

Machine::~Machine() = default;

CallResult Machine::call(std::string_view function, const std::vector<std::uint32_t>& arguments, std::uint64_t budget) {
  const ElfImage::Symbol& symbol = image_.symbol(function);
  if (!symbol.is_function) {
    throw RunError("\"" + symbol.name + "\" is not a function");
  }
  constexpr std::array<int, 4> argument_registers{UC_ARM_REG_R0, UC_ARM_REG_R1, UC_ARM_REG_R2, UC_ARM_REG_R3};
  // Procedure call standard: four arguments in registers, the others on a stack that is aligned to 8 bytes.
  const std::size_t on_stack = arguments.size() - std::min(arguments.size(), argument_registers.size());
  stack_at_call_ = stack_top_ - static_cast<std::uint32_t>((on_stack + 1) / 2 * 8);
  std::size_t index = 0;
  for (const std::uint32_t argument : arguments) {
    if (index < argument_registers.size()) {
      engine_->set_reg(argument_registers[index], argument);
    } else {
      write_word(stack_at_call_ + static_cast<std::uint32_t>(4 * (index - argument_registers.size())), argument);
    }
    ++index;
  }
  engine_->set_reg(UC_ARM_REG_SP, stack_at_call_);
  engine_->set_reg(UC_ARM_REG_LR, trap_address | 1U);
  const Engine::End end = engine_->run(symbol.address, budget);
  if (end == Engine::End::returned) {
    return {engine_->reg(UC_ARM_REG_R0), engine_->instructions()};
  }
  const std::string where = image_.describe(engine_->reg(UC_ARM_REG_PC)) + " in a call of " + symbol.name;
  if (end == Engine::End::budget_used) {
    throw RunError("more than " + std::to_string(budget) + " instructions at " + where);
  }
  if (end == Engine::End::waiting) {
    throw RunError("the image waits for an interrupt at " + where);
  }
  throw RunError(std::string("fault at ") + where + ", return address " +
                 image_.describe(engine_->reg(UC_ARM_REG_LR) & ~1U) + ": " + engine_->fault());
}

void Machine::read(std::uint32_t address, std::span<std::uint8_t> bytes) const { engine_->read(address, bytes); }

void Machine::write(std::uint32_t address, std::span<const std::uint8_t> bytes) { engine_->write(address, bytes); }

std::uint32_t Machine::read_word(std::uint32_t address) const {
  std::array<std::uint8_t, 4> bytes{};
  read(address, bytes);
  return bytes[0] | std::uint32_t{bytes[1]} << 8U | std::uint32_t{bytes[2]} << 16U | std::uint32_t{bytes[3]} << 24U;
}

void Machine::write_word(std::uint32_t address, std::uint32_t value) {
  const std::array<std::uint8_t, 4> bytes{
      static_cast<std::uint8_t>(value & 0xFFU), static_cast<std::uint8_t>(value >> 8U & 0xFFU),
      static_cast<std::uint8_t>(value >> 16U & 0xFFU), static_cast<std::uint8_t>(value >> 24U)};
  write(address, bytes);
}

void Machine::paint_stack() {
  const std::vector<std::uint8_t> pattern(stack_top_ - stack_bottom_, paint);
  write(stack_bottom_, pattern);
}

std::size_t Machine::stack_used() const {
  std::vector<std::uint8_t> stack(stack_at_call_ - stack_bottom_);
  read(stack_bottom_, stack);
  const auto deepest = std::find_if(stack.begin(), stack.end(), [](std::uint8_t byte) { return byte != paint; });
  return static_cast<std::size_t>(stack.end() - deepest);
}

}  // namespace proleg::cortex_m
