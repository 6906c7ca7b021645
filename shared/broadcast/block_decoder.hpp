#pragma once

// Some bytes go to many modules at once, by broadcast: each frame has a symbol of 7 bytes, and 256 symbols are a block.
// Each module misses different symbols. With twelve modules and a tenth of the frames lost, repeating all missed
// symbols to all modules would take nearly as long as the first time. So the host sends repair symbols instead: each is
// the exclusive or of a random half of the block's symbols. A module that misses m symbols of a block solves m linear
// equations over GF(2). Any m independent ones suffice, and m + 1.6 random ones have m independent ones on average. The
// same repair symbols help all modules. (Random linear code; M. Luby et al., "The Use of Forward Error Correction in
// Reliable Multicast", RFC 3453, section 2.3.)

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

namespace proleg::broadcast {

inline constexpr std::size_t symbol_size = 7;
inline constexpr unsigned block_symbols = 256;

using Symbol = std::array<std::uint8_t, symbol_size>;

/// A set of numbers of symbols in a block. Its words are visible, because a decoder that looks at single bits is slower
/// than the bus.
struct SymbolSet {
  static constexpr unsigned word_bits = 32;
  using Words = std::array<std::uint32_t, block_symbols / word_bits>;

  [[nodiscard]] bool contains(unsigned number) const {
    return (words[number / word_bits] >> number % word_bits & 1U) != 0;
  }
  void insert(unsigned number) { words[number / word_bits] |= 1U << number % word_bits; }
  [[nodiscard]] unsigned count() const {
    unsigned sum = 0;
    for (const std::uint32_t word : words) {
      sum += static_cast<unsigned>(std::popcount(word));
    }
    return sum;
  }

  Words words{};
};

/// Symbol `number` of a block, which must have it. If the last symbol is not full, zeros follow.
[[nodiscard]] Symbol symbol_of(std::span<const std::uint8_t> bytes, unsigned number);
/// Writes symbol `number` into the block.
void put_symbol(std::span<std::uint8_t> bytes, unsigned number, const Symbol& symbol);

/// The symbols that a repair symbol contains, for a block with this number of symbols. block: its number; repair: 0 to
/// 255, different for all repair symbols of a block. The set may be empty.
[[nodiscard]] SymbolSet repair_set(unsigned block, unsigned repair, unsigned symbols);

/// The repair symbol of a block. bytes: the block, 1 to 1,792 bytes; if the last symbol is not full, zeros follow.
[[nodiscard]] Symbol repair_symbol(std::span<const std::uint8_t> bytes, unsigned block, unsigned repair);

/// Completes blocks, one after the other.
class BlockDecoder {
 public:
  /// Greatest number of symbols of a block that repair symbols can replace. A block that misses more must be sent
  /// again.
  static constexpr unsigned max_missing = 64;

  /// Begins a block. bytes: the block, as far as it was received; received: its symbols that were received. Both must
  /// stay until the next call; add() completes them.
  void start(std::span<std::uint8_t> bytes, SymbolSet& received, unsigned block);
  /// Takes a repair symbol of this block. Returns whether all symbols of the block are complete. More repair symbols
  /// may come, in any order, also twice.
  [[nodiscard]] bool add(unsigned repair, const Symbol& symbol);

 private:
  /// The exclusive or of some of the symbols that are missing.
  struct Equation {
    SymbolSet unknown;
    Symbol sum{};
    unsigned pivot = 0;  ///< an unknown that no other equation has
  };

  void solve();

  std::span<std::uint8_t> bytes_;
  SymbolSet* received_ = nullptr;
  unsigned block_ = 0;
  unsigned missing_ = 0;
  unsigned equations_ = 0;  ///< number of independent equations
  /// Each is solved for one missing symbol, its pivot, which no other contains. With as many equations as missing
  /// symbols, each contains its pivot alone, and all are known.
  std::array<Equation, max_missing> equation_{};
};

/// Number of symbols of a block with this number of bytes.
[[nodiscard]] constexpr unsigned symbols_of(std::size_t bytes) {
  return static_cast<unsigned>((bytes + symbol_size - 1) / symbol_size);
}

}  // namespace proleg::broadcast
