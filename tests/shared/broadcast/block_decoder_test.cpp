#include "shared/broadcast/block_decoder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <random>
#include <vector>

namespace proleg::broadcast {
namespace {

constexpr std::uint32_t seed = 11;

using Bytes = std::vector<std::uint8_t>;

Bytes random_bytes(std::size_t size, std::mt19937& random) {
  Bytes bytes(size);
  std::ranges::generate(bytes, [&random] { return static_cast<std::uint8_t>(random()); });
  return bytes;
}

/// A block of which a receiver misses some symbols: their bytes are arbitrary.
struct Reception {
  Bytes bytes;
  SymbolSet received;
};

Reception receive_without(const Bytes& sent, unsigned missing, std::mt19937& random) {
  Reception reception{sent, {}};
  const unsigned symbols = symbols_of(sent.size());
  std::vector<bool> is_received(symbols, true);
  std::fill_n(is_received.begin(), missing, false);
  std::shuffle(is_received.begin(), is_received.end(), random);
  for (unsigned i = 0; i < symbols; ++i) {
    if (is_received[i]) {
      reception.received.insert(i);
    }
  }
  for (std::size_t i = 0; i < sent.size(); ++i) {
    if (!reception.received.contains(static_cast<unsigned>(i / symbol_size))) {
      reception.bytes[i] = static_cast<std::uint8_t>(random());
    }
  }
  return reception;
}

/// Number of repair symbols that the decoder needs until the block is complete.
unsigned repairs_needed(const Bytes& sent, Reception& reception, unsigned block) {
  BlockDecoder decoder;
  decoder.start(reception.bytes, reception.received, block);
  unsigned repairs = 0;
  while (!decoder.add(repairs, repair_symbol(sent, block, repairs))) {
    ++repairs;
  }
  return repairs + 1;
}

TEST(BlockDecoderTest, CompletesABlockWhateverSymbolsAreMissing) {
  std::mt19937 random(seed);
  for (int round = 0; round < 800; ++round) {
    SCOPED_TRACE(testing::Message() << "round " << round << ", seed " << seed);
    const Bytes sent = random_bytes(1 + random() % (block_symbols * symbol_size), random);
    const auto missing =
        static_cast<unsigned>(random() % (1 + std::min(symbols_of(sent.size()), BlockDecoder::max_missing)));
    Reception reception = receive_without(sent, missing, random);
    static_cast<void>(repairs_needed(sent, reception, static_cast<unsigned>(random() % 80)));
    ASSERT_EQ(reception.bytes, sent);
    ASSERT_EQ(reception.received.count(), symbols_of(sent.size()));
  }
}

// Random vectors over GF(2) span n dimensions after n + 1.6067 of them on average (the constant of Erdos and Borwein).
TEST(BlockDecoderTest, NeedsAsManyRepairSymbolsAsRandomEquationsDo) {
  std::mt19937 random(seed);
  constexpr unsigned missing = 30;
  constexpr int rounds = 1'500;
  double more = 0;
  for (int round = 0; round < rounds; ++round) {
    const Bytes sent = random_bytes(block_symbols * symbol_size, random);
    Reception reception = receive_without(sent, missing, random);
    more += repairs_needed(sent, reception, static_cast<unsigned>(round)) - missing;
  }
  // The standard deviation of the numbers is 1.66.
  EXPECT_NEAR(more / rounds, 1.6067, 4 * 1.66 / std::sqrt(rounds));
}

TEST(BlockDecoderTest, TakesRepairSymbolsInAnyOrderAndTwice) {
  std::mt19937 random(seed);
  const Bytes sent = random_bytes(1'500, random);
  Reception reception = receive_without(sent, 40, random);
  BlockDecoder decoder;
  decoder.start(reception.bytes, reception.received, 3);
  bool is_complete = false;
  for (unsigned repair = 100; repair-- > 0;) {
    is_complete = decoder.add(repair, repair_symbol(sent, 3, repair));
    is_complete = decoder.add(repair, repair_symbol(sent, 3, repair));
  }
  EXPECT_TRUE(is_complete);
  EXPECT_EQ(reception.bytes, sent);
}

TEST(BlockDecoderTest, LeavesABlockThatMissesTooMuch) {
  std::mt19937 random(seed);
  const Bytes sent = random_bytes(1'500, random);
  Reception reception = receive_without(sent, BlockDecoder::max_missing + 1, random);
  const Bytes before = reception.bytes;
  BlockDecoder decoder;
  decoder.start(reception.bytes, reception.received, 3);
  for (unsigned repair = 0; repair < block_symbols; ++repair) {
    ASSERT_FALSE(decoder.add(repair, repair_symbol(sent, 3, repair)));
  }
  EXPECT_EQ(reception.bytes, before);
}

TEST(BlockDecoderTest, ChangesNothingOfACompleteBlock) {
  std::mt19937 random(seed);
  const Bytes sent = random_bytes(700, random);
  Reception reception = receive_without(sent, 0, random);
  BlockDecoder decoder;
  decoder.start(reception.bytes, reception.received, 0);
  EXPECT_TRUE(decoder.add(0, {1, 2, 3}));
  EXPECT_EQ(reception.bytes, sent);
}

// The purpose of repair symbols: twelve modules, each of which misses another tenth of all frames.
TEST(BlockDecoderTest, TwelveReceiversWithATenthLostTakeAtMost30PercentMoreFrames) {
  std::mt19937 random(seed);
  std::bernoulli_distribution is_lost(0.1);
  constexpr unsigned blocks = 37;  // 64 KiB
  unsigned frames = 0;
  for (unsigned block = 0; block < blocks; ++block) {
    const Bytes sent = random_bytes(block_symbols * symbol_size, random);
    std::vector<Reception> receivers(12, {sent, {}});
    std::vector<BlockDecoder> decoders(receivers.size());
    for (std::size_t i = 0; i < receivers.size(); ++i) {
      for (unsigned symbol = 0; symbol < block_symbols; ++symbol) {
        if (!is_lost(random)) {
          receivers[i].received.insert(symbol);
        }
      }
      decoders[i].start(receivers[i].bytes, receivers[i].received, block);
    }
    frames += block_symbols;
    const auto is_complete = [](const Reception& receiver) { return receiver.received.count() == block_symbols; };
    for (unsigned repair = 0; !std::ranges::all_of(receivers, is_complete); ++repair, ++frames) {
      for (BlockDecoder& decoder : decoders) {
        if (!is_lost(random)) {
          static_cast<void>(decoder.add(repair, repair_symbol(sent, block, repair)));
        }
      }
    }
  }
  const double ratio = static_cast<double>(frames) / (blocks * block_symbols);
  std::printf("frames for twelve receivers, 10 %% lost: %.3f times those without a loss (seed %u)\n", ratio, seed);
  EXPECT_LT(ratio, 1.3);
}

}  // namespace
}  // namespace proleg::broadcast
