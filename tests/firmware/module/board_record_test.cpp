// The board record in flash: which bytes are a record, and that a cut of the power never loses the newest one.

#include "firmware/module/board_record.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "flash_memory.hpp"
#include "shared/fixed/crc32.hpp"

namespace proleg::firmware {
namespace {

using test::FlashMemory;
using test::PowerCut;
using test::Sector;

constexpr std::uint32_t noise_seed = 20;

std::optional<BoardRecord> newest_of(const FlashMemory& flash) { return newest(flash.sectors[0], flash.sectors[1]); }

/// Records for nodes. No two of them have equal fields, so that a mixture of two records is noticed.
BoardRecord record_of(unsigned node) {
  const auto n = static_cast<std::uint16_t>(node);
  const bool is_odd = node % 2 != 0;
  const std::int32_t angle = static_cast<std::int32_t>(node) << 20;
  return {
      static_cast<std::uint8_t>(node),       true, n, static_cast<std::uint16_t>(4095 - n), is_odd, -angle, angle, n,
      static_cast<std::uint16_t>(0xFFFF - n)};
}

/// The bytes of a record as another schema wrote it, with its checksum.
std::array<std::uint8_t, BoardRecord::size> bytes_of(std::initializer_list<std::uint8_t> first, std::uint8_t fill,
                                                     std::uint32_t crc) {
  std::array<std::uint8_t, BoardRecord::size> bytes{};
  bytes.fill(fill);
  std::copy(first.begin(), first.end(), bytes.begin());
  for (std::size_t i = 28; i < bytes.size(); ++i, crc >>= 8U) {
    bytes.at(i) = static_cast<std::uint8_t>(crc);
  }
  return bytes;
}

// Checksums are those of another program, Python's zlib.crc32.

TEST(BoardRecordTest, HasTheBytesThatItsDocumentationSays) {
  const auto bytes = encode({3, true, 0x0123, 0x0ABC, true, -0x11223344, 0x3456789A, 0x05AB, 0x0CDE}, 0x01020304);
  EXPECT_EQ(bytes, bytes_of({0x04, 0x03, 0x02, 0x01, 2,    3,    3,    0,    0x23, 0x01, 0xBC, 0x0A,
                             0xBC, 0xCC, 0xDD, 0xEE, 0x9A, 0x78, 0x56, 0x34, 0xAB, 0x05, 0xDE, 0x0C},
                            0, 0x430E1037));
}

TEST(BoardRecordTest, ARecordOfVersion1HasItsNodeAndItsPotentiometerAndDefaultsForTheRest) {
  FlashMemory flash;
  const auto bytes = bytes_of({0x04, 0x03, 0x02, 0x01, 1, 3, 1, 0, 0x23, 0x01, 0xBC, 0x0A}, 0, 0xF4F67486);
  std::copy(bytes.begin(), bytes.end(), flash.sectors[0].begin());
  const BoardRecord record{3, true, 0x0123, 0x0ABC};
  EXPECT_EQ(newest_of(flash), record);
  EXPECT_EQ(record.current_limit_ma, 2'000U) << "object 0x200A:1";
  EXPECT_EQ(record.current_limit_time_ms, 500U) << "object 0x200A:2";
  // The next record continues the log.
  ASSERT_EQ(append(flash, record_of(7)), AppendResult::ok);
  EXPECT_EQ(newest_of(flash), record_of(7));
  EXPECT_EQ(flash.sectors[0][BoardRecord::size], 0x05) << "its sequence number";
}

TEST(BoardRecordTest, ErasedFlashHoldsNone) {
  const FlashMemory flash;
  EXPECT_EQ(newest_of(flash), std::nullopt);
  EXPECT_EQ(newest({}, {}), std::nullopt);
}

TEST(BoardRecordTest, EveryRecordComesBackAsItWasWritten) {
  for (unsigned node = 0; node <= BoardRecord::max_node; ++node) {
    for (const bool has_feedback : {false, true}) {
      BoardRecord record = record_of(node);
      record.has_feedback = has_feedback;
      FlashMemory flash;
      ASSERT_EQ(append(flash, record), AppendResult::ok);
      EXPECT_EQ(newest_of(flash), record);
    }
  }
}

TEST(BoardRecordTest, WhatIsOutOfRangeIsNotWritten) {
  for (const BoardRecord& record :
       {BoardRecord{127, false, 0, 0}, BoardRecord{255, false, 0, 0}, BoardRecord{1, true, 7, 7},
        BoardRecord{1, false, 4096, 0}, BoardRecord{1, false, 0, 0xFFFF}, BoardRecord{1, false, 0, 0, false, 1, 2},
        BoardRecord{1, false, 0, 0, false, -2, -1}, BoardRecord{1, false, 0, 0, false, INT32_MIN, 0},
        BoardRecord{1, false, 0, 0, false, 0, (1 << 30) + 1}, BoardRecord{1, false, 0, 0, false, 0, 0, 0x8000}}) {
    FlashMemory flash;
    EXPECT_EQ(append(flash, record), AppendResult::invalid_record);
    EXPECT_EQ(flash.operations, 0);
  }
}

TEST(BoardRecordTest, TheHighestSequenceNumberCountsWhereverItIs) {
  for (std::size_t place = 0; place < 2 * FlashMemory::sector_size; place += BoardRecord::size) {
    FlashMemory flash;
    for (std::size_t i = 0; i < 2 * FlashMemory::sector_size; i += BoardRecord::size) {
      const auto bytes = encode(record_of(i == place ? 9 : 1), i == place ? 100 : 99 - static_cast<unsigned>(i / 32));
      std::copy(
          bytes.begin(), bytes.end(),
          flash.sectors.at(i / FlashMemory::sector_size).begin() + static_cast<int>(i % FlashMemory::sector_size));
    }
    EXPECT_EQ(newest_of(flash), record_of(9)) << place;
  }
}

TEST(BoardRecordTest, ADamagedRecordCountsForNothingWhateverBitIsWrong) {
  for (unsigned bit = 0; bit < 8 * BoardRecord::size; ++bit) {
    FlashMemory flash;
    ASSERT_EQ(append(flash, record_of(1)), AppendResult::ok);
    ASSERT_EQ(append(flash, record_of(2)), AppendResult::ok);
    flash.sectors[0].at(BoardRecord::size + bit / 8) ^= static_cast<std::uint8_t>(1U << (bit % 8));
    EXPECT_EQ(newest_of(flash), record_of(1)) << "bit " << bit;
    ASSERT_EQ(append(flash, record_of(3)), AppendResult::ok);
    EXPECT_EQ(newest_of(flash), record_of(3)) << "bit " << bit;
  }
}

TEST(BoardRecordTest, OfARecordOfANewerSchemaOnlyTheFixedPartIsRead) {
  FlashMemory flash;
  ASSERT_EQ(append(flash, record_of(6)), AppendResult::ok);
  const auto newer = bytes_of({7, 0, 0, 0, 3, 5}, 0xA5, 0x1B2B9407);
  std::copy(newer.begin(), newer.end(), flash.sectors[0].begin() + BoardRecord::size);
  EXPECT_EQ(newest_of(flash), (BoardRecord{5, false, 0, 0}));
  ASSERT_EQ(append(flash, record_of(8)), AppendResult::ok);
  EXPECT_EQ(newest_of(flash), record_of(8));
}

TEST(BoardRecordTest, WhatIsReadOfANewerSchemaIsWrittenInTheOwnOne) {
  FlashMemory flash;
  const auto newer = bytes_of({7, 0, 0, 0, 3, 5}, 0xA5, 0x1B2B9407);
  std::copy(newer.begin(), newer.end(), flash.sectors[0].begin());
  const BoardRecord read = newest_of(flash).value();
  EXPECT_TRUE(has_newer_schema(flash.sectors[0], flash.sectors[1]));
  ASSERT_EQ(append(flash, read), AppendResult::ok);
  EXPECT_FALSE(has_newer_schema(flash.sectors[0], flash.sectors[1]));
  EXPECT_EQ(newest_of(flash), read);
}

TEST(BoardRecordTest, AnotherNodeIdLeavesTheRestOfTheNewestRecordInAnySchema) {
  FlashMemory flash;
  ASSERT_EQ(append(flash, record_of(6)), AppendResult::ok);
  ASSERT_EQ(append_node(flash, 12), AppendResult::ok);
  BoardRecord expected = record_of(6);
  expected.node = 12;
  EXPECT_EQ(newest_of(flash), expected);
  EXPECT_EQ(newest_node(flash.sectors[0], flash.sectors[1]), 12U);

  const auto newer = bytes_of({7, 0, 0, 0, 3, 5}, 0xA5, 0x1B2B9407);
  std::copy(newer.begin(), newer.end(), flash.sectors[0].begin() + 2 * BoardRecord::size);
  ASSERT_EQ(append_node(flash, 9), AppendResult::ok);
  const auto appended = bytes_of({8, 0, 0, 0, 3, 9}, 0xA5, 0x12686D09);
  EXPECT_TRUE(
      std::ranges::equal(appended, std::span(flash.sectors[0]).subspan(3 * BoardRecord::size, BoardRecord::size)));
}

TEST(BoardRecordTest, TheFirstNodeIdMakesARecordOfDefaultValuesAndTheSameAgainWritesNothing) {
  FlashMemory flash;
  EXPECT_EQ(newest_node(flash.sectors[0], flash.sectors[1]), 0U);
  ASSERT_EQ(append_node(flash, 4), AppendResult::ok);
  BoardRecord expected;
  expected.node = 4;
  EXPECT_EQ(newest_of(flash), expected);
  const auto sectors = flash.sectors;
  EXPECT_EQ(append_node(flash, 4), AppendResult::ok);
  EXPECT_EQ(append_node(flash, BoardRecord::max_node + 1), AppendResult::invalid_record);
  EXPECT_EQ(flash.sectors, sectors);
}

TEST(BoardRecordTest, WhatANewerProgramAddsToVersion2IsIgnored) {
  BoardRecord record = record_of(9);
  auto bytes = encode(record, 1);
  bytes[6] |= 0xFC;
  bytes[7] = 0x12;
  bytes[24] = 0x34;
  Crc32 crc;
  for (std::size_t i = 0; i < 28; ++i) {
    crc.add(bytes.at(i));
  }
  for (unsigned i = 0; i < 4; ++i) {
    bytes.at(28 + i) = static_cast<std::uint8_t>(crc.value() >> (8 * i));
  }
  EXPECT_EQ(newest(bytes, {}), record);
}

TEST(BoardRecordTest, AValueOutOfItsRangeLeavesTheNodeId) {
  BoardRecord record = record_of(9);
  record.highest_angle = -1;
  EXPECT_EQ(newest(encode(record, 1), {}), (BoardRecord{9, false, 0, 0}));
  record.node = 127;
  EXPECT_EQ(newest(encode(record, 1), {}), std::nullopt);
}

/// The record has a right checksum, so that more than the checksum is tested.
TEST(BoardRecordTest, ARecordOfAnyBytesGivesOnlyWhatIsInRange) {
  std::mt19937 noise(noise_seed);
  unsigned found = 0;
  for (int round = 0; round < 100'000; ++round) {
    std::array<std::uint8_t, BoardRecord::size> bytes{};
    Crc32 crc;
    for (std::size_t i = 0; i < 28; ++i) {
      bytes.at(i) = static_cast<std::uint8_t>(noise());
      if (i == 4 && round % 2 == 0) {
        bytes.at(i) %= 4U;
      }
      crc.add(bytes.at(i));
    }
    for (unsigned i = 0; i < 4; ++i) {
      bytes.at(28 + i) = static_cast<std::uint8_t>(crc.value() >> (8 * i));
    }
    if (const std::optional<BoardRecord> record = newest(bytes, {})) {
      ++found;
      ASSERT_TRUE(record->valid()) << "seed " << noise_seed << ", round " << round;
      ASSERT_EQ(record->node, bytes[5]);
    }
  }
  EXPECT_GT(found, 40'000U) << "half of the node ids are in range";
}

TEST(BoardRecordTest, RandomBytesHoldNone) {
  std::mt19937 noise(noise_seed);
  for (int round = 0; round < 1000; ++round) {
    FlashMemory flash;
    for (Sector& sector : flash.sectors) {
      for (std::uint8_t& byte : sector) {
        byte = static_cast<std::uint8_t>(noise());
      }
    }
    ASSERT_EQ(newest_of(flash), std::nullopt);
    ASSERT_EQ(append(flash, record_of(8)), AppendResult::ok);
    ASSERT_EQ(newest_of(flash), record_of(8));
  }
}

TEST(BoardRecordTest, TheLogGoesRoundBothSectorsForEver) {
  FlashMemory flash;
  for (unsigned i = 0; i < 1000; ++i) {
    ASSERT_EQ(append(flash, record_of(1 + i % 126)), AppendResult::ok);
    ASSERT_EQ(newest_of(flash), record_of(1 + i % 126));
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
    flash.noise.seed(noise_seed + static_cast<unsigned>(cut));
    bool was_cut = false;
    for (unsigned i = 1; i <= appends; ++i) {
      const std::optional<BoardRecord> before = newest_of(flash);
      try {
        ASSERT_EQ(append(flash, record_of(i)), AppendResult::ok);
      } catch (const PowerCut&) {
        was_cut = true;
        const std::optional<BoardRecord> found = newest_of(flash);
        ASSERT_TRUE(found == before || found == record_of(i)) << "cut " << cut << ", append " << i;
        ASSERT_EQ(append(flash, record_of(i)), AppendResult::ok) << "cut " << cut << ", append " << i;
      }
      ASSERT_EQ(newest_of(flash), record_of(i)) << "cut " << cut << ", append " << i;
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
        const std::optional<BoardRecord> before = newest_of(flash);
        for (int attempt = 0; attempt < 3; ++attempt) {
          try {
            ASSERT_EQ(append(flash, record_of(i)), AppendResult::ok);
            break;
          } catch (const PowerCut&) {
            ASSERT_TRUE(newest_of(flash) == before || newest_of(flash) == record_of(i)) << first << ", " << second;
            flash.cut_at = flash.cut_at == first ? flash.operations + second : -1;
          }
        }
        ASSERT_EQ(newest_of(flash), record_of(i)) << first << ", " << second;
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
  EXPECT_EQ(newest_of(flash), record_of(4));
  flash.refused_at = flash.operations + 3;
  EXPECT_EQ(append(flash, record_of(5)), AppendResult::program_failed);
  EXPECT_EQ(newest_of(flash), record_of(4));
  flash.refused_at = -1;
  EXPECT_EQ(append(flash, record_of(5)), AppendResult::ok);
  EXPECT_EQ(newest_of(flash), record_of(5));
}

TEST(BoardRecordTest, FlashThatHoldsSomethingElseThanWasWrittenIsReported) {
  class Worn final : public FlashPort {
   public:
    Sector sector = Sector(FlashMemory::sector_size, 0xFF);
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
