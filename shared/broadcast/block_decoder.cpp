#include "shared/broadcast/block_decoder.hpp"

#include "shared/fixed/random.hpp"

namespace proleg::broadcast {
namespace {

void add(Symbol& sum, const Symbol& symbol) {
  for (std::size_t i = 0; i < symbol_size; ++i) {
    sum[i] ^= symbol[i];
  }
}

/// block_symbols if there is none.
unsigned lowest(const SymbolSet& set) {
  unsigned number = 0;
  while (number < block_symbols && !set[number]) {
    ++number;
  }
  return number;
}

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
  constexpr unsigned word_bits = 32;
  Pcg32 random(repair, block);
  SymbolSet set;
  for (unsigned word = 0; word < symbols; word += word_bits) {
    const std::uint32_t bits = random.next();
    for (unsigned bit = 0; bit < word_bits && word + bit < symbols; ++bit) {
      set[word + bit] = (bits >> bit & 1U) != 0;
    }
  }
  return set;
}

Symbol repair_symbol(std::span<const std::uint8_t> bytes, unsigned block, unsigned repair) {
  const unsigned symbols = symbols_of(bytes.size());
  const SymbolSet set = repair_set(block, repair, symbols);
  Symbol sum{};
  for (unsigned number = 0; number < symbols; ++number) {
    if (set[number]) {
      add(sum, symbol_of(bytes, number));
    }
  }
  return sum;
}

void BlockDecoder::start(std::span<std::uint8_t> bytes, SymbolSet& received, unsigned block) {
  bytes_ = bytes;
  received_ = &received;
  block_ = block;
  missing_ = symbols_of(bytes.size()) - static_cast<unsigned>(received.count());
  equations_ = 0;
}

bool BlockDecoder::add(unsigned repair, const Symbol& symbol) {
  if (missing_ == 0) {
    return true;
  }
  if (missing_ > max_missing) {
    return false;
  }
  const unsigned symbols = symbols_of(bytes_.size());
  Equation equation{repair_set(block_, repair, symbols), symbol, block_symbols};
  for (unsigned number = 0; number < symbols; ++number) {
    if (equation.unknown[number] && (*received_)[number]) {
      equation.unknown[number] = false;
      broadcast::add(equation.sum, symbol_of(bytes_, number));
    }
  }
  const auto remove_pivot = [](Equation& from, const Equation& other) {
    if (from.unknown[other.pivot]) {
      from.unknown ^= other.unknown;
      broadcast::add(from.sum, other.sum);
    }
  };
  for (unsigned i = 0; i < equations_; ++i) {
    remove_pivot(equation, equation_[i]);
  }
  equation.pivot = lowest(equation.unknown);
  if (equation.pivot == block_symbols) {
    return false;  // it follows from the others
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
    (*received_)[number] = true;
  }
  missing_ = 0;
}

}  // namespace proleg::broadcast
