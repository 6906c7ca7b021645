#pragma once

// The number of instructions of a block of translated code, and its special ones.

#include <array>
#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

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

/// The known blocks of a stretch of memory, by their begin. All chips in which the stretch has the same contents share
/// it, also on several threads: it is read before every block that is executed, and 20 tables of their own would
/// displace each other from the processor's cache.
struct BlockPage {
  static constexpr std::uint32_t size = 1024;  ///< bytes
  /// Its blocks may end this many bytes behind it.
  static constexpr std::uint32_t overlap = 512;

  /// Bits 0 to 7: halfwords of the block; bits 8 to 15: instructions. 0: not known.
  std::array<std::atomic<std::uint16_t>, size / 2> entries{};
};

/// The known blocks of one memory. The few that are special or long are not shared.
class BlockCounter {
 public:
  /// start, size: of the memory, in bytes; multiples of BlockPage::size.
  BlockCounter(std::uint32_t start, std::uint32_t size);

  /// The number of instructions of the block of this size at an address of the memory; 0 if it is not known yet, or
  /// special.
  [[nodiscard]] unsigned find_plain(std::uint32_t address, std::uint32_t size) const {
    const std::uint32_t offset = address - start_;
    const std::uint16_t entry =
        pages_[offset / BlockPage::size]->entries[offset % BlockPage::size / 2].load(std::memory_order_relaxed);
    return size == (entry & 0xFFU) * 2U ? unsigned{entry} >> 8U : 0U;
  }
  /// A block that find_plain() does not find; nothing if it is not known yet.
  [[nodiscard]] std::optional<CodeBlock> find_special(std::uint32_t address, std::uint32_t size) const;
  /// memory: the contents of the block's page and of the overlap behind it.
  void add(std::uint32_t address, const CodeBlock& block, std::span<const std::uint8_t> memory);
  /// The address and size of this `memory`.
  [[nodiscard]] std::pair<std::uint32_t, std::uint32_t> memory_for(std::uint32_t address) const;

  /// Discards the blocks that touch these addresses, and others close to them.
  void discard(std::uint32_t address, std::uint32_t size);

 private:
  [[nodiscard]] std::uint32_t end() const {
    return start_ + BlockPage::size * static_cast<std::uint32_t>(pages_.size());
  }

  std::uint32_t start_;
  std::vector<BlockPage*> pages_;                  ///< by offset; an empty one if none of its blocks is known
  std::vector<std::shared_ptr<BlockPage>> owned_;  ///< the same; null for the empty one
  std::map<std::uint32_t, CodeBlock> others_;      ///< by address
};

}  // namespace proleg::sim
