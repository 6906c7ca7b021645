#pragma once

// An emulated Cortex-M CPU with flash and RAM only: calls functions of an image and measures them.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "sim/mcu/cpu/elf_image.hpp"

namespace proleg::cortex_m {

using sim::ElfImage;

enum class Cpu : std::uint8_t { cortex_m0, cortex_m4 };

/// The image failed: one line that names the address and the function.
class RunError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct CallResult {
  std::uint32_t value;         ///< register r0 at the return
  std::uint64_t instructions;  ///< from the first of the function to its return, both included
};

class Machine {
 public:
  static constexpr std::uint32_t flash_start = 0x0800'0000;
  static constexpr std::uint32_t flash_size = 1024 * 1024;
  static constexpr std::uint32_t ram_start = 0x2000'0000;
  static constexpr std::uint32_t ram_size = 128 * 1024;

  /// Loads the image and runs its start-up code to the first WFI. The image must have the symbols `stack_bottom` and
  /// `stack_top`, and outlive the machine.
  Machine(const ElfImage& image, Cpu cpu);
  ~Machine();
  Machine(const Machine&) = delete;
  Machine& operator=(const Machine&) = delete;

  /// Calls a function with arguments of 32 bits, on an empty stack. RunError if it does not return within
  /// `budget` instructions, or causes a fault; the error names the begin of the block of instructions that caused it.
  CallResult call(std::string_view function, const std::vector<std::uint32_t>& arguments, std::uint64_t budget);

  [[nodiscard]] std::uint32_t address_of(std::string_view symbol) const { return image_.symbol(symbol).address; }
  void read(std::uint32_t address, std::span<std::uint8_t> bytes) const;
  void write(std::uint32_t address, std::span<const std::uint8_t> bytes);
  [[nodiscard]] std::uint32_t read_word(std::uint32_t address) const;
  void write_word(std::uint32_t address, std::uint32_t value);

  /// Fills the stack with a pattern.
  void paint_stack();
  /// Bytes of the painted stack that calls have used since, without the arguments of the last one.
  [[nodiscard]] std::size_t stack_used() const;

 private:
  class Engine;

  const ElfImage& image_;
  std::unique_ptr<Engine> engine_;
  std::uint32_t stack_bottom_;
  std::uint32_t stack_top_;
  std::uint32_t stack_at_call_;
};

}  // namespace proleg::cortex_m
