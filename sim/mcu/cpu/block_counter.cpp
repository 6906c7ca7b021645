#include "sim/mcu/cpu/block_counter.hpp"

#include <algorithm>
#include <functional>
#include <mutex>
#include <string>

#include "sim/mcu/cpu/thumb.hpp"

namespace proleg::sim {
namespace {

constexpr std::uint16_t wait_for_event = 0xBF20;
constexpr std::uint16_t wait_for_interrupt = 0xBF30;
constexpr std::uint16_t send_event = 0xBF40;
constexpr std::uint32_t max_block_bytes = 512 * 4;
constexpr std::uint32_t max_plain_bytes = BlockPage::overlap - 2;

/// In place of a page of which no block is known. Never changed.
BlockPage* no_blocks() {
  static BlockPage page;
  return &page;
}

/// The page of this memory, which all chips share.
std::shared_ptr<BlockPage> shared_page(std::span<const std::uint8_t> memory) {
  static std::mutex mutex;
  static std::map<std::string, std::weak_ptr<BlockPage>, std::less<>> pages;
  const std::string contents(memory.begin(), memory.end());
  const std::scoped_lock lock(mutex);
  const auto found = pages.find(contents);
  if (found != pages.end()) {
    if (std::shared_ptr<BlockPage> page = found->second.lock()) {
      return page;
    }
  }
  // Those of a flash that has changed, and of chips that are gone.
  std::erase_if(pages, [](const auto& page) { return page.second.expired(); });
  const auto page = std::make_shared<BlockPage>();
  pages[contents] = page;
  return page;
}

}  // namespace

CodeBlock examine_block(std::span<const std::uint8_t> code) {
  CodeBlock block;
  block.size = static_cast<std::uint16_t>(code.size());
  std::uint16_t last = 0;
  std::uint16_t count = 0;
  for (std::size_t offset = 0; offset + 1 < code.size(); offset += instruction_size(last)) {
    last = halfword_at(code, offset);
    ++count;
    if (last == send_event) {
      block.has_sev = true;
    }
    if (is_coprocessor_instruction(last)) {
      block.has_coprocessor_instruction = true;
    }
  }
  block.instructions = count;
  block.ends_in_wfi = last == wait_for_interrupt;
  block.ends_in_wfe = last == wait_for_event;
  return block;
}

BlockCounter::BlockCounter(std::uint32_t start, std::uint32_t size)
    : start_(start), pages_(size / BlockPage::size, no_blocks()), owned_(size / BlockPage::size) {}

std::pair<std::uint32_t, std::uint32_t> BlockCounter::memory_for(std::uint32_t address) const {
  const std::uint32_t begin = address - (address - start_) % BlockPage::size;
  return {begin, std::min(BlockPage::size + BlockPage::overlap, end() - begin)};
}

void BlockCounter::add(std::uint32_t address, const CodeBlock& block, std::span<const std::uint8_t> memory) {
  const bool is_special = block.ends_in_wfi || block.ends_in_wfe || block.has_sev || block.has_coprocessor_instruction;
  if (is_special || block.size >= max_plain_bytes) {
    others_[address] = block;
    return;
  }
  const std::uint32_t page = (address - start_) / BlockPage::size;
  if (!owned_[page]) {
    owned_[page] = shared_page(memory);
    pages_[page] = owned_[page].get();
  }
  const auto entry = static_cast<std::uint16_t>(block.size / 2U | unsigned{block.instructions} << 8U);
  pages_[page]->entries.at((address - start_) % BlockPage::size / 2).store(entry, std::memory_order_relaxed);
}

std::optional<CodeBlock> BlockCounter::find_special(std::uint32_t address, std::uint32_t size) const {
  const auto found = others_.find(address);
  return found != others_.end() && found->second.size == size ? std::optional(found->second) : std::nullopt;
}

void BlockCounter::discard(std::uint32_t address, std::uint32_t size) {
  const std::uint32_t offset = address - start_;
  const std::uint32_t first = offset - std::min(offset, max_block_bytes);
  const std::uint32_t last = std::min(offset + size, end() - start_);
  for (std::uint32_t page = first / BlockPage::size; page * BlockPage::size < last; ++page) {
    owned_[page].reset();
    pages_[page] = no_blocks();
  }
  others_.erase(others_.lower_bound(start_ + first), others_.lower_bound(start_ + last));
}

}  // namespace proleg::sim
