#include "sim/mcu/cpu/thumb.hpp"

#include <bit>

namespace proleg::sim {
namespace {

constexpr unsigned r_sp = 13;
constexpr unsigned r_pc = 15;

unsigned field(std::uint16_t halfword, unsigned lowest, unsigned width) {
  return (static_cast<unsigned>(halfword) >> lowest) & ((1U << width) - 1U);
}

/// A decoder for one instruction.
class Access {
 public:
  Access(std::uint16_t first, std::uint16_t second, std::span<const std::uint32_t, 16> registers)
      : first_(first), second_(second), registers_(registers) {}

  std::optional<MemoryAccess> narrow() const {
    switch (first_ >> 11U) {
      case 0b01001:
        return literal(true, field(first_, 0, 8) * 4, 4);
      case 0b01010:
      case 0b01011:
        return register_offset();
      case 0b01100:
      case 0b01101:
        return immediate(field(first_, 3, 3), field(first_, 6, 5) * 4, 4, is_clear(11));
      case 0b01110:
      case 0b01111:
        return immediate(field(first_, 3, 3), field(first_, 6, 5), 1, is_clear(11));
      case 0b10000:
      case 0b10001:
        return immediate(field(first_, 3, 3), field(first_, 6, 5) * 2, 2, is_clear(11));
      case 0b10010:
      case 0b10011:
        return immediate(r_sp, field(first_, 0, 8) * 4, 4, is_clear(11));
      case 0b11000:
      case 0b11001:
        return several(field(first_, 8, 3), field(first_, 0, 8), false, is_clear(11));
      default:
        break;
    }
    if ((first_ & 0xFE00U) == 0xB400U) {
      return several(r_sp, field(first_, 0, 9), true, true);
    }
    if ((first_ & 0xFE00U) == 0xBC00U) {
      return several(r_sp, field(first_, 0, 9), false, false);
    }
    return std::nullopt;
  }

  std::optional<MemoryAccess> wide() const {
    if ((first_ & 0xFE40U) == 0xE800U) {
      return several(base(), second_, (first_ & 0x0100U) != 0, is_clear(4));
    }
    if ((first_ & 0xFE40U) == 0xE840U) {
      return double_or_exclusive();
    }
    if ((first_ & 0xFE00U) == 0xF800U) {
      return single();
    }
    if ((first_ & 0xEE00U) == 0xEC00U) {
      return floating_point();
    }
    return std::nullopt;
  }

 private:
  [[nodiscard]] bool is_clear(unsigned number) const { return field(first_, number, 1) == 0; }
  [[nodiscard]] unsigned base() const { return field(first_, 0, 4); }

  [[nodiscard]] std::optional<MemoryAccess> immediate(unsigned base, std::uint32_t offset, std::uint32_t size,
                                                      bool is_store) const {
    return MemoryAccess{registers_[base] + offset, size, is_store};
  }

  [[nodiscard]] std::optional<MemoryAccess> literal(bool add, std::uint32_t offset, std::uint32_t size) const {
    const std::uint32_t start = (registers_[r_pc] + 4) & ~3U;
    return MemoryAccess{add ? start + offset : start - offset, size, false};
  }

  [[nodiscard]] std::optional<MemoryAccess> register_offset() const {
    constexpr unsigned sizes[8]{4, 2, 1, 1, 4, 2, 1, 2};
    const unsigned operation = field(first_, 9, 3);
    const unsigned n = field(first_, 3, 3);
    const unsigned m = field(first_, 6, 3);
    return MemoryAccess{registers_[n] + registers_[m], sizes[operation], operation < 3};
  }

  [[nodiscard]] std::optional<MemoryAccess> several(unsigned base, unsigned list, bool downwards, bool is_store) const {
    const std::uint32_t size = 4U * static_cast<std::uint32_t>(std::popcount(list));
    return MemoryAccess{downwards ? registers_[base] - size : registers_[base], size, is_store};
  }

  [[nodiscard]] std::optional<MemoryAccess> double_or_exclusive() const {
    const bool before = !is_clear(8);
    const bool write_back = !is_clear(5);
    const std::uint32_t offset = field(second_, 0, 8) * 4;
    if (before || write_back) {  // LDRD, STRD
      const std::uint32_t start = registers_[base()];
      const std::uint32_t moved = is_clear(7) ? start - offset : start + offset;
      MemoryAccess access{before ? moved : start, 8, is_clear(4)};
      if (base() == r_pc) {
        access = {((start + 4) & ~3U) + (is_clear(7) ? 0U - offset : offset), 8, false};
      }
      return access;
    }
    if (is_clear(7)) {  // LDREX, STREX
      return immediate(base(), offset, 4, is_clear(4));
    }
    const unsigned operation = field(second_, 4, 4);
    if (operation < 2) {  // TBB, TBH
      const unsigned m = field(second_, 0, 4);
      const std::uint32_t table = base() == r_pc ? registers_[r_pc] + 4 : registers_[base()];
      return MemoryAccess{table + (registers_[m] << operation), 1U << operation, false};
    }
    return immediate(base(), 0, operation == 4 ? 1 : 2, is_clear(4));
  }

  [[nodiscard]] std::optional<MemoryAccess> single() const {
    if (field(first_, 5, 2) == 3) {
      return std::nullopt;
    }
    const std::uint32_t size = 1U << field(first_, 5, 2);
    const bool is_store = is_clear(4);
    const std::uint32_t long_offset = field(second_, 0, 12);
    if (base() == r_pc) {
      return literal(!is_clear(7), long_offset, size);
    }
    if (!is_clear(7)) {
      return immediate(base(), long_offset, size, is_store);
    }
    if ((second_ & 0x0800U) == 0) {
      const unsigned m = field(second_, 0, 4);
      return MemoryAccess{registers_[base()] + (registers_[m] << field(second_, 4, 2)), size, is_store};
    }
    const bool before = field(second_, 10, 1) != 0;
    const std::uint32_t offset = field(second_, 0, 8);
    const std::uint32_t signed_offset = field(second_, 9, 1) != 0 ? offset : 0U - offset;
    return immediate(base(), before ? signed_offset : 0U, size, is_store);
  }

  /// VLDR, VSTR, VLDM, VSTM.
  [[nodiscard]] std::optional<MemoryAccess> floating_point() const {
    const std::uint32_t offset = field(second_, 0, 8) * 4;
    const bool add = !is_clear(7);
    const bool is_store = is_clear(4);
    if (!is_clear(8) && is_clear(5)) {
      const std::uint32_t start = base() == r_pc ? (registers_[r_pc] + 4) & ~3U : registers_[base()];
      return MemoryAccess{add ? start + offset : start - offset, field(second_, 8, 1) != 0 ? 8U : 4U, is_store};
    }
    return MemoryAccess{add ? registers_[base()] : registers_[base()] - offset, offset, is_store};
  }

  std::uint16_t first_;
  std::uint16_t second_;
  std::span<const std::uint32_t, 16> registers_;
};

}  // namespace

std::optional<MemoryAccess> memory_access(std::uint16_t first, std::uint16_t second,
                                          std::span<const std::uint32_t, 16> registers) {
  const Access access(first, second, registers);
  return instruction_size(first) == 2 ? access.narrow() : access.wide();
}

}  // namespace proleg::sim
