// The board record in flash: what counts as one, and that no cut of the power loses the newest.

#include "firmware/module/board_record.hpp"

#include <gtest/gtest.h>

#include <random>
#include <stdexcept>
#include <vector>

namespace proleg::firmware {
namespace {

using Sector = std::vector<std::uint8_t>;

constexpr std::uint32_t seed = 20;
/// Small, so that the log comes round often.
constexpr std::size_t sector_size = 4 * BoardRecord::size;

struct PowerCut : std::runtime_error {
  PowerCut() : std::runtime_error("power cut") {}
};

/// NOR flash: bits go from 1 to 0 word by word, back to 1 by sectors. The power can fail at any operation, which then
/// has done a part of its work.
class FlashMemory final : public FlashPort {
 public:
  std::array<Sector, 2> sectors{Sector(sector_size, 0xFF), Sector(sector_size, 0xFF)};
  int operations = 0;   ///< words programmed and sectors erased
  int cut_at = -1;      ///< the operation that does not end
  int refused_at = -1;  ///< the operation that reports an error
  std::mt19937 noise{seed};

  bool erase(unsigned sector) override {
    const bool cut = operations == cut_at;
    if (operations++ == refused_at) {
      return false;
    }
    for (std::uint8_t& byte : sectors.at(sector)) {
      byte = cut ? static_cast<std::uint8_t>(byte | noise()) : std::uint8_t{0xFF};
    }
    return cut ? throw PowerCut() : true;
  }

  bool program(unsigned sector, std::uint32_t offset, std::span<const std::uint8_t> bytes) override {
    EXPECT_EQ(offset % 4, 0U);
    EXPECT_EQ(bytes.size() % 4, 0U);
    for (std::size_t word = 0; word < bytes.size(); word += 4) {
      const bool cut = operations == cut_at;
      if (operations++ == refused_at) {
        return false;
      }
      for (std::size_t i = word; i < word + 4; ++i) {
        std::uint8_t& byte = sectors.at(sector).at(offset + i);
        EXPECT_EQ(byte, 0xFF) << "programmed twice";
        byte = static_cast<std::uint8_t>(byte & (bytes[i] | (cut ? noise() : 0U)));
      }
      if (cut) {
        throw PowerCut();
      }
    }
    return true;
  }

  [[nodiscard]] std::span<const std::uint8_t> contents(unsigned sector) const override { return sectors.at(sector); }

  [[nodiscard]] std::optional<BoardRecord> read() const { return newest(sectors[0], sectors[1]); }
};

BoardRecord record_of(unsigned node) { return {static_cast<std::uint8_t>(node), true, 600, 3500}; }

TEST(BoardRecordTest, HasTheBytesThatItsDocumentationSays) {
  const auto bytes = encode({3, true, 0x0123, 0x0ABC}, 0x01020304);
  const std::array<std::uint8_t, 28> expected{0x04, 0x03, 0x02, 0x01, 1, 3, 1, 0, 0x23, 0x01, 0xBC, 0x0A};
  EXPECT_TRUE(std::equal(expected.begin(), expected.end(), bytes.begin()));
  // CRC-32 by another program: python3 -c "import zlib; print(hex(zlib.crc32(bytes.fromhex(
  // '0403020101030100 2301bc0a' + '00' * 16))))"
  std::uint32_t crc = 0;
  for (std::size_t i = BoardRecord::size; i-- > 28;) {
    crc = crc << 8U | bytes.at(i);
  }
  EXPECT_EQ(crc, 0xF4F67486U);
}

TEST(BoardRecordTest, ErasedFlashHoldsNone) {
  const FlashMemory flash;
  EXPECT_EQ(flash.read(), std::nullopt);
  EXPECT_EQ(newest({}, {}), std::nullopt);
}

TEST(BoardRecordTest, EveryRecordComesBackAsItWasWritten) {
  for (unsigned node = 1; node <= BoardRecord::max_node; ++node) {
    for (const bool has_feedback : {false, true}) {
      const BoardRecord record{static_cast<std::uint8_t>(node), has_feedback, 4095, static_cast<std::uint16_t>(node)};
      FlashMemory flash;
      ASSERT_EQ(append(flash, record), AppendResult::ok);
      EXPECT_EQ(flash.read(), record);
    }
  }
}

TEST(BoardRecordTest, WhatIsOutOfRangeIsNotWritten) {
  for (const BoardRecord& record :
       {BoardRecord{0, false, 0, 0}, BoardRecord{127, false, 0, 0}, BoardRecord{255, false, 0, 0},
        BoardRecord{1, true, 7, 7}, BoardRecord{1, false, 4096, 0}, BoardRecord{1, false, 0, 0xFFFF}}) {
    FlashMemory flash;
    EXPECT_EQ(append(flash, record), AppendResult::invalid_record);
    EXPECT_EQ(flash.operations, 0);
  }
}

TEST(BoardRecordTest, TheHighestSequenceNumberCountsWhereverItIs) {
  for (std::size_t place = 0; place < 2 * sector_size; place += BoardRecord::size) {
    FlashMemory flash;
    for (std::size_t i = 0; i < 2 * sector_size; i += BoardRecord::size) {
      const auto bytes = encode(record_of(i == place ? 9 : 1), i == place ? 100 : 99 - static_cast<unsigned>(i / 32));
      std::copy(bytes.begin(), bytes.end(),
                flash.sectors.at(i / sector_size).begin() + static_cast<int>(i % sector_size));
    }
    EXPECT_EQ(flash.read(), record_of(9)) << place;
  }
}

TEST(BoardRecordTest, ADamagedRecordCountsForNothingWhateverBitIsWrong) {
  for (unsigned bit = 0; bit < 8 * BoardRecord::size; ++bit) {
    FlashMemory flash;
    ASSERT_EQ(append(flash, record_of(1)), AppendResult::ok);
    ASSERT_EQ(append(flash, record_of(2)), AppendResult::ok);
    flash.sectors[0].at(BoardRecord::size + bit / 8) ^= static_cast<std::uint8_t>(1U << (bit % 8));
    EXPECT_EQ(flash.read(), record_of(1)) << "bit " << bit;
    ASSERT_EQ(append(flash, record_of(3)), AppendResult::ok);
    EXPECT_EQ(flash.read(), record_of(3)) << "bit " << bit;
  }
}

TEST(BoardRecordTest, ARecordOfAnotherSchemaCountsForNothing) {
  FlashMemory flash;
  auto bytes = encode(record_of(5), 1);
  // 2 instead of 1, and the checksum of that by another program (zlib.crc32).
  bytes[4] = 2;
  const std::array<std::uint8_t, 4> crc{0xA5, 0x36, 0xC2, 0x15};
  std::copy(crc.begin(), crc.end(), bytes.begin() + 28);
  std::copy(bytes.begin(), bytes.end(), flash.sectors[0].begin());
  EXPECT_EQ(flash.read(), std::nullopt);
  ASSERT_EQ(append(flash, record_of(6)), AppendResult::ok);
  EXPECT_EQ(flash.read(), record_of(6));
}

TEST(BoardRecordTest, RandomBytesHoldNone) {
  std::mt19937 noise(seed);
  for (int round = 0; round < 1000; ++round) {
    FlashMemory flash;
    for (Sector& sector : flash.sectors) {
      for (std::uint8_t& byte : sector) {
        byte = static_cast<std::uint8_t>(noise());
      }
    }
    ASSERT_EQ(flash.read(), std::nullopt);
    ASSERT_EQ(append(flash, record_of(8)), AppendResult::ok);
    ASSERT_EQ(flash.read(), record_of(8));
  }
}

TEST(BoardRecordTest, TheLogGoesRoundBothSectorsForEver) {
  FlashMemory flash;
  for (unsigned i = 0; i < 1000; ++i) {
    ASSERT_EQ(append(flash, record_of(1 + i % 126)), AppendResult::ok);
    ASSERT_EQ(flash.read(), record_of(1 + i % 126));
  }
  // An erase for each sector after the first one; eight words a record.
  EXPECT_EQ(flash.operations, 1000 * 8 + 1000 / 4 - 1);
}

TEST(BoardRecordTest, ACutOfThePowerAtAnyInstantLeavesTheNewestOrTheOneBefore) {
  // Enough appends to fill both sectors and start again.
  constexpr unsigned appends = 20;
  FlashMemory whole;
  for (unsigned i = 1; i <= appends; ++i) {
    ASSERT_EQ(append(whole, record_of(i)), AppendResult::ok);
  }
  for (int cut = 0; cut < whole.operations; ++cut) {
    FlashMemory flash;
    flash.cut_at = cut;
    flash.noise.seed(seed + static_cast<unsigned>(cut));
    bool was_cut = false;
    for (unsigned i = 1; i <= appends; ++i) {
      const std::optional<BoardRecord> before = flash.read();
      try {
        ASSERT_EQ(append(flash, record_of(i)), AppendResult::ok);
      } catch (const PowerCut&) {
        was_cut = true;
        const std::optional<BoardRecord> found = flash.read();
        ASSERT_TRUE(found == before || found == record_of(i)) << "cut " << cut << ", append " << i;
        ASSERT_EQ(append(flash, record_of(i)), AppendResult::ok) << "cut " << cut << ", append " << i;
      }
      ASSERT_EQ(flash.read(), record_of(i)) << "cut " << cut << ", append " << i;
    }
    EXPECT_TRUE(was_cut) << cut;
  }
}

TEST(BoardRecordTest, TwoCutsInARowLoseNothingEither) {
  for (int first = 0; first < 80; ++first) {
    for (int second = 0; second < 20; ++second) {
      FlashMemory flash;
      flash.cut_at = first;
      flash.noise.seed(static_cast<unsigned>(100 * first + second));
      for (unsigned i = 1; i <= 12; ++i) {
        const std::optional<BoardRecord> before = flash.read();
        for (int attempt = 0; attempt < 3; ++attempt) {
          try {
            ASSERT_EQ(append(flash, record_of(i)), AppendResult::ok);
            break;
          } catch (const PowerCut&) {
            ASSERT_TRUE(flash.read() == before || flash.read() == record_of(i)) << first << ", " << second;
            flash.cut_at = flash.cut_at == first ? flash.operations + second : -1;
          }
        }
        ASSERT_EQ(flash.read(), record_of(i)) << first << ", " << second;
      }
    }
  }
}

TEST(BoardRecordTest, AnErrorOfTheFlashIsReportedAndTheRecordBeforeStays) {
  FlashMemory flash;
  for (unsigned i = 1; i <= 4; ++i) {
    ASSERT_EQ(append(flash, record_of(i)), AppendResult::ok);
  }
  flash.refused_at = flash.operations;  // the other sector must be erased now
  EXPECT_EQ(append(flash, record_of(5)), AppendResult::erase_failed);
  EXPECT_EQ(flash.read(), record_of(4));
  flash.refused_at = flash.operations + 3;
  EXPECT_EQ(append(flash, record_of(5)), AppendResult::program_failed);
  EXPECT_EQ(flash.read(), record_of(4));
  flash.refused_at = -1;
  EXPECT_EQ(append(flash, record_of(5)), AppendResult::ok);
  EXPECT_EQ(flash.read(), record_of(5));
}

TEST(BoardRecordTest, FlashThatHoldsSomethingElseThanWasWrittenIsReported) {
  class Worn final : public FlashPort {
   public:
    Sector sector = Sector(sector_size, 0xFF);
    bool erase(unsigned /*sector*/) override { return true; }
    bool program(unsigned /*sector*/, std::uint32_t /*offset*/, std::span<const std::uint8_t> /*bytes*/) override {
      return true;
    }
    [[nodiscard]] std::span<const std::uint8_t> contents(unsigned /*sector*/) const override { return sector; }
  } worn;
  EXPECT_EQ(append(worn, record_of(1)), AppendResult::program_failed);
}

}  // namespace
}  // namespace proleg::firmware
