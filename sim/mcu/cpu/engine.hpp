#pragma once

// Unicorn as the executing part of a Cortex-M4: registers, memory and instructions. Its client has the exceptions and
// the memory-mapped registers. This file hides the peculiarities of Unicorn (version 2.0.1).

#include <unicorn/unicorn.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "sim/mcu/cpu/block_counter.hpp"

namespace proleg::sim {

/// What the engine calls in the middle of a block. They must not throw, nor run or stop the engine.
class EngineClient {
 public:
  /// Peripherals (0x40000000 to 0x5FFFFFFF), private peripheral bus, and the bits of the bit-band regions.
  [[nodiscard]] virtual std::uint32_t load(std::uint32_t address, unsigned size) = 0;
  virtual void store(std::uint32_t address, unsigned size, std::uint32_t value) = 0;
  /// A store to flash. False: rejected.
  [[nodiscard]] virtual bool store_to_flash(std::uint32_t address, unsigned size, std::uint32_t value) = 0;
  /// Called before a block if attention was requested or the limit is reached. True: the run ends.
  [[nodiscard]] virtual bool stops() = 0;
  /// Called before a block with coprocessor instructions: whether it may execute them.
  [[nodiscard]] virtual bool coprocessor_allowed() const = 0;
  /// Called when an address in ChipMemory::reserved_start is written. False: the write is lost; true: it is a fault.
  [[nodiscard]] virtual bool is_forbidden(std::uint32_t address) const = 0;
  /// SEV was executed.
  virtual void send_event() = 0;

 protected:
  ~EngineClient() = default;
};

enum class CoreRegister : std::uint8_t {
  r0,
  r1,
  r2,
  r3,
  r4,
  r5,
  r6,
  r7,
  r8,
  r9,
  r10,
  r11,
  r12,
  sp,
  lr,
  pc,
  xpsr,
  msp,
  psp,
  primask,
  basepri,
  faultmask,
  control
};

/// An access that the memory rejected.
struct MemoryFault {
  std::uint32_t address = 0;
  unsigned size = 0;
  bool is_store = false;
  bool is_fetch = false;
};

class Engine {
 public:
  enum class End : std::uint8_t {
    stopped,                 ///< the client stopped it, before the block at pc()
    breakpoint,              ///< before the instruction at pc(), which has a breakpoint
    stepped,                 ///< after one instruction
    wait_for_interrupt,      ///< WFI was executed
    wait_for_event,          ///< WFE was executed
    yielded,                 ///< YIELD was executed; run() continues by itself
    supervisor_call,         ///< SVC was executed; pc() is behind it
    breakpoint_instruction,  ///< BKPT at pc()
    exception_return,        ///< a branch to exception_return_value() in handler mode
    no_coprocessor,          ///< before the coprocessor instruction at pc()
    undefined_instruction,   ///< at pc()
    invalid_state,           ///< an instruction at pc() with EPSR.T clear
    unaligned_exclusive,     ///< a load or store exclusive at pc() has an address that is not a multiple of its size
    memory_fault,            ///< see fault(); the instruction at pc() was not executed
    failed,                  ///< Unicorn gave no reason
  };

  explicit Engine(EngineClient& client);
  ~Engine();
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;

  /// Executes from pc() on.
  End run();
  /// As run(), but a single instruction.
  End step();
  /// Whether between run() and its return.
  [[nodiscard]] bool is_running() const { return running_; }

  /// Address of the next instruction; bit 0 clear.
  [[nodiscard]] std::uint32_t pc() const { return pc_; }
  void set_pc(std::uint32_t address) { pc_ = address & ~1U; }
  /// Begin of the present or last block.
  [[nodiscard]] std::uint32_t block() const { return block_address_; }
  [[nodiscard]] std::uint32_t exception_return_value() const { return exception_return_; }
  [[nodiscard]] const MemoryFault& fault() const { return fault_; }

  /// Issued in all blocks that were begun.
  [[nodiscard]] std::uint64_t instructions() const { return instructions_; }
  /// EngineClient::stops() is called from here on.
  void set_limit(std::uint64_t instructions) { limit_ = instructions; }

  /// Any registers except pc.
  template <std::size_t count>
  void read(const std::array<CoreRegister, count>& names, std::array<std::uint32_t, count>& values) const {
    std::array<int, count> ids;
    std::array<void*, count> places;
    for (std::size_t i = 0; i < count; ++i) {
      ids[i] = id(names[i]);
      places[i] = &values[i];
    }
    read_batch(ids.data(), places.data(), static_cast<int>(count));
  }
  /// Writes registers in the order given. Writing xpsr changes mode and stack pointer according to its exception
  /// number.
  template <std::size_t count>
  void write(const std::array<CoreRegister, count>& names, const std::array<std::uint32_t, count>& values) {
    std::array<int, 2 * count> ids;
    std::array<void*, 2 * count> places;
    std::array<std::uint32_t, count> copies = values;
    int used = 0;
    for (std::size_t i = 0; i < count; ++i) {
      ids[static_cast<std::size_t>(used)] = id_to_write(names[i]);
      places[static_cast<std::size_t>(used++)] = &copies[i];
      if (names[i] == CoreRegister::xpsr) {
        // Unicorn keeps a digest of its state, which this brings up to date.
        ids[static_cast<std::size_t>(used)] = UC_ARM_REG_APSR_NZCV;
        places[static_cast<std::size_t>(used++)] = &copies[i];
      }
    }
    write_batch(ids.data(), places.data(), used);
  }
  [[nodiscard]] std::uint32_t read(CoreRegister name) const;
  void write(CoreRegister name, std::uint32_t value);

  /// Where RAM is kept; null if not all of these bytes are RAM or core-coupled memory.
  [[nodiscard]] std::uint8_t* ram(std::uint32_t address, std::uint32_t size) const;
  /// Flash, system memory, RAM; false if not all of these bytes are memory. Not in a callback.
  [[nodiscard]] bool read_memory(std::uint32_t address, std::span<std::uint8_t> bytes) const;
  [[nodiscard]] bool write_memory(std::uint32_t address, std::span<const std::uint8_t> bytes);
  [[nodiscard]] static bool is_memory(std::uint32_t address, std::uint64_t size);

  void set_breakpoints(std::span<const std::uint32_t> addresses);
  /// Whether the next run ignores a breakpoint at pc() once.
  void pass_breakpoint(bool pass) { pass_ = pass ? std::optional(pc_) : std::nullopt; }

 private:
  struct Memory;

  static int id(CoreRegister name);
  static int id_to_write(CoreRegister name);
  void read_batch(int* ids, void** places, int count) const;
  void write_batch(int* ids, void* const* places, int count);

  static void on_block(uc_engine* uc, std::uint64_t address, std::uint32_t size, void* self);
  static void on_instruction(uc_engine* uc, std::uint64_t address, std::uint32_t size, void* self);
  static void on_interrupt(uc_engine* uc, std::uint32_t number, void* self);
  static bool on_bad_access(uc_engine* uc, uc_mem_type type, std::uint64_t address, int size, std::int64_t value,
                            void* self);
  static std::uint64_t on_load(uc_engine* uc, std::uint64_t offset, unsigned size, void* region);
  static void on_store(uc_engine* uc, std::uint64_t offset, unsigned size, std::uint64_t value, void* region);

  void map_memory();
  void map_registers(std::uint32_t start, std::uint32_t size);
  CodeBlock examine(std::uint32_t address, std::uint32_t size);
  /// Stops before the block or instruction at an address.
  void stop(End end, std::uint32_t address);
  void stop_or_enter_block(std::uint32_t address, std::uint32_t size);
  void enter_block(std::uint32_t address, std::uint32_t size);
  /// One that is special, or not known yet.
  void enter_special_block(std::uint32_t address, std::uint32_t size);
  End finish(uc_err error, std::uint32_t until);
  [[nodiscard]] End fetch_or_state() const;
  /// Subtracts the instructions of the current block from an address on, which were not executed.
  void uncount_from(std::uint32_t address);
  void discard_code(std::uint32_t address, std::uint32_t size);
  /// The load or store of the current block that caused the fault: the first whose address is the fault's.
  [[nodiscard]] std::uint32_t locate_fault() const;
  [[nodiscard]] std::vector<std::uint8_t> code(std::uint32_t address, std::uint32_t size) const;

  /// A range of memory-mapped registers, for Unicorn, which names them by offset.
  struct Registers {
    Engine* engine;
    std::uint32_t start;
  };

  EngineClient& client_;
  std::uint64_t instructions_ = 0;
  std::uint64_t limit_ = 0;
  std::uint32_t block_address_ = 0;
  CodeBlock block_;
  BlockCounter flash_blocks_;

  uc_engine* uc_ = nullptr;
  std::unique_ptr<Memory> memory_;
  std::vector<std::unique_ptr<Registers>> registers_;
  std::vector<uc_hook> breakpoints_;
  std::vector<std::uint32_t> breakpoint_addresses_;

  std::uint32_t pc_ = 0;
  bool running_ = false;
  bool code_in_ram_ = false;
  std::optional<End> end_;
  std::uint32_t end_address_ = 0;
  std::uint32_t exception_return_ = 0;
  std::optional<std::uint32_t> until_;  ///< where the run ends without executing
  std::optional<std::uint32_t> pass_;   ///< a breakpoint here is ignored once
  bool stepping_ = false;
  bool step_begun_ = false;
  bool has_fault_ = false;
  MemoryFault fault_;
};

}  // namespace proleg::sim
