#include "tests/cortex_m/code_audit.hpp"

#include <algorithm>
#include <array>

#include "sim/mcu/cpu/thumb.hpp"

namespace proleg::cortex_m {

using sim::halfword_at;
using sim::instruction_size;
using sim::is_coprocessor_instruction;

std::vector<std::string> coprocessor_instructions(const ElfImage& image, const std::vector<ElfImage::Code>& code) {
  std::vector<std::string> found;
  for (const ElfImage::Code& stretch : code) {
    std::size_t offset = 0;
    while (offset + 1 < stretch.bytes.size()) {
      const std::uint16_t halfword = halfword_at(stretch.bytes, offset);
      if (is_coprocessor_instruction(halfword)) {
        found.push_back(image.describe(stretch.address + static_cast<std::uint32_t>(offset)));
      }
      offset += instruction_size(halfword);
    }
  }
  return found;
}

bool is_floating_point_helper(std::string_view name) {
  constexpr std::array<std::string_view, 9> beginnings{"__aeabi_d",   "__aeabi_f",   "__aeabi_cd",
                                                       "__aeabi_cf",  "__aeabi_h2f", "__aeabi_i2",
                                                       "__aeabi_ui2", "__aeabi_l2",  "__aeabi_ul2"};
  if (std::any_of(beginnings.begin(), beginnings.end(),
                  [&](std::string_view prefix) { return name.starts_with(prefix); })) {
    return true;
  }
  // libgcc: __adddf3, __mulsf3, __fixdfsi, __floatsidf and so on name the format df or sf.
  return name.starts_with("__") &&
         (name.find("df") != std::string_view::npos || name.find("sf") != std::string_view::npos);
}

bool is_heap_function(std::string_view name) {
  constexpr std::array<std::string_view, 9> names{"malloc",  "calloc",     "realloc",   "free", "_malloc_r",
                                                  "_free_r", "_realloc_r", "_calloc_r", "_sbrk"};
  // operator new and operator delete
  return std::find(names.begin(), names.end(), name) != names.end() || name.starts_with("_Zn") ||
         name.starts_with("_Zd");
}

}  // namespace proleg::cortex_m
