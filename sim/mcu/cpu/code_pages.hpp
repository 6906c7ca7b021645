#pragma once

// Decoded instructions of a flash.

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sim/mcu/cpu/instruction.hpp"

namespace proleg::sim {

/// What may be executed in a stretch of the flash: an instruction for each halfword, as it is outside IT blocks and in
/// one. It never changes. All chips in which the stretch and the one behind it have the same contents share it, also on
/// several threads: 20 copies would displace each other from the processor's cache.
struct CodePage {
  static constexpr std::uint32_t size = 1024;  ///< bytes
  /// Bytes from its begin on which its instructions depend: a word that they load can be in the next page.
  static constexpr std::uint32_t reach = 2 * size;
  /// Number of instructions in each half of the array. The last two lead to the next page, behind an instruction of two
  /// bytes and of four.
  static constexpr std::uint32_t slots = size / 2 + 2;

  std::array<Instruction, 2 * slots> instructions;  ///< those in IT blocks behind the others
};

class CodePages {
 public:
  /// Both must outlive it.
  CodePages(std::span<const std::uint8_t> flash, const InstructionSet& instructions);

  /// The instruction at an even offset.
  [[nodiscard]] const Instruction* at(std::uint32_t offset, bool in_it_block) {
    const CodePage* page = pages_[offset / CodePage::size];
    if (page == nullptr) [[unlikely]] {
      page = &decode(offset / CodePage::size);
    }
    return &page->instructions[offset % CodePage::size / 2 + (in_it_block ? CodePage::slots : 0)];
  }

  /// The contents have changed there. No instruction of a page that depends on them may be in use.
  void discard(std::uint32_t offset, std::uint32_t size);

 private:
  const CodePage& decode(std::uint32_t number);

  std::span<const std::uint8_t> flash_;
  const InstructionSet* instructions_;
  std::vector<const CodePage*> pages_;                  ///< null if none of its instructions was executed yet
  std::vector<std::shared_ptr<const CodePage>> owned_;  ///< the same
};

}  // namespace proleg::sim
