#include "sim/mcu/cpu/block_counter.hpp"

#include <algorithm>
#include <cstring>
#include <new>

#include "sim/mcu/cpu/thumb.hpp"

namespace proleg::sim {
namespace {

constexpr std::uint16_t wait_for_event = 0xBF20;
constexpr std::uint16_t wait_for_interrupt = 0xBF30;
constexpr std::uint16_t send_event = 0xBF40;
constexpr std::uint32_t max_block_bytes = 512 * 4;

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
    : start_(start), count_(size / 2), entries_(static_cast<Entry*>(std::calloc(count_, sizeof(Entry)))) {
  if (!entries_) {
    throw std::bad_alloc();
  }
}

void BlockCounter::add(std::uint32_t address, const CodeBlock& block) {
  const bool is_special = block.ends_in_wfi || block.ends_in_wfe || block.has_sev || block.has_coprocessor_instruction;
  Entry& entry = entries_.get()[(address - start_) / 2];
  if (is_special || block.size / 2 >= elsewhere) {
    entry = {elsewhere, 0};
    others_[address] = block;
  } else {
    entry = {static_cast<std::uint8_t>(block.size / 2), static_cast<std::uint8_t>(block.instructions)};
  }
}

std::optional<CodeBlock> BlockCounter::find_special(std::uint32_t address, std::uint32_t size) const {
  const auto found = others_.find(address);
  return found != others_.end() && found->second.size == size ? std::optional(found->second) : std::nullopt;
}

void BlockCounter::discard(std::uint32_t address, std::uint32_t size) {
  const std::uint32_t offset = address - start_;
  const std::uint32_t first = offset < max_block_bytes ? 0 : (offset - max_block_bytes) / 2;
  const std::uint32_t last = std::min(count_, (offset + size + 1) / 2);
  std::memset(static_cast<void*>(entries_.get() + first), 0, (last - first) * sizeof(Entry));
  others_.erase(others_.lower_bound(start_ + 2 * first), others_.lower_bound(start_ + 2 * last));
}

}  // namespace proleg::sim
