#include "tests/identity/verify/forbidden_symbols.hpp"

#include <algorithm>
#include <array>
#include <sstream>

#include "tests/cortex_m/code_audit.hpp"

namespace proleg::verify {
namespace {

/// Of the compiler, for whole numbers and memory.
constexpr std::array<std::string_view, 12> helpers{"memcpy",
                                                   "memset",
                                                   "memmove",
                                                   "memcmp",
                                                   "__aeabi_memcpy",
                                                   "__aeabi_memset",
                                                   "__aeabi_memmove",
                                                   "__aeabi_memclr",
                                                   "__aeabi_memclr4",
                                                   "__aeabi_memcpy4",
                                                   "__cxa_pure_virtual",
                                                   "__gnu_thumb1_case"};
constexpr std::array<std::string_view, 7> arithmetic{"__aeabi_l",         "__aeabi_ul", "__aeabi_i", "__aeabi_ui",
                                                     "__gnu_thumb1_case", "__clz",      "__popcount"};

bool is_of_the_core(std::string_view name) {
  return name.starts_with("proleg::") || name.starts_with("vtable for proleg::") ||
         name.starts_with("non-virtual thunk to proleg::");
}

bool is_helper(std::string_view name) {
  return std::ranges::find(helpers, name) != helpers.end() ||
         std::ranges::any_of(arithmetic, [&](std::string_view start) { return name.starts_with(start); });
}

}  // namespace

std::vector<std::string> forbidden_symbols(std::string_view listing) {
  std::vector<std::string> found;
  std::istringstream lines{std::string(listing)};
  for (std::string line; std::getline(lines, line);) {
    // "00000000 T name", or "         U name"
    constexpr std::size_t letter = 9;
    if (line.size() < letter + 3 || line[letter - 1] != ' ' || line[letter + 1] != ' ') {
      continue;
    }
    const std::string name = line.substr(letter + 2);
    switch (line[letter]) {
      case 'U':
        if (cortex_m::is_floating_point_helper(name)) {
          found.push_back("uses floating point (" + name + ")");
        } else if (cortex_m::is_heap_function(name) || name.starts_with("operator new") ||
                   name.starts_with("operator delete")) {
          found.push_back("uses the heap (" + name + ")");
        } else if (!is_of_the_core(name) && !is_helper(name)) {
          found.push_back("uses " + name + ", which is not of the core");
        }
        break;
      case 'B':
      case 'C':
      case 'D':
      case 'b':
      case 'd':
        found.push_back("keeps a value in the variable " + name + "; that belongs into an internal value");
        break;
      default:
        break;
    }
  }
  return found;
}

std::optional<std::uint32_t> flash_bytes(std::string_view sizes) {
  // "   text    data     bss     dec     hex filename", and the numbers below
  std::istringstream lines{std::string(sizes)};
  std::string titles;
  std::getline(lines, titles);
  std::uint32_t code = 0;
  std::uint32_t data = 0;
  if (lines >> code >> data) {
    return code + data;
  }
  return std::nullopt;
}

}  // namespace proleg::verify
