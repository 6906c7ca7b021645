#include "shared/broadcast/block_decoder.hpp"

#include <cstring>

#include "shared/fixed/random.hpp"

namespace proleg::broadcast {
namespace {

void add(Symbol& sum, const Symbol& symbol) {
  for (std::size_t i = 0; i < symbol_size; ++i) {
    sum[i] ^= symbol[i];
  }
}

/// The lowest number in a set; block_symbols if the set is empty.
unsigned lowest(const SymbolSet& set) {
  for (unsigned i = 0; i < set.words.size(); ++i) {
    if (set.words[i] != 0) {
      return i * SymbolSet::word_bits + static_cast<unsigned>(std::countr_zero(set.words[i]));
    }
  }
  return block_symbols;
}

/// Calls `call` with each number in a set, in ascending order.
template <typename Call>
void for_each(const SymbolSet& set, Call call) {
  for (unsigned i = 0; i < set.words.size(); ++i) {
    for (std::uint32_t rest = set.words[i]; rest != 0; rest &= rest - 1U) {
      call(i * SymbolSet::word_bits + static_cast<unsigned>(std::countr_zero(rest)));
    }
  }
}

/// The exclusive or of symbols of a block. It adds four bytes at a time; the second four begin with the fourth byte.
class SymbolSum {
 public:
  void add(std::span<const std::uint8_t> bytes, unsigned number) {
    const std::size_t at = number * symbol_size;
    if (at + symbol_size > bytes.size()) {
      broadcast::add(last_, symbol_of(bytes, number));  // the last symbol of the block is not full
      return;
    }
    std::uint32_t first = 0;
    std::uint32_t second = 0;
    std::memcpy(&first, &bytes[at], sizeof(first));
    std::memcpy(&second, &bytes[at + overlap], sizeof(second));
    first_ ^= first;
    second_ ^= second;
  }
  [[nodiscard]] Symbol value() const {
    Symbol sum{};
    std::memcpy(sum.data(), &first_, sizeof(first_));
    std::memcpy(sum.data() + overlap, &second_, sizeof(second_));
    broadcast::add(sum, last_);
    return sum;
  }

 private:
  static constexpr std::size_t overlap = symbol_size - sizeof(std::uint32_t);

  std::uint32_t first_ = 0;
  std::uint32_t second_ = 0;
  Symbol last_{};
};

}  // namespace

Symbol symbol_of(std::span<const std::uint8_t> bytes, unsigned number) {
  const std::size_t at = number * symbol_size;
  Symbol symbol{};
  for (std::size_t i = 0; i < symbol_size && at + i < bytes.size(); ++i) {
    symbol[i] = bytes[at + i];
  }
  return symbol;
}

void put_symbol(std::span<std::uint8_t> bytes, unsigned number, const Symbol& symbol) {
  const std::size_t at = number * symbol_size;
  for (std::size_t i = 0; i < symbol_size && at + i < bytes.size(); ++i) {
    bytes[at + i] = symbol[i];
  }
}

SymbolSet repair_set(unsigned block, unsigned repair, unsigned symbols) {
  Pcg32 random(repair, block);
  SymbolSet set;
  for (unsigned i = 0; i * SymbolSet::word_bits < symbols; ++i) {
    const unsigned rest = symbols - i * SymbolSet::word_bits;
    const std::uint32_t mask = rest < SymbolSet::word_bits ? (1U << rest) - 1U : ~std::uint32_t{0};
    set.words[i] = random.next() & mask;
  }
  return set;
}

Symbol repair_symbol(std::span<const std::uint8_t> bytes, unsigned block, unsigned repair) {
  SymbolSum sum;
  for_each(repair_set(block, repair, symbols_of(bytes.size())), [&](unsigned number) { sum.add(bytes, number); });
  return sum.value();
}

void BlockDecoder::start(std::span<std::uint8_t> bytes, SymbolSet& received, unsigned block) {
  bytes_ = bytes;
  received_ = &received;
  block_ = block;
  missing_ = symbols_of(bytes.size()) - received.count();
  equations_ = 0;
}

bool BlockDecoder::add(unsigned repair, const Symbol& symbol) {
  if (missing_ == 0) {
    return true;
  }
  if (missing_ > max_missing) {
    return false;
  }
  Equation equation{repair_set(block_, repair, symbols_of(bytes_.size())), symbol, block_symbols};
  SymbolSet known = equation.unknown;
  for (unsigned i = 0; i < known.words.size(); ++i) {
    known.words[i] &= received_->words[i];
    equation.unknown.words[i] ^= known.words[i];
  }
  SymbolSum sum;
  for_each(known, [&](unsigned number) { sum.add(bytes_, number); });
  broadcast::add(equation.sum, sum.value());
  const auto remove_pivot = [](Equation& from, const Equation& other) {
    if (from.unknown.contains(other.pivot)) {
      for (unsigned i = 0; i < from.unknown.words.size(); ++i) {
        from.unknown.words[i] ^= other.unknown.words[i];
      }
      broadcast::add(from.sum, other.sum);
    }
  };
  for (unsigned i = 0; i < equations_; ++i) {
    remove_pivot(equation, equation_[i]);
  }
  equation.pivot = lowest(equation.unknown);
  if (equation.pivot == block_symbols) {
    return false;  // the equation follows from the others
  }
  for (unsigned i = 0; i < equations_; ++i) {
    remove_pivot(equation_[i], equation);
  }
  equation_[equations_++] = equation;
  if (equations_ < missing_) {
    return false;
  }
  solve();
  return true;
}

void BlockDecoder::solve() {
  for (unsigned i = 0; i < equations_; ++i) {
    const unsigned number = equation_[i].pivot;
    put_symbol(bytes_, number, equation_[i].sum);
    received_->insert(number);
  }
  missing_ = 0;
}

}  // namespace proleg::broadcast
