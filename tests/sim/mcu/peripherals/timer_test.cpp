#include "sim/mcu/peripherals/timer.hpp"

#include <random>
#include <stdexcept>

#include "support/bench.hpp"

namespace proleg::sim {
namespace {

constexpr std::uint32_t cen = 1U << 0U;
constexpr std::uint32_t udis = 1U << 1U;
constexpr std::uint32_t urs = 1U << 2U;
constexpr std::uint32_t opm = 1U << 3U;
constexpr std::uint32_t arpe = 1U << 7U;
constexpr std::uint32_t pwm1_preloaded = 0x68;  ///< of channel 1

constexpr LocalTime clock = 12;  ///< of the timer: 84 MHz

/// The timer of RM0090, section 18, clock by clock: registers, prescaler, counter, outputs. Up-counting.
struct ClockModel {
  std::uint32_t cr1 = 0, sr = 0, ccer = 0;
  std::array<std::uint32_t, 2> ccmr{};
  std::uint32_t psc = 0, psc_shadow = 0, arr = 0xFFFF'FFFF, arr_shadow = 0xFFFF'FFFF;
  std::array<std::uint32_t, 4> ccr{}, ccr_shadow{};
  std::uint32_t counter = 0, prescaler = 0;
  bool counter_enabled = false;  ///< CNT_EN, a clock after CEN
  std::array<bool, 4> held{};

  [[nodiscard]] bool preloads(unsigned i) const { return (ccmr[i / 2] >> (8 * (i % 2) + 3) & 1U) != 0; }
  [[nodiscard]] unsigned mode(unsigned i) const { return ccmr[i / 2] >> (8 * (i % 2) + 4) & 7U; }
  [[nodiscard]] bool reference(unsigned i) const {
    switch (mode(i)) {
      case 4:
        return false;
      case 5:
        return true;
      case 6:
        return counter < ccr_shadow[i];
      case 7:
        return counter >= ccr_shadow[i];
      default:
        return held[i];
    }
  }
  [[nodiscard]] bool output(unsigned i) const {
    return (ccer >> (4 * i) & 1U) != 0 && reference(i) != ((ccer >> (4 * i + 1) & 1U) != 0);
  }
  void follow() {
    if ((cr1 & arpe) == 0) {
      arr_shadow = arr;
    }
    for (unsigned i = 0; i < 4; ++i) {
      if (!preloads(i)) {
        ccr_shadow[i] = ccr[i];
      }
    }
  }
  void load(bool flag) {
    if ((cr1 & udis) != 0) {
      return;
    }
    psc_shadow = psc;
    arr_shadow = arr;
    ccr_shadow = ccr;
    sr |= flag ? 1U : 0U;
  }
  void generate_update() {
    counter = 0;
    prescaler = 0;
    load((cr1 & urs) == 0);
  }
  void set_ccmr(unsigned index, std::uint32_t value) {
    const std::array<bool, 4> levels = {reference(0), reference(1), reference(2), reference(3)};
    ccmr[index] = value;
    held[2 * index] = levels[2 * index];
    held[2 * index + 1] = levels[2 * index + 1];
    follow();
  }
  void tick() {
    const bool enabled = (cr1 & cen) != 0;
    if (enabled && counter_enabled && arr_shadow != 0) {
      if (prescaler++ == psc_shadow) {
        prescaler = 0;
        count();
      }
    }
    counter_enabled = (cr1 & cen) != 0;
  }
  void count() {
    if (counter != arr_shadow) {
      ++counter;
    } else {
      for (unsigned i = 0; i < 4; ++i) {
        sr |= ccr_shadow[i] > arr_shadow ? 2U << i : 0U;
      }
      counter = 0;
      load(true);
      if ((cr1 & opm) != 0 && (cr1 & udis) == 0) {
        cr1 &= ~cen;
      }
    }
    for (unsigned i = 0; i < 4; ++i) {
      sr |= ccr_shadow[i] == counter ? 2U << i : 0U;
    }
  }
};

class TimerTest : public testing::Test {
 protected:
  static constexpr std::uint32_t cr1 = 0x00;
  static constexpr std::uint32_t dier = 0x0C;
  static constexpr std::uint32_t sr = 0x10;
  static constexpr std::uint32_t egr = 0x14;
  static constexpr std::uint32_t ccmr1 = 0x18;
  static constexpr std::uint32_t ccer = 0x20;
  static constexpr std::uint32_t cnt = 0x24;
  static constexpr std::uint32_t psc = 0x28;
  static constexpr std::uint32_t arr = 0x2C;
  static constexpr std::uint32_t ccr1 = 0x34;

  TimerTest() { chip.settings = test::full_speed; }

  test::BenchChip chip;
  Timer timer{chip, 2};
};

// RM0090 rev 21, 18.4 (ARR: since revision 13).
TEST_F(TimerTest, ResetValuesAreThoseOfTheManual) {
  timer.write(psc, 5);
  timer.write(arr, 100);
  timer.write(egr, 1);
  timer.write(cr1, cen);
  timer.reset();
  for (const std::uint32_t offset : {0x00U, 0x04U, 0x08U, 0x0CU, 0x10U, 0x14U, 0x18U, 0x1CU, 0x20U, 0x24U, 0x28U, 0x34U,
                                     0x38U, 0x3CU, 0x40U, 0x48U, 0x50U}) {
    EXPECT_EQ(timer.read(offset), 0U) << timer.register_name(offset);
  }
  EXPECT_EQ(timer.read(arr), 0xFFFF'FFFFU);
  EXPECT_EQ(timer.base(), 0x4000'0000U);
  EXPECT_EQ(Timer(chip, 5).base(), 0x4000'0C00U);
  EXPECT_THROW(Timer(chip, 4), std::invalid_argument);
}

TEST_F(TimerTest, CountsOneClockAfterItIsEnabled) {
  timer.write(psc, 83);
  timer.write(arr, 20'000 - 1);
  timer.write(egr, 1);
  timer.write(cr1, cen);
  EXPECT_EQ(timer.count_period(), local_time_per_us);
  chip.time = clock + local_time_per_us - 1;
  EXPECT_EQ(timer.read(cnt), 0U);
  chip.time += 1;
  EXPECT_EQ(timer.read(cnt), 1U);
  chip.time = clock + 19'999 * local_time_per_us;
  EXPECT_EQ(timer.read(cnt), 19'999U);
  chip.time = clock + 20'000 * local_time_per_us;
  EXPECT_EQ(timer.read(cnt), 0U);
}

TEST_F(TimerTest, TheUpdateInterruptComesAtTheOverflow) {
  timer.write(arr, 99);
  timer.write(egr, 1);
  EXPECT_EQ(timer.read(sr), 1U);
  timer.write(sr, 0);
  timer.write(dier, 1);
  timer.write(cr1, cen);
  EXPECT_EQ(timer.next_event(), clock + 100 * clock);
  chip.run_until(clock + 100 * clock - 1, timer);
  EXPECT_TRUE(chip.interrupts.empty());
  chip.run_until(clock + 100 * clock, timer);
  EXPECT_TRUE(chip.interrupts.contains(28));
  EXPECT_EQ(timer.next_event(), never_on_chip) << "the flag is set already";
  timer.write(sr, ~1U);
  EXPECT_TRUE(chip.interrupts.empty());
  EXPECT_EQ(timer.next_event(), clock + 200 * clock);
}

TEST_F(TimerTest, WithoutUpdatesNothingIsDueAtTheOverflow) {
  timer.write(arr, 99);
  timer.write(dier, 1);
  timer.write(cr1, cen | udis);
  EXPECT_EQ(timer.next_event(), never_on_chip);
  chip.time = clock + 250 * clock;
  EXPECT_EQ(timer.read(cnt), 50U);
  EXPECT_EQ(timer.read(sr) & 1U, 0U);
}

TEST_F(TimerTest, APauseKeepsThePrescalerInWholeClocks) {
  timer.write(psc, 9);
  timer.write(egr, 1);
  timer.write(cr1, cen);
  chip.time = clock + 25 * clock + 7;
  timer.write(cr1, 0);
  chip.time += 1000;
  EXPECT_EQ(timer.read(cnt), 2U);
  timer.write(cr1, cen);
  chip.time += clock + 5 * clock - 1;
  EXPECT_EQ(timer.read(cnt), 2U);
  chip.time += 1;
  EXPECT_EQ(timer.read(cnt), 3U);
}

TEST_F(TimerTest, Timer5HasItsOwnLine) {
  Timer other(chip, 5);
  other.write(dier, 1);
  other.write(egr, 1);
  EXPECT_TRUE(chip.interrupts.contains(50));
}

TEST_F(TimerTest, MakesServoPulsesOfExactWidth) {
  timer.write(psc, 6);  // 12 MHz
  timer.write(arr, 240'000 - 1);
  timer.write(ccmr1, pwm1_preloaded);
  timer.write(ccer, 1);
  timer.write(ccr1, 18'000);
  EXPECT_EQ(timer.pulse_width(1), std::nullopt);
  timer.write(egr, 1);
  timer.write(cr1, cen | arpe);
  EXPECT_EQ(timer.pulse_width(1), 18'000U);
  EXPECT_EQ(timer.count_period() * 12, local_time_per_us);
  EXPECT_EQ(timer.period(), 240'000U);

  LocalTime rise = 0;
  EXPECT_TRUE(timer.output(1).high);
  timer.write(ccr1, 12'000);  // from the next period on
  EXPECT_EQ(timer.pulse_width(1), 12'000U);
  std::vector<LocalTime> edges;
  for (int i = 0; i < 5; ++i) {
    const bool before = timer.output(1).high;
    chip.time = timer.next_edge(1);
    EXPECT_NE(timer.output(1).high, before);
    edges.push_back(chip.time);
  }
  rise = clock;  // the first period begins one clock after CEN
  EXPECT_EQ(edges, (std::vector<LocalTime>{rise + 1'500 * local_time_per_us, rise + 20'000 * local_time_per_us,
                                           rise + 21'000 * local_time_per_us, rise + 40'000 * local_time_per_us,
                                           rise + 41'000 * local_time_per_us}));
  timer.write(ccer, 0);
  EXPECT_EQ(timer.pulse_width(1), std::nullopt);
  timer.write(ccer, 1);
  timer.write(ccmr1, 0x48);  // forced inactive
  EXPECT_EQ(timer.pulse_width(1), std::nullopt);
  EXPECT_EQ(timer.output(1), (Timer::Output{true, false}));
}

TEST_F(TimerTest, AnUpdateBySoftwareBeginsAPulse) {
  timer.write(psc, 6);
  timer.write(arr, 240'000 - 1);
  timer.write(ccmr1, pwm1_preloaded);
  timer.write(ccer, 1);
  timer.write(ccr1, 18'000);
  timer.write(egr, 1);
  timer.write(cr1, cen | urs);
  chip.time = 5'000 * local_time_per_us;
  EXPECT_FALSE(timer.output(1).high);
  timer.write(ccr1, 24'000);
  timer.write(egr, 1);
  EXPECT_TRUE(timer.output(1).high);
  EXPECT_EQ(timer.next_edge(1), 7'000 * local_time_per_us);
}

TEST_F(TimerTest, OnePulseStopsAtTheUpdate) {
  timer.write(arr, 999);
  timer.write(ccmr1, 0x70);  // PWM 2
  timer.write(ccr1, 400);
  timer.write(ccer, 1);
  timer.write(cr1, cen | opm);
  EXPECT_EQ(timer.pulse_width(1), 600U);
  chip.time = clock + 1000 * clock;
  EXPECT_EQ(timer.pulse_width(1), std::nullopt);
  EXPECT_EQ(timer.read(cr1), opm);
  EXPECT_EQ(timer.read(cnt), 0U);
  EXPECT_FALSE(timer.output(1).high);
  EXPECT_EQ(timer.next_edge(1), never_on_chip);
}

TEST_F(TimerTest, ANullReloadBlocksTheCounter) {
  timer.write(arr, 0);
  timer.write(cr1, cen);
  chip.time = 1000;
  EXPECT_EQ(timer.read(cnt), 0U);
  EXPECT_EQ(timer.read(sr), 0U);
  timer.write(arr, 10);
  chip.time += 3 * clock;
  EXPECT_EQ(timer.read(cnt), 3U);
}

TEST_F(TimerTest, AChangeOfClocksKeepsCountAndPrescaler) {
  timer.write(psc, 9);
  timer.write(egr, 1);
  timer.write(cr1, cen);
  chip.time = clock + 25 * clock;  // two counts and half of the third
  Clocks slow = test::full_speed;
  slow.apb1_timers = 63;
  timer.clocks_change(slow);
  chip.settings = slow;
  EXPECT_EQ(timer.read(cnt), 2U);
  chip.time += 5 * 63 - 1;
  EXPECT_EQ(timer.read(cnt), 2U);
  chip.time += 1;
  EXPECT_EQ(timer.read(cnt), 3U);
  chip.time += 630;
  EXPECT_EQ(timer.read(cnt), 4U);
}

TEST_F(TimerTest, LongTimesPassQuickly) {
  timer.write(arr, 1);
  timer.write(ccr1, 1);
  timer.write(cr1, cen);
  chip.time = clock + LocalTime{1'000'000'000'001} * clock;
  EXPECT_EQ(timer.read(cnt), 1U);
  EXPECT_EQ(timer.read(sr) & 3U, 3U);
}

/// Random registers, random moments: counter, flags, outputs and interrupts are those of the clock-by-clock model; and
/// next_event() and next_edge() are right.
TEST_F(TimerTest, DoesWhatTheTimerOfTheManualDoesClockByClock) {
  for (unsigned seed = 1; seed <= 150; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    const auto below = [&](std::uint32_t bound) { return static_cast<std::uint32_t>(random() % bound); };
    chip.time = 0;
    chip.interrupts.clear();
    Timer lazy(chip, 2);
    ClockModel model;
    std::uint32_t interrupts = below(0x20);
    lazy.write(dier, interrupts);
    LocalTime promised_event = never_on_chip;
    LocalTime promised_edge = never_on_chip;
    bool level = false;
    const auto renew_promises = [&] {
      promised_event = lazy.next_event();
      promised_edge = lazy.next_edge(1);
      level = model.output(0);
    };
    const auto change = [&] {
      constexpr std::array<std::uint32_t, 5> modes = {0, 4, 5, 6, 7};
      switch (below(8)) {
        case 0: {
          const std::uint32_t value = (below(4) != 0 ? cen : 0) | (below(8) == 0 ? udis : 0) |
                                      (below(2) != 0 ? urs : 0) | (below(6) == 0 ? opm : 0) |
                                      (below(2) != 0 ? arpe : 0);
          const std::uint32_t reload = (value & arpe) == 0 ? model.arr : model.arr_shadow;
          if (model.counter > reload) {
            break;  // rejected
          }
          lazy.write(cr1, value);
          if ((value & cen) == 0 || (model.cr1 & cen) == 0) {
            model.counter_enabled = false;
          }
          model.cr1 = value;
          model.follow();
          break;
        }
        case 1:
          model.psc = below(6);
          lazy.write(psc, model.psc);
          break;
        case 2: {
          const std::uint32_t value = 1 + below(30);
          if ((model.cr1 & arpe) == 0 && value < model.counter) {
            break;  // rejected
          }
          model.arr = value;
          model.follow();
          lazy.write(arr, value);
          break;
        }
        case 3: {
          const unsigned channel = below(4);
          model.ccr[channel] = below(35);
          model.follow();
          lazy.write(ccr1 + 4 * channel, model.ccr[channel]);
          break;
        }
        case 4: {
          const unsigned index = below(2);
          const std::uint32_t value =
              (modes[below(5)] << 4U) | (below(2) << 3U) | (modes[below(5)] << 12U) | (below(2) << 11U);
          model.set_ccmr(index, value);
          lazy.write(ccmr1 + 4 * index, value);
          break;
        }
        case 5:
          model.ccer = below(0x10000) & 0x3333U;
          lazy.write(ccer, model.ccer);
          break;
        case 6:
          if (below(3) == 0) {
            model.generate_update();
            lazy.write(egr, 1);
          } else {
            const std::uint32_t kept = below(0x20);
            model.sr &= kept;
            lazy.write(sr, kept);
          }
          break;
        default:
          interrupts = below(0x20);
          lazy.write(dier, interrupts);
          break;
      }
      renew_promises();
    };
    for (int i = 0; i < 10; ++i) {
      change();
    }
    // Every other run advances the timer after many periods only.
    const bool unobserved = seed % 2 == 0;
    std::uint32_t look = 1;
    for (int step = 0; step < 4000; ++step) {
      chip.time += clock;
      model.tick();
      const bool line = (model.sr & interrupts) != 0;
      if (unobserved) {
        promised_event = promised_edge = never_on_chip;
        level = model.output(0);
      }
      if (!unobserved && line != chip.interrupts.contains(28)) {
        ASSERT_EQ(chip.time, promised_event) << "an interrupt at a time that was not promised";
      }
      if (model.output(0) != level) {
        ASSERT_GE(chip.time, promised_edge) << "an edge that was not promised";
      }
      if (chip.time >= promised_event || chip.time >= promised_edge) {
        lazy.advance();
        ASSERT_EQ(line, chip.interrupts.contains(28));
        renew_promises();
        ASSERT_GT(promised_edge, chip.time);
      }
      if (--look == 0) {
        look = 1 + below(unobserved ? 1000 : 200);
        ASSERT_EQ(lazy.read(cnt), model.counter) << step;
        ASSERT_EQ(lazy.read(sr), model.sr) << step;
        ASSERT_EQ(lazy.read(cr1), model.cr1) << step;
        for (unsigned channel = 0; channel < 4; ++channel) {
          ASSERT_EQ(lazy.output(channel + 1).high, model.output(channel)) << step;
        }
        change();
      }
    }
  }
}

TEST_F(TimerTest, RejectsWhatItDoesNotModelByName) {
  EXPECT_EQ(test::rejection([&] { timer.write(cr1, 0x10); }),
            "TIM2_CR1 = 0x10 at offset 0x0: only up-counting is modelled");
  EXPECT_EQ(test::rejection([&] { timer.write(ccmr1, 0x30); }),
            "TIM2_CCMR1 = 0x30 at offset 0x18: OC1M = 3: outputs that change on a match are not modelled");
  EXPECT_EQ(test::rejection([&] { timer.write(0x1C, 0x100); }),
            "TIM2_CCMR2 = 0x100 at offset 0x1C: input capture is not modelled");
  EXPECT_NE(test::rejection([&] { timer.write(0x04, 0x10); }), "");
  EXPECT_NE(test::rejection([&] { timer.write(0x08, 1); }), "");
  EXPECT_NE(test::rejection([&] { timer.write(dier, 0x100); }), "");
  EXPECT_NE(test::rejection([&] { timer.write(ccer, 8); }), "");
  EXPECT_EQ(test::rejection([&] { static_cast<void>(timer.read(0x4C)); }),
            "TIM2_DMAR at offset 0x4C: reading it is not modelled");
  EXPECT_EQ(test::rejection([&] { static_cast<void>(timer.read(0x54)); }),
            "TIM2 at offset 0x54: reading it is not modelled");
  timer.write(arr, 100);
  timer.write(cr1, cen);
  chip.time = clock + 50 * clock;
  EXPECT_EQ(test::rejection([&] { timer.write(arr, 49); }),
            "TIM2_ARR = 0x31 at offset 0x2C: below the counter (0x32) without ARPE: it would go through all 32 bits");
}

}  // namespace
}  // namespace proleg::sim
