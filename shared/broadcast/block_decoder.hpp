#pragma once

// Some bytes go to many modules at once, by broadcast: each frame has a symbol of 7 bytes, 256 symbols are a block.
// Every module misses other symbols. To repeat all of them to all would, with twelve modules and a tenth of the frames
// lost, take nearly as long as the first time. So the host sends repair symbols instead: each is the exclusive or of a
// random half of the block's symbols. A module that misses m symbols of a block solves m linear equations over GF(2);
// any m that are independent do, and m + 1.6 random ones have m independent ones on average. The same repair symbols
// help all modules. (Random linear code; M. Luby et al., "The Use of Forward Error Correction in Reliable Multicast",
// RFC 3453, section 2.3.)

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

namespace proleg::broadcast {

inline constexpr std::size_t symbol_size = 7;
inline constexpr unsigned block_symbols = 256;

using Symbol = std::array<std::uint8_t, symbol_size>;

/// Numbers of symbols of a block. Its words are visible, because a decoder that looks at bits one by one is slower than
/// the bus.
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

/// Symbol `number` of a block, which has it; zeros follow if the last one is not full.
[[nodiscard]] Symbol symbol_of(std::span<const std::uint8_t> bytes, unsigned number);
/// Puts it into the block.
void put_symbol(std::span<std::uint8_t> bytes, unsigned number, const Symbol& symbol);

/// Which symbols of a block with this many a repair symbol contains. block: its number; repair: 0 to 255, different
/// for all repair symbols of a block. A set without symbols is possible.
[[nodiscard]] SymbolSet repair_set(unsigned block, unsigned repair, unsigned symbols);

/// The repair symbol of a block. bytes: those of the block, 1 to 1,792; zeros follow if the last symbol is not full.
[[nodiscard]] Symbol repair_symbol(std::span<const std::uint8_t> bytes, unsigned block, unsigned repair);

/// Completes one block after the other.
class BlockDecoder {
 public:
  /// Symbols of a block that repair symbols can replace. A block that misses more must be sent again first.
  static constexpr unsigned max_missing = 64;

  /// Begins with a block: its bytes, as far as they were received, and which of its symbols were. Both must stay until
  /// the next call; add() completes them.
  void start(std::span<std::uint8_t> bytes, SymbolSet& received, unsigned block);
  /// A repair symbol of this block has come. True: all symbols of the block are there now. More symbols may come, in
  /// any order, also twice.
  [[nodiscard]] bool add(unsigned repair, const Symbol& symbol);

 private:
  /// The exclusive or of some symbols that are missing.
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
  unsigned equations_ = 0;  ///< independent ones
  /// When there are as many as unknowns, each has its pivot only: all are solved.
  std::array<Equation, max_missing> equation_{};
};

/// Symbols of a block of this many bytes.
[[nodiscard]] constexpr unsigned symbols_of(std::size_t bytes) {
  return static_cast<unsigned>((bytes + symbol_size - 1) / symbol_size);
}

}  // namespace proleg::broadcast
