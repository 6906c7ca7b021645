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
  std::uint16_t instructions = 0;
  bool ends_in_wfi = false;
  bool ends_in_wfe = false;
  bool has_sev = false;
  bool has_coprocessor_instruction = false;  ///< the FPU's
};

/// Reads the code of a block.
[[nodiscard]] CodeBlock examine_block(std::span<const std::uint8_t> code);

/// The known blocks of one memory. It is read before every block that is executed, by many chips in turn: so an entry
/// has two bytes, and the few blocks that do not fit are stored elsewhere.
class BlockCounter {
 public:
  /// start, size: of the memory, in bytes.
  BlockCounter(std::uint32_t start, std::uint32_t size);

  /// The number of instructions of the block of this size at an address of the memory; 0 if it is not known yet, or
  /// special.
  [[nodiscard]] unsigned find_plain(std::uint32_t address, std::uint32_t size) const {
    const Entry entry = entries_.get()[(address - start_) / 2];
    return size == entry.halfwords * 2U ? entry.instructions : 0U;
  }
  /// A block that find_plain() does not find; nothing if it is not known yet.
  [[nodiscard]] std::optional<CodeBlock> find_special(std::uint32_t address, std::uint32_t size) const;
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

  std::uint32_t start_;
  std::uint32_t count_;
  // One for each halfword. From calloc, so that pages without code take no memory.
  std::unique_ptr<Entry, Free> entries_;
  std::map<std::uint32_t, CodeBlock> others_;  ///< by address
};

}  // namespace proleg::sim
