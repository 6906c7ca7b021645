#include "sim/mcu/cpu/back_trace.hpp"

#include <dwarf.h>
#include <elfutils/libdw.h>
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <optional>
#include <stdexcept>
#include <string_view>

#include "sim/mcu/cpu/cpu_surroundings.hpp"
#include "sim/mcu/cpu/elf_image.hpp"

namespace proleg::sim {
namespace {

constexpr unsigned dwarf_sp = 13;
constexpr unsigned dwarf_lr = 14;
constexpr unsigned dwarf_pc = 15;
constexpr std::uint32_t return_to_process_stack = 4;
constexpr std::uint32_t frame_without_fpu = 0x10;

bool is_exc_return(std::uint32_t address) { return address >= 0xFFFF'FF00 && address != 0xFFFF'FFFF; }

using Registers = std::array<std::uint32_t, 16>;

/// A word of memory; nothing where there is none.
std::optional<std::uint32_t> word_at(const ReadMemory& read, std::uint32_t address) {
  std::array<std::uint8_t, 4> bytes{};
  try {
    read(address, bytes);
  } catch (const std::out_of_range&) {
    return std::nullopt;
  }
  return bytes[0] | std::uint32_t{bytes[1]} << 8U | std::uint32_t{bytes[2]} << 16U | std::uint32_t{bytes[3]} << 24U;
}

/// The result of an expression of the call frame information: a place in memory, a register or the value itself.
std::optional<std::uint32_t> evaluate(std::span<const Dwarf_Op> operations, const Registers& registers,
                                      std::optional<std::uint32_t> frame_address, bool is_address,
                                      const ReadMemory& read) {
  std::vector<std::uint32_t> stack;
  const auto pop = [&]() -> std::uint32_t {
    if (stack.empty()) {
      return 0;
    }
    const std::uint32_t value = stack.back();
    stack.pop_back();
    return value;
  };
  bool is_value = is_address;
  for (const Dwarf_Op& operation : operations) {
    const auto number = static_cast<std::uint32_t>(operation.number);
    if (operation.atom >= DW_OP_breg0 && operation.atom <= DW_OP_breg15) {
      stack.push_back(registers[operation.atom - DW_OP_breg0] + number);
    } else if (operation.atom >= DW_OP_reg0 && operation.atom <= DW_OP_reg15) {
      stack.push_back(registers[operation.atom - DW_OP_reg0]);
      is_value = true;
    } else if (operation.atom >= DW_OP_lit0 && operation.atom <= DW_OP_lit31) {
      stack.push_back(operation.atom - DW_OP_lit0);
    } else {
      switch (operation.atom) {
        case DW_OP_bregx:
          if (operation.number >= registers.size()) {
            return std::nullopt;
          }
          stack.push_back(registers[operation.number] + static_cast<std::uint32_t>(operation.number2));
          break;
        case DW_OP_regx:
          if (operation.number >= registers.size()) {
            return std::nullopt;
          }
          stack.push_back(registers[operation.number]);
          is_value = true;
          break;
        case DW_OP_call_frame_cfa:
          if (!frame_address) {
            return std::nullopt;
          }
          stack.push_back(*frame_address);
          break;
        case DW_OP_const1u:
        case DW_OP_const1s:
        case DW_OP_const2u:
        case DW_OP_const2s:
        case DW_OP_const4u:
        case DW_OP_const4s:
        case DW_OP_constu:
        case DW_OP_consts:
          stack.push_back(number);
          break;
        case DW_OP_plus_uconst:
          stack.push_back(pop() + number);
          break;
        case DW_OP_plus: {
          const std::uint32_t second = pop();
          stack.push_back(pop() + second);
          break;
        }
        case DW_OP_minus: {
          const std::uint32_t second = pop();
          stack.push_back(pop() - second);
          break;
        }
        case DW_OP_and: {
          const std::uint32_t second = pop();
          stack.push_back(pop() & second);
          break;
        }
        case DW_OP_deref: {
          const std::optional<std::uint32_t> word = word_at(read, pop());
          if (!word) {
            return std::nullopt;
          }
          stack.push_back(*word);
          break;
        }
        case DW_OP_stack_value:
          is_value = true;
          break;
        default:
          return std::nullopt;
      }
    }
  }
  if (stack.empty()) {
    return std::nullopt;
  }
  return is_value ? std::optional(stack.back()) : word_at(read, stack.back());
}

}  // namespace

class BackTracer::Implementation {
 public:
  explicit Implementation(const std::filesystem::path& file) : image_(file) {
    descriptor_ = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor_ >= 0) {
      debug_information_ = dwarf_begin(descriptor_, DWARF_C_READ);
      if (debug_information_ != nullptr) {
        frame_information_ = dwarf_getcfi(debug_information_);
      }
    }
  }

  ~Implementation() {
    // The frame information belongs to the debug information.
    if (debug_information_ != nullptr) {
      dwarf_end(debug_information_);
    }
    if (descriptor_ >= 0) {
      ::close(descriptor_);
    }
  }

  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  [[nodiscard]] std::string describe(std::uint32_t address, std::uint32_t looked_up) const {
    std::string text = image_.describe(address);
    if (const std::string line = line_of(looked_up); !line.empty()) {
      text += ", " + line;
    }
    return text;
  }

  [[nodiscard]] std::vector<CallFrame> trace(std::span<const std::uint32_t, 17> given, const ReadMemory& read) const {
    std::vector<CallFrame> frames;
    Registers registers{};
    std::copy_n(given.begin(), registers.size(), registers.begin());
    unsigned exception = given[16] & exception_number_mask;
    bool is_return_address = false;
    while (frames.size() < max_frames) {
      const std::uint32_t address = registers[dwarf_pc] & ~1U;
      // A return address may be the first of the next function.
      const std::uint32_t looked_up = is_return_address ? address - 2 : address;
      frames.push_back({address, 0, describe(address, looked_up)});
      const std::uint32_t old_sp = registers[dwarf_sp];
      if (!go_to_caller(registers, looked_up, read)) {
        if (frames.size() > 1 || registers[dwarf_pc] == registers[dwarf_lr]) {
          break;
        }
        // The place is not known, or has no code at all: treats the function as just called.
        registers[dwarf_pc] = registers[dwarf_lr];
      } else if (registers[dwarf_sp] < old_sp ||
                 (registers[dwarf_sp] == old_sp && frames.size() > 1 && is_return_address)) {
        break;
      }
      is_return_address = true;
      if (is_exc_return(registers[dwarf_pc])) {
        frames.back().exception = exception;
        const std::optional<std::uint32_t> flags = leave_exception(registers, read);
        if (!flags) {
          break;
        }
        exception = *flags & exception_number_mask;
        is_return_address = false;
      } else if (!is_code(registers[dwarf_pc])) {
        break;
      }
    }
    return frames;
  }

 private:
  [[nodiscard]] bool is_code(std::uint32_t address) const {
    return std::ranges::any_of(image_.symbols(), [&](const ElfImage::Symbol& symbol) {
      return symbol.is_function && (address & ~1U) - symbol.address <= symbol.size;
    });
  }

  /// Replaces the registers by those of the calling function. False: not known.
  bool go_to_caller(Registers& registers, std::uint32_t address, const ReadMemory& read) const {
    if (frame_information_ == nullptr) {
      return false;
    }
    Dwarf_Frame* frame = nullptr;
    if (dwarf_cfi_addrframe(frame_information_, address, &frame) != 0) {
      return false;
    }
    const std::unique_ptr<Dwarf_Frame, decltype(&std::free)> owner(frame, &std::free);
    Dwarf_Op* operations = nullptr;
    std::size_t count = 0;
    if (dwarf_frame_cfa(frame, &operations, &count) != 0) {
      return false;
    }
    const auto frame_address = evaluate({operations, count}, registers, std::nullopt, true, read);
    if (!frame_address) {
      return false;
    }
    Registers caller = registers;
    caller[dwarf_sp] = *frame_address;
    for (unsigned i = 0; i <= dwarf_lr; ++i) {
      std::array<Dwarf_Op, 3> memory{};
      if (i == dwarf_sp || dwarf_frame_register(frame, static_cast<int>(i), memory.data(), &operations, &count) != 0) {
        continue;
      }
      if (count == 0) {  // unchanged, or lost; the outermost function has no return address
        if (i == dwarf_lr && operations == memory.data()) {
          return false;
        }
        continue;
      }
      if (const auto value = evaluate({operations, count}, registers, frame_address, false, read)) {
        caller[i] = *value;
      } else if (i == dwarf_lr) {
        return false;
      }
    }
    caller[dwarf_pc] = caller[dwarf_lr];
    registers = caller;
    return true;
  }

  /// Replaces the registers by those that the exception's entry saved. Returns the xPSR; nothing if it is not known.
  static std::optional<std::uint32_t> leave_exception(Registers& registers, const ReadMemory& read) {
    const std::uint32_t exc_return = registers[dwarf_pc];
    if ((exc_return & return_to_process_stack) != 0 || (exc_return & frame_without_fpu) == 0) {
      return std::nullopt;
    }
    std::array<std::uint32_t, 8> saved{};
    for (std::uint32_t i = 0; i < saved.size(); ++i) {
      const std::optional<std::uint32_t> word = word_at(read, registers[dwarf_sp] + 4 * i);
      if (!word) {
        return std::nullopt;
      }
      saved[i] = *word;
    }
    std::copy_n(saved.begin(), 4, registers.begin());
    registers[12] = saved[4];
    registers[dwarf_lr] = saved[5];
    registers[dwarf_pc] = saved[6];
    registers[dwarf_sp] += frame_size + ((saved[7] & frame_was_aligned) != 0 ? 4U : 0U);
    return saved[7];
  }

  /// "file.cpp:12"; empty if it is not known.
  [[nodiscard]] std::string line_of(std::uint32_t address) const {
    if (debug_information_ == nullptr) {
      return {};
    }
    Dwarf_Die unit;
    if (dwarf_addrdie(debug_information_, address, &unit) == nullptr && !find_unit(address, unit)) {
      return {};
    }
    Dwarf_Line* const line = dwarf_getsrc_die(&unit, address);
    int number = 0;
    const char* const file = line == nullptr ? nullptr : dwarf_linesrc(line, nullptr, nullptr);
    if (file == nullptr || dwarf_lineno(line, &number) != 0) {
      return {};
    }
    // Leaves out the folder of the build.
    std::string_view name = file;
    Dwarf_Attribute attribute;
    const char* const folder = dwarf_formstring(dwarf_attr(&unit, DW_AT_comp_dir, &attribute));
    if (folder != nullptr && name.starts_with(folder)) {
      name.remove_prefix(std::string_view(folder).size());
      name.remove_prefix(std::min(name.find_first_not_of('/'), name.size()));
    }
    return std::string(name) + ":" + std::to_string(number);
  }

  /// Searches all units, for images without a table of address ranges.
  bool find_unit(std::uint32_t address, Dwarf_Die& unit) const {
    Dwarf_Off offset = 0;
    Dwarf_Off next = 0;
    std::size_t header_size = 0;
    while (dwarf_nextcu(debug_information_, offset, &next, &header_size, nullptr, nullptr, nullptr) == 0) {
      if (dwarf_offdie(debug_information_, offset + header_size, &unit) != nullptr &&
          dwarf_haspc(&unit, address) == 1) {
        return true;
      }
      offset = next;
    }
    return false;
  }

  ElfImage image_;
  int descriptor_ = -1;
  Dwarf* debug_information_ = nullptr;
  Dwarf_CFI* frame_information_ = nullptr;
};

BackTracer::BackTracer(const std::filesystem::path& image) : implementation_(std::make_unique<Implementation>(image)) {}

BackTracer::~BackTracer() = default;

std::string BackTracer::describe(std::uint32_t address) const {
  return implementation_->describe(address & ~1U, address & ~1U);
}

std::vector<CallFrame> BackTracer::trace(std::span<const std::uint32_t, 17> registers, const ReadMemory& read) const {
  return implementation_->trace(registers, read);
}

std::vector<std::string> trace_back(const std::filesystem::path& image, std::span<const std::uint32_t, 17> registers,
                                    const ReadMemory& read) {
  std::vector<std::string> lines;
  for (const CallFrame& frame : BackTracer(image).trace(registers, read)) {
    lines.push_back(frame.text);
    if (frame.exception != 0) {
      lines.push_back("exception " + std::to_string(frame.exception) +
                      (frame.exception >= 16 ? " (interrupt " + std::to_string(frame.exception - 16) + ")" : "") +
                      ", which came in");
    }
  }
  return lines;
}

}  // namespace proleg::sim
