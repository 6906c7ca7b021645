#pragma once

// The number of instructions of a block of translated code, and its special ones.

#include <cstdint>
#include <cstdlib>
#include <map>
#include <memory>
#include <optional>
#include <span>

namespace proleg::sim {

/// A stretch of code that is executed from its begin to its end, as Unicorn cuts it: at most 512 instructions.
struct CodeBlock {
  std::uint16_t size = 0;  ///< bytes
  std::uint16_t instructions : 10 = 0;
  std::uint16_t ends_in_wfi : 1 = 0;
  std::uint16_t ends_in_wfe : 1 = 0;
  std::uint16_t has_sev : 1 = 0;
  std::uint16_t has_coprocessor_instruction : 1 = 0;  ///< the FPU's
};

/// Reads the code of a block.
[[nodiscard]] CodeBlock examine_block(std::span<const std::uint8_t> code);

/// The known blocks of one memory. It is read before every block that is executed, by many chips in turn: so an entry
/// has two bytes, and the few blocks that do not fit are stored elsewhere.
class BlockCounter {
 public:
  /// start, size: of the memory, in bytes.
  BlockCounter(std::uint32_t start, std::uint32_t size);

  /// The block of this size at an address of the memory; nothing if it is not known yet.
  [[nodiscard]] std::optional<CodeBlock> find(std::uint32_t address, std::uint32_t size) const {
    const Entry entry = entries_.get()[(address - start_) / 2];
    if (size == entry.halfwords * 2U) {
      CodeBlock block;
      block.size = static_cast<std::uint16_t>(size);
      block.instructions = entry.instructions;
      return block;
    }
    return entry.halfwords == elsewhere ? find_elsewhere(address, size) : std::nullopt;
  }
  void add(std::uint32_t address, const CodeBlock& block);

  /// Discards the blocks that touch these addresses.
  void discard(std::uint32_t address, std::uint32_t size);

 private:
  static constexpr std::uint8_t elsewhere = 0xFF;
  /// A block without anything special. All 0: none is known.
  struct Entry {
    std::uint8_t halfwords;
    std::uint8_t instructions;
  };
  struct Free {
    void operator()(Entry* entries) const { std::free(entries); }
  };

  [[nodiscard]] std::optional<CodeBlock> find_elsewhere(std::uint32_t address, std::uint32_t size) const;

  std::uint32_t start_;
  std::uint32_t count_;
  // One for each halfword. From calloc, so that pages without code take no memory.
  std::unique_ptr<Entry, Free> entries_;
  std::map<std::uint32_t, CodeBlock> others_;  ///< by address
};

}  // namespace proleg::sim
