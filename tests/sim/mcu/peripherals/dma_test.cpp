#include "sim/mcu/peripherals/dma.hpp"

#include <deque>
#include <functional>
#include <random>

#include "sim/mcu/peripherals/adc.hpp"
#include "sim/mcu/peripherals/timer.hpp"
#include "support/bench.hpp"

namespace proleg::sim {
namespace {

// RM0090 rev 21, 10.5.
constexpr std::uint32_t lisr = 0x00;
constexpr std::uint32_t lifcr = 0x08;
constexpr std::uint32_t s0cr = 0x10;
constexpr std::uint32_t s0ndtr = 0x14;
constexpr std::uint32_t s0par = 0x18;
constexpr std::uint32_t s0m0ar = 0x1C;
constexpr std::uint32_t enabled_circular = 0x2D01;  ///< EN, CIRC, MINC, 16 bits on both sides
constexpr std::uint32_t adc1_dr = 0x4001'204C;
constexpr std::uint32_t buffer = 0x2000'1000;

/// A peripheral with halfwords to fetch.
struct Source final : DmaPeripheral {
  [[nodiscard]] bool requests_dma() const override { return !pending.empty(); }
  [[nodiscard]] std::uint16_t dma_read() override {
    const std::uint16_t data = pending.front();
    pending.pop_front();
    return data;
  }
  std::deque<std::uint16_t> pending;
};

/// A peripheral with room for bytes.
struct Sink final : DmaPeripheral {
  [[nodiscard]] bool requests_dma() const override { return room > 0; }
  void dma_write(std::uint16_t data) override {
    --room;
    taken.push_back(data);
  }
  unsigned room = 0;
  std::vector<std::uint16_t> taken;
};

class DmaTest : public testing::Test {
 protected:
  DmaTest() { dma.connect({0, 0, Dma::Direction::from_peripheral, 2, adc1_dr}, source); }

  /// Whether the stream took it.
  bool transfer(std::uint16_t data) {
    source.pending.push_back(data);
    dma.serve(0);
    return source.pending.empty();
  }
  void enable(std::uint32_t count) {
    dma.write(s0par, adc1_dr);
    dma.write(s0m0ar, buffer);
    dma.write(s0ndtr, count);
    dma.write(s0cr, enabled_circular);
  }

  test::BenchChip chip;
  std::vector<std::pair<std::uint32_t, unsigned>> written;
  Source source;
  Dma dma{chip, 2, {{}, [this](std::uint32_t address, std::span<const std::uint8_t> bytes) {
                      ASSERT_EQ(bytes.size(), 2U);
                      written.emplace_back(address, bytes[0] | unsigned{bytes[1]} << 8U);
                    }}};
};

TEST_F(DmaTest, ResetValuesAreThoseOfTheManual) {
  enable(3);
  dma.reset();
  test::expect_values(dma, {{lisr, 0}, {0x04, 0}, {s0cr, 0}, {s0ndtr, 0}, {s0par, 0}, {s0m0ar, 0}, {0x24, 0x21}});
}

TEST_F(DmaTest, WritesHalfwordsInACircleAndCountsDown) {
  EXPECT_FALSE(transfer(0x111)) << "off: it waits";
  EXPECT_TRUE(written.empty());
  enable(4);
  EXPECT_EQ(written.size(), 1U) << "at once";
  std::vector<std::uint32_t> counts{dma.read(s0ndtr)};
  for (const std::uint16_t data : std::array<std::uint16_t, 4>{0x222, 0x333, 0x444, 0x555}) {
    EXPECT_TRUE(transfer(data));
    counts.push_back(dma.read(s0ndtr));
  }
  EXPECT_EQ(counts, (std::vector<std::uint32_t>{3, 2, 1, 4, 3}));
  EXPECT_EQ(written,
            (std::vector<std::pair<std::uint32_t, unsigned>>{
                {buffer, 0x111}, {buffer + 2, 0x222}, {buffer + 4, 0x333}, {buffer + 6, 0x444}, {buffer, 0x555}}));
  EXPECT_EQ(dma.read(lisr), 0x30U) << "half and whole";
  dma.write(lifcr, 0x30);
  EXPECT_EQ(dma.read(lisr), 0U);
}

TEST_F(DmaTest, RejectsWhatItDoesNotModelByName) {
  enable(4);
  EXPECT_EQ(test::rejection([&] { dma.write(s0ndtr, 5); }),
            "DMA2_S0NDTR = 0x5 at offset 0x14: the stream is enabled (RM0090, 10.5)");
  dma.write(s0cr, 0);
  EXPECT_EQ(test::rejection([&] { dma.write(s0cr, enabled_circular | 1U << 25U); }),
            "DMA2_S0CR = 0x2002D01 at offset 0x10: channel 1 of stream 0 is not modelled");
  EXPECT_NE(test::rejection([&] { dma.write(s0cr, enabled_circular | 1U << 6U); }), "") << "to the peripheral";
  EXPECT_NE(test::rejection([&] { dma.write(s0cr, enabled_circular & ~(1U << 11U)); }), "")
      << "bytes from the peripheral";
  EXPECT_NE(test::rejection([&] { dma.write(0x28, 1); }), "") << "stream 1";
  EXPECT_NE(test::rejection([&] { dma.write(0x24, 4); }), "") << "FIFO";
  dma.write(s0m0ar, 0x2002'0000);
  EXPECT_NE(test::rejection([&] { dma.write(s0cr, enabled_circular); }), "") << "beyond the RAM";
}

// RM0090, 10.5.1 to 10.5.4 and table 61: the flags of stream 6 are bits 16 to 21 of HISR, its interrupt is position 17.
TEST_F(DmaTest, SendsBytesOnceAndEndsWithItsInterrupt) {
  constexpr std::uint32_t s6cr = 0xA0;
  constexpr std::uint32_t once = 4U << 25U | 1U << 10U | 1U << 6U | 1U << 4U | 1U;  // channel 4, MINC, DIR, TCIE, EN
  Sink sink;
  Dma sender{chip,
             1,
             {[](std::uint32_t address, std::span<std::uint8_t> bytes) {
                ASSERT_EQ(bytes.size(), 1U);
                bytes[0] = static_cast<std::uint8_t>(address);
              },
              {}}};
  sender.connect({6, 4, Dma::Direction::to_peripheral, 1, 0x4000'4404}, sink);
  EXPECT_EQ(sender.base(), 0x4002'6000U);
  sender.write(s6cr + 8, 0x4000'4404);
  sender.write(s6cr + 12, 0x2000'0010);
  sender.write(s6cr + 4, 3);
  EXPECT_NE(test::rejection([&] { sender.write(s6cr, once | 1U << 8U); }), "") << "in a circle";
  sink.room = 2;
  sender.write(s6cr, once);
  EXPECT_EQ(sink.taken, (std::vector<std::uint16_t>{0x10, 0x11})) << "as many as it has room for";
  EXPECT_EQ(sender.read(s6cr + 4), 1U);
  EXPECT_TRUE(chip.interrupts.empty());
  sink.room = 5;
  sender.serve(6);
  EXPECT_EQ(sink.taken, (std::vector<std::uint16_t>{0x10, 0x11, 0x12}));
  EXPECT_EQ(sender.read(s6cr) & 1U, 0U) << "off";
  EXPECT_EQ(sender.read(0x04), 0x30U << 16U);
  EXPECT_TRUE(chip.interrupts.contains(17));
  sender.write(s6cr + 4, 3);
  EXPECT_NE(test::rejection([&] { sender.write(s6cr, once); }), "") << "flags";
  sender.write(0x0C, 0x30U << 16U);
  EXPECT_FALSE(chip.interrupts.contains(17));
  sender.write(s6cr, once);
  EXPECT_EQ(sink.taken.size(), 6U);
}

// Stream 5: bits 6 to 11, position 16. HTIE and TCIE.
TEST_F(DmaTest, InterruptsAtTheHalfAndTheEndOfACircle) {
  Source bytes;
  std::vector<std::uint32_t> addresses;
  Dma receiver{chip, 1, {{}, [&](std::uint32_t address, std::span<const std::uint8_t> data) {
                           ASSERT_EQ(data.size(), 1U);
                           addresses.push_back(address);
                         }}};
  receiver.connect({5, 4, Dma::Direction::from_peripheral, 1, 0x4000'4404}, bytes);
  receiver.write(0x90, 0x4000'4404);
  receiver.write(0x94, buffer + 1);
  receiver.write(0x8C, 4);
  receiver.write(0x88, 4U << 25U | 1U << 10U | 1U << 8U | 3U << 3U | 1U);
  const auto put = [&](std::uint16_t byte) {
    bytes.pending.push_back(byte);
    receiver.serve(5);
  };
  put(1);
  EXPECT_FALSE(chip.interrupts.contains(16));
  put(2);
  EXPECT_EQ(receiver.read(0x04), 1U << 10U);
  EXPECT_TRUE(chip.interrupts.contains(16));
  receiver.write(0x0C, 1U << 10U);
  EXPECT_FALSE(chip.interrupts.contains(16));
  put(3);
  put(4);
  put(5);
  EXPECT_EQ(receiver.read(0x04), 1U << 11U);
  EXPECT_EQ(receiver.read(0x8C), 3U);
  EXPECT_EQ(addresses, (std::vector<std::uint32_t>{buffer + 1, buffer + 2, buffer + 3, buffer + 4, buffer + 1}));
}

/// TIM3 starts conversions, whose results DMA writes.
TEST_F(DmaTest, TakesTheConversionsThatTheTimerStarts) {
  chip.settings = test::full_speed;
  test::BenchBoard board;
  board.voltages[5] = 1'650'000;
  Adc adc(chip, board, &dma);
  Timer timer(chip, 3);
  timer.connect_trigger_output(adc);
  enable(8);
  adc.write(0x304, 1U << 16U);  // PCLK2 / 4
  adc.write(0x34, 5);
  // ADON, DMA, DDS, EXTSEL = TIM3_TRGO, EXTEN = rising edge (13.13.3, table 68).
  adc.write(0x08, 0x1800'0301);
  timer.write(0x28, 83);
  timer.write(0x2C, 238);
  timer.write(0x14, 1);
  timer.write(0x04, 0x20);
  timer.write(0x00, 1);
  const LocalTime start = chip.time;
  while (written.size() < 5) {
    chip.time = std::min(timer.next_event(), adc.next_event());
    timer.advance();
    adc.advance();
  }
  // The counter starts one clock after CEN; a conversion takes 15 ADC clocks of 48.
  EXPECT_EQ(chip.time, start + 12 + 5 * 239 * local_time_per_us + 15 * 48);
  EXPECT_EQ(written.back(), (std::pair{buffer + 8, 2'048U}));
  EXPECT_EQ(adc.read(0x00) & 0x22U, 0U) << "no EOC: DMA has read DR; no overrun";
  dma.write(s0cr, 0);
  for (unsigned i = 0; i < 4; ++i) {
    chip.time = std::min(timer.next_event(), adc.next_event());
    timer.advance();
    adc.advance();
  }
  EXPECT_EQ(adc.read(0x00) & 0x20U, 0x20U) << "overrun without DMA (13.8.1)";
}

/// TIM3, ADC1 and DMA2 as the module's program sets them, at full speed. The CPU sleeps: nobody reads a register.
class Sampling {
 public:
  static constexpr LocalTime us = local_time_per_us;
  static constexpr LocalTime period = 239 * us;
  static constexpr LocalTime conversion = 15 * 48;  ///< ADC clocks, at 21 MHz
  static constexpr unsigned channel = 10;
  static constexpr std::uint32_t ring_size = 32;
  static constexpr std::uint32_t cr2_on = 0x1800'0301;  ///< ADON, DMA, DDS, TIM3_TRGO, rising edge

  Sampling() {
    chip.settings = test::full_speed;
    timer.connect_trigger_output(adc);
    dma.write(s0par, adc1_dr);
    dma.write(s0m0ar, buffer);
    dma.write(s0ndtr, ring_size);
    dma.write(s0cr, enabled_circular);
    adc.write(0x304, 1U << 16U);  // PCLK2 / 4
    adc.write(0x34, channel);
    adc.write(0x38, 3U << 15U);  // injected: channel 3
    adc.write(0x08, cr2_on);
    chip.time += 10 * us;
    timer.write(0x28, 83);
    timer.write(0x2C, 238);
    timer.write(0x14, 1);
    timer.write(0x04, 0x20);
    timer.write(0x00, 1);
    first_trigger = chip.time + 12 + period;  // one clock after CEN
  }

  /// What an awake CPU needs: each event in its time.
  void run_by_events(LocalTime end) {
    for (LocalTime next = next_event(); next <= end; next = next_event()) {
      chip.time = next;
      catch_up();
    }
    chip.time = end;
  }
  /// What a sleeping CPU needs.
  void skip_to(LocalTime end) {
    chip.time = end;
    catch_up();
  }
  void catch_up() {
    timer.advance();
    adc.advance();
  }
  [[nodiscard]] LocalTime next_event() const { return std::min(timer.next_event(), adc.next_event()); }
  [[nodiscard]] LocalTime next_visible_event() const {
    return std::min(timer.next_visible_event(), adc.next_visible_event());
  }

  /// Memory and all registers that a program can read.
  [[nodiscard]] std::vector<std::uint32_t> state() {
    std::vector<std::uint32_t> values;
    for (const std::uint32_t offset : {lisr, s0cr, s0ndtr}) {
      values.push_back(dma.read(offset));
    }
    for (const std::uint32_t offset : {0x00U, 0x04U, 0x08U, 0x3CU}) {
      values.push_back(adc.read(offset));
    }
    for (const std::uint32_t offset : {0x10U, 0x24U}) {
      values.push_back(timer.read(offset));
    }
    for (const auto& [address, data] : written) {
      values.push_back(address);
      values.push_back(data);
    }
    return values;
  }

  test::BenchChip chip;
  test::BenchBoard board;
  std::vector<std::pair<std::uint32_t, unsigned>> written;
  Dma dma{chip, 2, {{}, [this](std::uint32_t address, std::span<const std::uint8_t> bytes) {
                      written.emplace_back(address, bytes[0] | unsigned{bytes[1]} << 8U);
                    }}};
  Adc adc{chip, board, &dma};
  Timer timer{chip, 3};
  LocalTime first_trigger = 0;
};

// RM0090, 13.8.1: the steps that end an overrun, each of which is needed.
TEST(OverrunOfTheAdc, LastsUntilTheStreamWasStartedAgainAndOvrWasCleared) {
  constexpr std::uint32_t adc_sr = 0x00;
  constexpr std::uint32_t eoc_and_ovr = 0x22;
  const auto overrun = [](Sampling& sampling) {
    sampling.skip_to(10 * Sampling::period);
    sampling.adc.set_dma_reach(false);
    sampling.skip_to(20 * Sampling::period);
    sampling.adc.set_dma_reach(true);
    sampling.written.clear();
  };
  const auto restart_stream = [](Sampling& sampling) {
    sampling.dma.write(s0cr, 0);
    sampling.dma.write(lifcr, 0x3D);
    sampling.dma.write(s0ndtr, Sampling::ring_size);
    sampling.dma.write(s0cr, enabled_circular);
  };
  const auto is_sampling = [](Sampling& sampling) {
    sampling.skip_to(sampling.chip.time + 5 * Sampling::period);
    return sampling.written.size() == 5;
  };
  Sampling untouched;
  overrun(untouched);
  EXPECT_FALSE(is_sampling(untouched));
  EXPECT_TRUE(untouched.written.empty());
  EXPECT_EQ(untouched.adc.read(adc_sr) & eoc_and_ovr, eoc_and_ovr);

  Sampling cleared;
  overrun(cleared);
  cleared.adc.write(adc_sr, ~eoc_and_ovr);
  EXPECT_FALSE(is_sampling(cleared));
  EXPECT_TRUE(cleared.written.empty()) << "the stream was not started again";
  EXPECT_EQ(cleared.adc.read(adc_sr) & eoc_and_ovr, eoc_and_ovr) << "an overrun again";

  Sampling restarted;
  overrun(restarted);
  restart_stream(restarted);
  EXPECT_FALSE(is_sampling(restarted)) << "OVR was not cleared";
  restarted.adc.write(adc_sr, ~eoc_and_ovr);
  EXPECT_TRUE(is_sampling(restarted));
}

TEST(OverrunOfTheAdc, FollowsATransferErrorOfTheStream) {
  Sampling sampling;
  sampling.skip_to(10 * Sampling::period);
  sampling.dma.fail(0);
  EXPECT_EQ(sampling.dma.read(lisr) & 0x3DU, 0x8U) << "TEIF";
  EXPECT_EQ(sampling.dma.read(s0cr) & 1U, 0U) << "EN";
  sampling.skip_to(13 * Sampling::period);
  EXPECT_EQ(sampling.adc.read(0x00) & 0x20U, 0x20U);
}

TEST(SamplesOfASleepingCpu, AreNoVisibleEventsOnceATriggerHasStartedAConversion) {
  Sampling sampling;
  EXPECT_EQ(sampling.next_visible_event(), sampling.first_trigger) << "it could leave the model";
  sampling.run_by_events(sampling.first_trigger);
  EXPECT_EQ(sampling.next_event(), sampling.first_trigger + Sampling::conversion);
  EXPECT_EQ(sampling.next_visible_event(), never_on_chip);
  sampling.adc.write(0x08, Sampling::cr2_on | 1U << 22U);  // JSWSTART
  EXPECT_EQ(sampling.next_visible_event(), never_on_chip);
}

TEST(SamplesOfASleepingCpu, AreVisibleWhileAnInterruptOfTheAdcIsEnabled) {
  for (const std::uint32_t interrupt : {1U << 5U, 1U << 7U, 1U << 26U}) {
    Sampling sampling;
    sampling.adc.write(0x04, interrupt);
    for (unsigned i = 0; i < 10; ++i) {
      EXPECT_EQ(sampling.next_visible_event(), sampling.next_event());
      sampling.run_by_events(sampling.next_event());
    }
  }
}

TEST(SamplesOfASleepingCpu, AreVisibleWhenTheNextTriggerMayLeaveTheModel) {
  const std::vector<std::pair<const char*, std::function<void(Sampling&)>>> changes{
      {"another clock of the ADC", [](Sampling& on) { on.adc.write(0x304, 0); }},
      {"off and on", [](Sampling& on) { on.adc.write(0x08, Sampling::cr2_on & ~1U); }},
      {"another channel", [](Sampling& on) { on.adc.write(0x34, 16); }},
      {"a longer sequence", [](Sampling& on) { on.adc.write(0x2C, 1U << 20U); }}};
  for (const auto& [what, change] : changes) {
    Sampling sampling;
    sampling.run_by_events(sampling.first_trigger + Sampling::conversion);
    ASSERT_EQ(sampling.next_visible_event(), never_on_chip);
    change(sampling);
    const LocalTime next = sampling.first_trigger + Sampling::period;
    EXPECT_EQ(sampling.next_visible_event(), next) << what;
    EXPECT_NE(test::rejection([&] { sampling.run_by_events(next); }), "") << what;
  }
}

TEST(SamplesOfASleepingCpu, HaveTheVoltageOfTheirOwnTime) {
  constexpr LocalTime step = 1'000 * Sampling::us;
  constexpr unsigned steps = 200;
  const auto voltage_at = [](LocalTime time) { return static_cast<std::uint32_t>(time / step * 15'000); };
  Sampling sampling;
  for (unsigned i = 1; i <= steps; ++i) {
    sampling.skip_to(i * step - 1);
    sampling.board.voltages[Sampling::channel] = voltage_at(i * step);
  }
  ASSERT_EQ(sampling.written.size(),
            (steps * step - 1 - sampling.first_trigger - Sampling::conversion) / Sampling::period + 1);
  for (std::size_t i = 0; i < sampling.written.size(); ++i) {
    const LocalTime end = sampling.first_trigger + i * Sampling::period + Sampling::conversion;
    EXPECT_EQ(sampling.written[i], (std::pair{static_cast<std::uint32_t>(buffer + 2 * (i % Sampling::ring_size)),
                                              unsigned{adc_code(voltage_at(end))}}));
  }
}

TEST(SamplesOfASleepingCpu, LeaveTheSameAsThoseOfOneThatIsAwake) {
  const auto change = [](Sampling& sampling, unsigned kind, std::uint32_t value) {
    switch (kind) {
      case 0:
        sampling.adc.set_dma_reach(false);
        break;
      case 1:
        sampling.adc.set_dma_reach(true);
        break;
      case 2:
        sampling.dma.write(s0cr, 0);  // an overrun follows
        break;
      case 3:
        sampling.dma.write(lifcr, 0x30);
        sampling.dma.write(s0cr, enabled_circular);
        break;
      case 4:
        sampling.adc.write(0x00, 0xC);  // clears EOC, STRT and OVR
        break;
      case 5:
        if ((sampling.adc.read(0x00) & 0xCU) != 0x8U) {  // not while it is converted
          sampling.adc.write(0x00, 0x32);                // clears JEOC and JSTRT
          sampling.adc.write(0x08, Sampling::cr2_on | 1U << 22U);
        }
        break;
      default:
        sampling.board.voltages[Sampling::channel] = value;
        sampling.board.voltages[3] = 3'300'000 - value;
    }
  };
  const std::uint32_t seed = std::random_device{}();
  std::mt19937 random(seed);
  Sampling awake;
  Sampling asleep;
  LocalTime time = awake.chip.time;
  for (unsigned i = 0; i < 5'000; ++i) {
    time += std::uniform_int_distribution<LocalTime>(1, 3'000 * Sampling::us)(random);
    awake.run_by_events(time);
    while (asleep.next_visible_event() <= time) {
      asleep.skip_to(asleep.next_visible_event());
    }
    asleep.skip_to(time);
    ASSERT_EQ(awake.state(), asleep.state()) << "change " << i << ", seed " << seed;
    ASSERT_EQ(awake.next_event(), asleep.next_event()) << "change " << i << ", seed " << seed;
    for (Sampling* sampling : {&awake, &asleep}) {
      sampling->written.clear();
    }
    const auto kind = static_cast<unsigned>(random() % 12);
    const auto value = static_cast<std::uint32_t>(random() % 3'300'000);
    change(awake, kind, value);
    change(asleep, kind, value);
  }
}

TEST(SamplesOfASleepingCpu, EndWithAReset) {
  Sampling sampling;
  sampling.run_by_events(sampling.first_trigger);
  sampling.skip_to(sampling.first_trigger + 9 * Sampling::period + Sampling::conversion);
  EXPECT_EQ(sampling.written.size(), 10U);
  sampling.timer.reset();
  sampling.dma.reset();
  sampling.adc.reset();
  sampling.skip_to(sampling.chip.time + 10 * Sampling::period);
  EXPECT_EQ(sampling.written.size(), 10U);
  EXPECT_EQ(sampling.next_event(), never_on_chip);
}

TEST(Timer3, Counts16Bits) {
  test::BenchChip chip;
  Timer timer(chip, 3);
  EXPECT_EQ(timer.name(), "TIM3");
  EXPECT_EQ(timer.base(), 0x4000'0400U);
  EXPECT_EQ(timer.read(0x2C), 0xFFFFU);
  timer.write(0x2C, 0x1'0005);
  EXPECT_EQ(timer.read(0x2C), 5U);
  EXPECT_NE(test::rejection([&] { timer.write(0x04, 0x20); }), "") << "nothing is connected";
}

}  // namespace
}  // namespace proleg::sim
