#include "sim/mcu/peripherals/flash_interface.hpp"

#include <algorithm>
#include <map>
#include <random>

#include "support/bench.hpp"

namespace proleg::sim {
namespace {

class Cells final : public FlashMemory {
 public:
  void read(std::uint32_t address, std::span<std::uint8_t> bytes) override {
    std::copy_n(cells.begin() + (address - flash_start), bytes.size(), bytes.begin());
  }
  void write(std::uint32_t address, std::span<const std::uint8_t> bytes) override {
    std::copy(bytes.begin(), bytes.end(), cells.begin() + (address - flash_start));
  }
  [[nodiscard]] std::uint32_t word(std::uint32_t address) const {
    std::uint32_t value = 0;
    for (std::uint32_t i = 4; i-- > 0;) {
      value = value << 8U | cells[address - flash_start + i];
    }
    return value;
  }

  std::vector<std::uint8_t> cells = std::vector<std::uint8_t>(1024 * 1024, 0xFF);
};

class FlashTest : public testing::Test {
 protected:
  static constexpr std::uint32_t acr = 0x00;
  static constexpr std::uint32_t keyr = 0x04;
  static constexpr std::uint32_t optkeyr = 0x08;
  static constexpr std::uint32_t sr = 0x0C;
  static constexpr std::uint32_t cr = 0x10;
  static constexpr std::uint32_t optcr = 0x14;

  static constexpr std::uint32_t eop = 1U << 0U;
  static constexpr std::uint32_t operr = 1U << 1U;
  static constexpr std::uint32_t wrperr = 1U << 4U;
  static constexpr std::uint32_t pgaerr = 1U << 5U;
  static constexpr std::uint32_t pgperr = 1U << 6U;
  static constexpr std::uint32_t pgserr = 1U << 7U;
  static constexpr std::uint32_t bsy = 1U << 16U;
  static constexpr std::uint32_t pg = 1U << 0U;
  static constexpr std::uint32_t ser = 1U << 1U;
  static constexpr std::uint32_t mer = 1U << 2U;
  static constexpr std::uint32_t x32 = 2U << 8U;
  static constexpr std::uint32_t strt = 1U << 16U;
  static constexpr std::uint32_t eopie = 1U << 24U;
  static constexpr std::uint32_t errie = 1U << 25U;
  static constexpr std::uint32_t lock = 1U << 31U;
  static constexpr LocalTime ms = 1000 * local_time_per_us;

  void unlock() {
    flash.write(keyr, 0x4567'0123);
    flash.write(keyr, 0xCDEF'89AB);
  }
  void finish() {
    if (flash.busy_until() > chip.time) {
      chip.run_until(flash.busy_until(), flash);
    }
  }
  void program(std::uint32_t address, std::uint32_t value) {
    flash.write(cr, pg | x32);
    EXPECT_TRUE(flash.program(address, 4, value));
    finish();
  }
  void fill(std::mt19937& random) {
    std::generate(memory.cells.begin(), memory.cells.end(), [&] { return static_cast<std::uint8_t>(random()); });
  }

  test::BenchChip chip;
  Cells memory;
  FlashInterface flash{chip, memory};
};

// RM0090 rev 21, 3.9.
TEST_F(FlashTest, ResetValuesAreThoseOfTheManual) {
  flash.write(acr, 0x705);
  unlock();
  flash.write(cr, pg);
  static_cast<void>(flash.program(flash_start, 4, 0));
  flash.reset();
  test::expect_values(flash, {{acr, 0}, {keyr, 0}, {optkeyr, 0}, {sr, 0}, {cr, 0x8000'0000}, {optcr, 0x0FFF'AAED}});
}

// RM0090 rev 21, table 5.
TEST_F(FlashTest, SectorsAreThoseOfTheManual) {
  const std::vector<std::uint32_t> starts = {0x0800'0000, 0x0800'4000, 0x0800'8000, 0x0800'C000,
                                             0x0801'0000, 0x0802'0000, 0x0804'0000, 0x0806'0000,
                                             0x0808'0000, 0x080A'0000, 0x080C'0000, 0x080E'0000};
  for (std::size_t i = 0; i < starts.size(); ++i) {
    EXPECT_EQ(flash_sectors[i].start, starts[i]);
  }
  EXPECT_EQ(flash_sectors[11].start + flash_sectors[11].size, 0x0810'0000U);
}

TEST_F(FlashTest, OnlyTheTwoKeysInOrderUnlock) {
  EXPECT_EQ(test::rejection([&] { flash.write(cr, pg); }), "FLASH_CR = 0x1 at offset 0x10: it is locked");
  flash.write(cr, lock);
  flash.write(keyr, 0x4567'0123);
  EXPECT_EQ(flash.read(cr), lock);
  flash.write(keyr, 0xCDEF'89AB);
  EXPECT_EQ(flash.read(cr), 0U);
  flash.write(cr, lock);
  EXPECT_EQ(flash.read(cr), lock);
  unlock();
  EXPECT_EQ(flash.read(cr), 0U);
}

TEST_F(FlashTest, AWrongKeyLocksUntilReset) {
  EXPECT_EQ(test::rejection([&] { flash.write(keyr, 0xCDEF'89AB); }),
            "FLASH_KEYR = 0xCDEF89AB at offset 0x4: not the key that comes next: a bus fault, and locked until reset "
            "(RM0090, 3.6.1)");
  EXPECT_NE(test::rejection([&] { unlock(); }), "");
  EXPECT_EQ(flash.read(cr), lock);
  flash.reset();
  unlock();
  EXPECT_EQ(flash.read(cr), 0U);
}

TEST_F(FlashTest, ProgrammingClearsBitsAfterSixteenMicroseconds) {
  unlock();
  flash.write(cr, pg | x32);
  EXPECT_TRUE(flash.program(0x0801'2340, 4, 0x1234'5678));
  const LocalTime end = 16 * local_time_per_us;
  EXPECT_EQ(flash.busy_until(), end);
  chip.run_until(end - 1, flash);
  EXPECT_EQ(flash.read(sr), bsy);
  EXPECT_EQ(memory.word(0x0801'2340), 0xFFFF'FFFFU);
  chip.run_until(end, flash);
  EXPECT_EQ(flash.read(sr), 0U);
  EXPECT_EQ(memory.word(0x0801'2340), 0x1234'5678U);
  EXPECT_TRUE(flash.program(0x0801'2340, 4, 0xFFFF'0000));
  finish();
  EXPECT_EQ(memory.word(0x0801'2340), 0x1234'0000U);
}

TEST_F(FlashTest, AStoreDuringAnOperationIsDoneAfterIt) {
  unlock();
  flash.write(cr, pg | x32);
  EXPECT_TRUE(flash.program(flash_start, 4, 1));
  EXPECT_TRUE(flash.program(flash_start + 4, 4, 2));
  EXPECT_EQ(flash.busy_until(), 32 * local_time_per_us);
  chip.run_until(16 * local_time_per_us, flash);
  EXPECT_EQ(memory.word(flash_start), 1U);
  EXPECT_EQ(memory.word(flash_start + 4), 0xFFFF'FFFFU);
  EXPECT_EQ(flash.read(sr), bsy);
  finish();
  EXPECT_EQ(memory.word(flash_start + 4), 2U);
}

TEST_F(FlashTest, StoresOfAnotherSizeThanPsizeAreErrors) {
  unlock();
  for (std::uint32_t psize = 0; psize < 3; ++psize) {
    flash.write(cr, pg | psize << 8U);
    for (std::uint32_t log = 0; log < 3; ++log) {
      EXPECT_TRUE(flash.program(flash_start + 16 * (3 * psize + log), 1U << log, 0));
      finish();
      EXPECT_EQ(flash.read(sr), log == psize ? 0U : pgperr);
      flash.write(sr, 0xF3);
      EXPECT_EQ(flash.read(sr), 0U);
      const std::uint32_t expected = log != psize ? 0xFFFF'FFFF : log == 0 ? 0xFFFF'FF00 : log == 1 ? 0xFFFF'0000 : 0;
      EXPECT_EQ(memory.word(flash_start + 16 * (3 * psize + log)), expected);
    }
  }
}

TEST_F(FlashTest, RejectedStoresSetFlags) {
  static_cast<void>(flash.program(flash_start, 1, 0));
  EXPECT_EQ(flash.read(sr), pgserr) << "without PG";
  flash.write(sr, pgserr);
  unlock();
  flash.write(cr, pg | x32 | errie);
  static_cast<void>(flash.program(flash_start + 14, 4, 0));
  EXPECT_EQ(flash.read(sr), pgaerr | pgperr | operr);
  EXPECT_TRUE(chip.interrupts.contains(FlashInterface::interrupt_position));
  flash.write(sr, pgaerr | pgperr | operr);
  EXPECT_FALSE(chip.interrupts.contains(FlashInterface::interrupt_position));
  EXPECT_FALSE(flash.program(0x0810'0000, 4, 0));
  EXPECT_FALSE(flash.program(0x080F'FFFE, 4, 0));
  EXPECT_TRUE(std::all_of(memory.cells.begin(), memory.cells.end(), [](std::uint8_t cell) { return cell == 0xFF; }));
}

TEST_F(FlashTest, TheEndOfAnOperationInterruptsIfAsked) {
  unlock();
  program(flash_start, 1);
  EXPECT_EQ(flash.read(sr), 0U) << "EOP needs EOPIE";
  flash.write(cr, pg | x32 | eopie);
  static_cast<void>(flash.program(flash_start + 4, 4, 0));
  EXPECT_TRUE(chip.interrupts.empty());
  finish();
  EXPECT_EQ(flash.read(sr), eop);
  EXPECT_TRUE(chip.interrupts.contains(4));
  flash.write(sr, eop);
  EXPECT_TRUE(chip.interrupts.empty());
}

// DS8626, flash memory programming: typical durations.
TEST_F(FlashTest, ErasingTakesTheTimeOfTheDatasheet) {
  struct Row {
    std::uint32_t command;
    std::array<LocalTime, 3> ms;  ///< x8, x16, x32
    std::uint32_t start;
    std::uint32_t size;
  };
  const std::vector<Row> rows = {{ser | 1U << 3U, {400, 300, 250}, 0x4000, 0x4000},
                                 {ser | 4U << 3U, {1200, 700, 550}, 0x1'0000, 0x1'0000},
                                 {ser | 11U << 3U, {2000, 1300, 1000}, 0xE'0000, 0x2'0000},
                                 {mer, {16'000, 11'000, 8'000}, 0, 0x10'0000},
                                 {mer | ser, {16'000, 11'000, 8'000}, 0, 0x10'0000}};
  std::mt19937 random(1);
  unlock();
  for (const Row& row : rows) {
    for (std::uint32_t psize = 0; psize < 3; ++psize) {
      fill(random);
      std::vector<std::uint8_t> expected = memory.cells;
      flash.write(cr, row.command | psize << 8U);
      const LocalTime now = chip.time;
      flash.write(cr, row.command | psize << 8U | strt);
      EXPECT_EQ(flash.busy_until(), now + row.ms[psize] * ms);
      EXPECT_EQ(flash.read(cr) & strt, strt);
      chip.run_until(flash.busy_until() - 1, flash);
      EXPECT_EQ(memory.cells, expected);
      chip.run_until(chip.time + 1, flash);
      std::fill_n(expected.begin() + row.start, row.size, std::uint8_t{0xFF});
      EXPECT_EQ(memory.cells, expected);
      EXPECT_EQ(flash.read(cr) & strt, 0U);
      EXPECT_EQ(flash.read(sr), 0U);
    }
  }
}

TEST_F(FlashTest, ProtectedSectorsDoNotChange) {
  FlashInterface guarded(chip, memory, 0b101);
  EXPECT_EQ(guarded.read(optcr), 0x0FFA'AAEDU);
  guarded.write(keyr, 0x4567'0123);
  guarded.write(keyr, 0xCDEF'89AB);
  for (const std::uint32_t command : {ser | 0U << 3U, ser | 2U << 3U, mer}) {
    guarded.write(cr, command | x32 | strt);
    EXPECT_EQ(guarded.read(sr), wrperr);
    guarded.write(sr, wrperr);
  }
  guarded.write(cr, pg | x32);
  static_cast<void>(guarded.program(0x0800'3FFC, 4, 0));
  EXPECT_EQ(guarded.read(sr), wrperr);
  guarded.write(sr, wrperr);
  static_cast<void>(guarded.program(0x0800'4000, 4, 0));
  EXPECT_EQ(guarded.read(sr), bsy);
}

// RM0090, section 3.6.4: a write changes the flash and the data cache.
TEST_F(FlashTest, AWeakWordIsReadAsItWasWrittenUntilTheDataCacheIsCleared) {
  constexpr std::uint32_t address = 0x0800'8000;
  constexpr std::uint32_t dcen = 1U << 10U;
  constexpr std::uint32_t dcrst = 1U << 12U;
  flash.set_weak_word(address, 0x11);
  unlock();
  flash.write(cr, pg | x32);
  for (const bool has_cache : {true, false}) {
    memory.cells[address - flash_start] = 0xFF;
    flash.write(acr, has_cache ? dcen : 0);
    EXPECT_TRUE(flash.program(address, 4, 0xFFFF'FF00));
    finish();
    EXPECT_EQ(memory.word(address), has_cache ? 0xFFFF'FF00U : 0xFFFF'FF11U);
    flash.write(acr, 0);
    flash.write(acr, dcrst);
    EXPECT_EQ(memory.word(address), 0xFFFF'FF11U);
    EXPECT_EQ(flash.read(sr) & ~eop, 0U) << "the hardware does not report it";
  }
  EXPECT_TRUE(flash.program(address + 4, 4, 0));
  finish();
  EXPECT_EQ(memory.word(address + 4), 0U);
}

TEST_F(FlashTest, RandomProgramsAndErasesDoWhatAnArrayDoes) {
  constexpr unsigned seed = 20'240;
  std::mt19937 random(seed);
  fill(random);
  std::vector<std::uint8_t> model = memory.cells;
  unlock();
  for (int step = 0; step < 3000; ++step) {
    if (random() % 50 == 0) {
      const std::uint32_t sector = static_cast<std::uint32_t>(random() % 12);
      flash.write(cr, ser | sector << 3U | x32 | strt);
      std::fill_n(model.begin() + (flash_sectors[sector].start - flash_start), flash_sectors[sector].size,
                  std::uint8_t{0xFF});
    } else {
      const std::uint32_t log = static_cast<std::uint32_t>(random() % 3);
      const std::uint32_t size = 1U << log;
      const std::uint32_t offset = static_cast<std::uint32_t>(random() % (1024 * 1024 / size)) * size;
      const std::uint32_t value = static_cast<std::uint32_t>(random());
      flash.write(cr, pg | log << 8U);
      EXPECT_TRUE(flash.program(flash_start + offset, size, value));
      for (std::uint32_t i = 0; i < size; ++i) {
        model[offset + i] &= static_cast<std::uint8_t>(value >> (8 * i));
      }
    }
    finish();
    EXPECT_EQ(flash.read(sr), 0U);
  }
  EXPECT_EQ(memory.cells, model) << "seed " << seed;
}

TEST_F(FlashTest, ACutOperationLeavesBitsBetweenOldAndNew) {
  constexpr unsigned seed = 4711;
  std::mt19937 random(seed);
  for (std::uint64_t cut = 0; cut < 20; ++cut) {
    fill(random);
    const std::vector<std::uint8_t> old = memory.cells;
    std::vector<std::uint8_t> goal = old;
    flash.reset();
    unlock();
    if (cut % 2 == 0) {
      std::fill_n(goal.begin() + 0x4000, 0x4000, std::uint8_t{0xFF});
      flash.write(cr, ser | 1U << 3U | x32 | strt);
    } else {
      std::fill_n(goal.begin() + 0x4000, 4, std::uint8_t{0});
      flash.write(cr, pg | x32);
      EXPECT_TRUE(flash.program(flash_start + 0x4000, 4, 0));
      EXPECT_TRUE(flash.program(flash_start + 0x4004, 4, 0));  // has not begun
    }
    chip.time += 10;
    flash.cut(cut);
    EXPECT_EQ(flash.busy_until(), 0U);
    std::size_t changed = 0;
    for (std::size_t i = 0; i < old.size(); ++i) {
      const unsigned moved = static_cast<unsigned>(old[i] ^ memory.cells[i]);
      EXPECT_EQ(moved & ~static_cast<unsigned>(old[i] ^ goal[i]), 0U) << "seed " << seed << ", cut " << cut;
      changed += moved != 0 ? 1 : 0;
    }
    if (cut % 2 == 0) {
      EXPECT_GT(changed, 0x2000U);
      EXPECT_NE(memory.cells, goal);
    }
    // The same seed leaves the same bits.
    const std::vector<std::uint8_t> left = memory.cells;
    memory.cells = old;
    flash.reset();
    unlock();
    if (cut % 2 == 0) {
      flash.write(cr, ser | 1U << 3U | x32 | strt);
    } else {
      flash.write(cr, pg | x32);
      EXPECT_TRUE(flash.program(flash_start + 0x4000, 4, 0));
    }
    flash.cut(cut);
    EXPECT_EQ(memory.cells, left);
  }
}

TEST_F(FlashTest, ACutWithoutOperationChangesNothing) {
  unlock();
  program(flash_start, 0x5555'AAAA);
  flash.cut(1);
  EXPECT_EQ(memory.word(flash_start), 0x5555'AAAAU);
}

// RM0090, table 10, 2.7 to 3.6 V.
TEST_F(FlashTest, WaitStatesFollowTheCore) {
  const std::map<std::uint32_t, unsigned> table = {{16, 0}, {24, 0},  {42, 1},  {48, 1},  {63, 2},
                                                   {84, 2}, {112, 3}, {126, 4}, {144, 4}, {168, 5}};
  for (const auto& [mhz, states] : table) {
    EXPECT_EQ(flash_wait_states(local_time_per_us / mhz), states) << mhz;
  }
  chip.settings = test::full_speed;
  EXPECT_EQ(test::rejection([&] { flash.write(acr, 0x704); }),
            "FLASH_ACR = 0x704 at offset 0x0: 4 wait states, HCLK needs 5 (RM0090, table 10)");
  flash.write(acr, 0x705);
  EXPECT_EQ(flash.read(acr), 0x705U);
  EXPECT_EQ(flash.wait_states(), 5U);
}

// RM0090, table 10: the rows of the voltages below 2.7 V.
TEST_F(FlashTest, WaitStatesFollowTheVoltage) {
  struct Case {
    std::uint32_t mv;
    LocalTime core_period;
    unsigned wait_states;
    std::string fault;
  };
  const std::string source = " (RM0090, table 10)";
  for (const Case& one :
       {Case{2'700, 6, 5, ""},
        Case{2'699, 6, 5, "HCLK of 168 MHz at 2.699 V needs 6 wait states, FLASH_ACR has 5" + source},
        Case{2'400, 6, 6, ""},
        Case{2'390, 6, 6, "HCLK of 168 MHz at 2.39 V needs 7 wait states, FLASH_ACR has 6" + source},
        Case{2'100, 6, 7, ""}, Case{2'090, 6, 7, "HCLK of 168 MHz at 2.09 V: at most 160 MHz" + source},
        Case{2'090, 7, 7, "HCLK of 144 MHz at 2.09 V: the prefetch must be off" + source},
        Case{2'000, 12, 3, "HCLK of 84 MHz at 2.0 V needs 4 wait states, FLASH_ACR has 3" + source}}) {
    flash.write(acr, 0x700 | one.wait_states);
    flash.set_supply(one.mv);
    EXPECT_EQ(flash.speed_fault(one.core_period).value_or(""), one.fault);
  }
  flash.write(acr, 0);
  EXPECT_FALSE(flash.speed_fault(local_time_per_us / 16)) << "after a reset, at any voltage";
}

TEST_F(FlashTest, WordsNeedASupplyOf2700Millivolts) {
  unlock();
  flash.set_supply(2'690);
  EXPECT_NE(test::rejection([&] { flash.write(cr, pg | x32); }).find("PSIZE x32 at 2.69 V: at least 2.7 V"),
            std::string::npos);
  EXPECT_NE(test::rejection([&] { flash.write(cr, ser | x32 | strt); }).find("PSIZE x32"), std::string::npos);
  flash.set_supply(2'700);
  program(flash_start, 0);
  EXPECT_EQ(memory.word(flash_start), 0U);
}

TEST_F(FlashTest, RejectsWhatTheManualForbids) {
  unlock();
  EXPECT_NE(test::rejection([&] { flash.write(cr, pg | 3U << 8U); }).find("PSIZE x64"), std::string::npos);
  EXPECT_NE(test::rejection([&] { flash.write(cr, x32 | strt); }).find("STRT without SER or MER"), std::string::npos);
  EXPECT_NE(test::rejection([&] { flash.write(cr, ser | 12U << 3U | strt); }).find("SNB = 12"), std::string::npos);
  flash.write(cr, ser | x32 | strt);
  EXPECT_NE(test::rejection([&] { flash.write(cr, 0); }).find("written while BSY is set"), std::string::npos);
  EXPECT_EQ(test::rejection([&] { flash.write(optcr, 0x0FFE'AAEC); }),
            "FLASH_OPTCR = 0xFFEAAEC at offset 0x14: it is locked");
  flash.write(optkeyr, 0x0819'2A3B);
  flash.write(optkeyr, 0x4C5D'6E7F);
  EXPECT_EQ(flash.read(optcr), 0x0FFF'AAECU);
  flash.write(optcr, 0x0FFE'AAEC);
  EXPECT_EQ(test::rejection([&] { flash.write(optcr, 0x0FFE'AAEE); }),
            "FLASH_OPTCR = 0xFFEAAEE at offset 0x14: programming option bytes is not modelled");
}

}  // namespace
}  // namespace proleg::sim
