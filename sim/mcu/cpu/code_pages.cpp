#include "sim/mcu/cpu/code_pages.hpp"

#include <algorithm>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <utility>

#include "sim/mcu/cpu/cpu_surroundings.hpp"
#include "sim/mcu/cpu/thumb.hpp"

namespace proleg::sim {
namespace {

/// memory: CodePage::reach bytes.
std::shared_ptr<const CodePage> decoded(const InstructionSet& instructions, std::uint32_t address,
                                        std::span<const std::uint8_t> memory) {
  auto page = std::make_shared<CodePage>();
  const auto outside = std::span(page->instructions).first(CodePage::slots);
  const auto in_it_block = std::span(page->instructions).subspan(CodePage::slots);
  for (std::uint32_t i = 0; i < CodePage::size / 2; ++i) {
    Encoding code{address + 2 * i, halfword_at(memory, 2 * i), halfword_at(memory, 2 * i + 2), false, address, memory};
    outside[i] = instructions.decode(code);
    code.in_it_block = true;
    in_it_block[i] = instructions.decode(code);
  }
  for (std::uint32_t i = CodePage::size / 2; i < CodePage::slots; ++i) {
    outside[i] = in_it_block[i] = instructions.continuation(address + 2 * i);
  }
  for (Instruction& first : outside.first(CodePage::size / 2)) {
    if (const Execute both = instructions.joined(first, *after(first)); both != nullptr) {
      first.execute = both;
    }
  }
  return page;
}

/// The page of this memory, which all chips share.
std::shared_ptr<const CodePage> shared_page(const InstructionSet& instructions, std::uint32_t address,
                                            std::span<const std::uint8_t> memory) {
  static std::mutex mutex;
  static std::map<std::pair<std::uint32_t, std::string>, std::weak_ptr<const CodePage>> pages;
  const std::pair key(address, std::string(memory.begin(), memory.end()));
  const std::scoped_lock lock(mutex);
  const auto found = pages.find(key);
  if (found != pages.end()) {
    if (std::shared_ptr<const CodePage> page = found->second.lock()) {
      return page;
    }
  }
  // Those of a flash that has changed, and of chips that are gone.
  std::erase_if(pages, [](const auto& page) { return page.second.expired(); });
  const std::shared_ptr<const CodePage> page = decoded(instructions, address, memory);
  pages[key] = page;
  return page;
}

}  // namespace

CodePages::CodePages(std::span<const std::uint8_t> flash, const InstructionSet& instructions)
    : flash_(flash), instructions_(&instructions), pages_(flash.size() / CodePage::size), owned_(pages_.size()) {}

const CodePage& CodePages::decode(std::uint32_t number) {
  const std::uint32_t offset = number * CodePage::size;
  std::array<std::uint8_t, CodePage::reach> memory;
  memory.fill(0xFF);  // behind the flash
  const auto contents = flash_.subspan(offset, std::min<std::size_t>(memory.size(), flash_.size() - offset));
  std::copy(contents.begin(), contents.end(), memory.begin());
  owned_[number] = shared_page(*instructions_, ChipMemory::flash_start + offset, memory);
  pages_[number] = owned_[number].get();
  return *pages_[number];
}

void CodePages::discard(std::uint32_t offset, std::uint32_t size) {
  const std::uint32_t first = offset < CodePage::reach ? 0 : (offset - CodePage::reach) / CodePage::size + 1;
  const std::uint32_t last = (offset + size - 1) / CodePage::size;
  for (std::uint32_t page = first; page <= last && page < pages_.size(); ++page) {
    pages_[page] = nullptr;
    owned_[page].reset();
  }
}

}  // namespace proleg::sim
