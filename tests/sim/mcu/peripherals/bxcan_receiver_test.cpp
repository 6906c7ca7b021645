// Filter banks against RM0090, 32.7.4: the layouts of the four modes, filter numbers and the priority rules.

#include "sim/mcu/peripherals/bxcan_receiver.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace proleg::sim {
namespace {

using Match = BxCanFilters::Match;

constexpr std::uint32_t fmr = 0x200;
constexpr std::uint32_t reserved = 0x2A1C'0000;  ///< bits of FMR (RM0090, section 32.9.4)
constexpr std::uint32_t fm1r = 0x204;
constexpr std::uint32_t fs1r = 0x20C;
constexpr std::uint32_t ffa1r = 0x214;
constexpr std::uint32_t fa1r = 0x21C;
constexpr std::uint32_t bank(unsigned number) { return 0x240 + 8 * number; }

class Filters : public testing::Test {
 protected:
  void write(std::uint32_t offset, std::uint32_t value) {
    const auto rejection = filters.write(offset, value);
    EXPECT_FALSE(rejection) << *rejection;
  }
  /// All banks belong to CAN1.
  void begin() { write(fmr, reserved | (28U << 8U) | 1U); }
  void end() { write(fmr, reserved | 28U << 8U); }

  BxCanFilters filters;
};

TEST_F(Filters, NothingPassesWithoutAnActiveFilter) {
  begin();
  end();
  for (std::uint16_t identifier = 0; identifier < 0x800; ++identifier) {
    EXPECT_FALSE(filters.match(identifier));
  }
}

TEST_F(Filters, AMaskOf32BitsHasTheIdentifierAtTheTop) {
  begin();
  write(fs1r, 1);
  write(fa1r, 1);
  write(bank(0), 0x180U << 21U);
  write(bank(0) + 4, 0x780U << 21U);
  EXPECT_FALSE(filters.match(0x180)) << "FINIT";
  end();
  for (std::uint16_t identifier = 0; identifier < 0x800; ++identifier) {
    EXPECT_EQ(filters.match(identifier).has_value(), (identifier & 0x780U) == 0x180U) << identifier;
  }
}

TEST_F(Filters, AMaskForExtendedOrRemoteFramesAcceptsNoDataFrame) {
  for (const std::uint32_t bit : {4U, 2U}) {
    begin();
    write(fs1r, 1);
    write(fa1r, 1);
    write(bank(0), bit);
    write(bank(0) + 4, bit);
    end();
    EXPECT_FALSE(filters.match(0x123));
    begin();
    write(bank(0), 0);
    end();
    EXPECT_EQ(filters.match(0x123), (Match{0, 0}));
  }
}

TEST_F(Filters, AListOf32BitsHasTwoIdentifiers) {
  begin();
  write(fs1r, 1);
  write(fm1r, 1);
  write(fa1r, 1);
  write(bank(0), 0x7FFU << 21U);
  write(bank(0) + 4, 0x001U << 21U);
  end();
  EXPECT_EQ(filters.match(0x7FF), (Match{0, 0}));
  EXPECT_EQ(filters.match(0x001), (Match{0, 1}));
  EXPECT_FALSE(filters.match(0x000));
}

TEST_F(Filters, TwoMasksOf16BitsAndFourListed) {
  begin();
  write(fm1r, 2);
  write(fa1r, 3);
  write(bank(0), (0x700U << 21U) | (0x100U << 5U));      // 1xx
  write(bank(0) + 4, (0x7F0U << 21U) | (0x220U << 5U));  // 22x
  write(bank(1), (0x301U << 21U) | (0x300U << 5U));
  write(bank(1) + 4, (0x303U << 21U) | (0x302U << 5U));
  end();
  EXPECT_EQ(filters.match(0x1AB), (Match{0, 0}));
  EXPECT_EQ(filters.match(0x22F), (Match{0, 1}));
  EXPECT_FALSE(filters.match(0x230));
  for (unsigned i = 0; i < 4; ++i) {
    EXPECT_EQ(filters.match(static_cast<std::uint16_t>(0x300 + i)), (Match{0, 2 + i}));
  }
  EXPECT_FALSE(filters.match(0x304));
}

TEST_F(Filters, BanksFromCan2sbOnBelongToCan2) {
  write(fs1r, 1U << 14U);
  write(fa1r, 1U << 14U);  // lets everything pass
  write(fmr, reserved | 14U << 8U);
  EXPECT_FALSE(filters.match(0x123));
  write(fmr, reserved | 15U << 8U);
  EXPECT_TRUE(filters.match(0x123));
}

TEST_F(Filters, RegistersKeepWhatIsWritten) {
  for (const std::uint32_t offset : {fm1r, fs1r, ffa1r, fa1r}) {
    EXPECT_TRUE(BxCanFilters::contains(offset));
    write(offset, 0x0A5A'5A5A & ~offset);
    EXPECT_EQ(filters.read(offset), 0x0A5A'5A5A & ~offset);
  }
  for (unsigned i = 0; i < 28; ++i) {
    write(bank(i), i);
    write(bank(i) + 4, ~i);
  }
  for (unsigned i = 0; i < 28; ++i) {
    EXPECT_EQ(filters.read(bank(i)), i);
    EXPECT_EQ(filters.read(bank(i) + 4), ~i);
  }
  EXPECT_EQ(BxCanFilters::register_name(bank(13) + 4), "F13R2");
  EXPECT_FALSE(BxCanFilters::contains(bank(28)));
  EXPECT_FALSE(BxCanFilters::contains(0x208));
}

/// One filter as the manual's figure 342 draws it, and where it stands.
struct Drawn {
  bool is_wide;
  bool is_list;
  unsigned fifo;
  unsigned number;
  bool is_active;
  // A frame passes if its identifier has these bits under that mask, and if the filter has no condition for other bits.
  unsigned identifier;
  unsigned mask;
  bool asks_no_more;
};

TEST_F(Filters, RandomBanksDecideAsTheManualsRulesDo) {
  constexpr unsigned seed = 42;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 generator(seed);
  const auto random = [&] { return static_cast<unsigned>(generator()); };
  unsigned hits = 0;
  for (unsigned round = 0; round < 300; ++round) {
    const unsigned can1_banks = random() % 29;
    const std::uint32_t lists = random() & 0x0FFF'FFFFU;
    const std::uint32_t wide = random() & 0x0FFF'FFFFU;
    const std::uint32_t assignment = random() & 0x0FFF'FFFFU;
    const std::uint32_t active = random() & 0x0FFF'FFFFU;
    write(fmr, reserved | (can1_banks << 8U) | 1U);
    write(fm1r, lists);
    write(fs1r, wide);
    write(ffa1r, assignment);
    write(fa1r, active);
    std::vector<Drawn> drawn;
    std::vector<unsigned> numbers(2);
    for (unsigned i = 0; i < 28; ++i) {
      const bool is_list = ((lists >> i) & 1U) != 0;
      const bool is_wide = ((wide >> i) & 1U) != 0;
      const unsigned fifo = (assignment >> i) & 1U;
      // Few identifiers and rare masks, so that filters overlap; the other bits of an identifier are mostly 0.
      const auto identifier = [&] { return 0x100U + random() % 64; };
      const auto mask = [&] { return random() % 3 == 0 ? 0x7C0U : 0x7FFU ^ (1U << (random() % 6)); };
      const auto others = [&](unsigned bits) { return random() % 8 == 0 ? random() % (1U << bits) : 0U; };
      const auto add = [&](unsigned id, unsigned id_mask, unsigned other, unsigned other_mask) {
        if (i < can1_banks) {
          drawn.push_back({is_wide, is_list, fifo, numbers[fifo]++, ((active >> i) & 1U) != 0, id, id_mask,
                           (other & other_mask) == 0});
        }
      };
      if (is_wide) {
        const unsigned first = identifier();
        const unsigned first_others = others(21);
        const unsigned second = is_list ? identifier() : mask();
        const unsigned second_others = others(21);
        write(bank(i), (first << 21U) | first_others);
        write(bank(i) + 4, (second << 21U) | second_others);
        if (is_list) {
          add(first, 0x7FF, first_others, ~0U);
          add(second, 0x7FF, second_others, ~0U);
        } else {
          add(first, second, first_others, second_others);
        }
        continue;
      }
      for (unsigned half = 0; half < 2; ++half) {
        const unsigned low = identifier();
        const unsigned low_others = others(5);
        const unsigned high = is_list ? identifier() : mask();
        const unsigned high_others = others(5);
        write(bank(i) + 4 * half, (((high << 5U) | high_others) << 16U) | (low << 5U) | low_others);
        if (is_list) {
          add(low, 0x7FF, low_others, ~0U);
          add(high, 0x7FF, high_others, ~0U);
        } else {
          add(low, high, low_others, high_others);
        }
      }
    }
    write(fmr, reserved | can1_banks << 8U);
    for (unsigned identifier = 0x0F0; identifier < 0x150; ++identifier) {
      const Drawn* best = nullptr;
      for (const Drawn& filter : drawn) {  // in the order of banks
        const bool passes =
            filter.is_active && filter.asks_no_more && ((identifier ^ filter.identifier) & filter.mask) == 0;
        if (passes && (best == nullptr || (filter.is_wide && !best->is_wide) ||
                       (filter.is_wide == best->is_wide && filter.is_list && !best->is_list))) {
          best = &filter;
        }
      }
      const auto match = filters.match(static_cast<std::uint16_t>(identifier));
      ASSERT_EQ(match.has_value(), best != nullptr) << "round " << round << " identifier " << identifier;
      if (best != nullptr) {
        ASSERT_EQ(*match, (Match{best->fifo, best->number})) << "round " << round << " identifier " << identifier;
        ++hits;
      }
    }
  }
  EXPECT_GT(hits, 5'000U);
}

}  // namespace
}  // namespace proleg::sim
