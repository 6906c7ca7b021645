// The pulse that is high when the program cannot continue. A shortened pulse is a command to another angle: 600 us are
// -81 degrees. So it must end at its own width, and no further pulse may follow.

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/sim/mcu/chip/chip_rig.hpp"

namespace proleg::sim {
namespace {

constexpr BusTime center = 1'500 * us;

class LastPulse : public testing::Test {
 protected:
  /// When the pulse began, and how long it was in the end.
  struct Pulse {
    BusTime start = 0;
    BusTime length = 0;
  };

  /// A module that gives pulses of this width, `after` behind the begin of one of them: the fourth, or the first.
  class Module {
   public:
    Module(BusTime width, BusTime after, unsigned pulses_before = 3) {
      rig.chip.set_pin_watch('A', 5, [this](BusTime time, bool high) {
        is_high = high;
        if (high) {
          pulse = {time, 0};
          ++pulses;
        } else {
          pulse.length = time - pulse.start;
        }
      });
      rig.start_robot(20'000);
      const auto from_center = static_cast<std::int64_t>(width) - static_cast<std::int64_t>(center);
      rig.enable_servo(static_cast<std::int32_t>(from_center * (std::int64_t{1} << 30) / static_cast<int>(ms)));
      EXPECT_TRUE(rig.run_until_true([&] { return pulses == pulses_before + 1; }));
      rig.run_until(pulse.start + after);
      EXPECT_TRUE(is_high);
    }

    /// From here on: until the chip has reset itself, and some time more.
    void run_to_reset() {
      const BusTime start = rig.bus.now();
      ASSERT_TRUE(rig.run_until_true([this] { return resets() != 0; }, 100 * ms));
      EXPECT_FALSE(is_high);
      until_reset = rig.bus.now() - start;
      const auto so_far = pulses;
      rig.run_for(50 * ms);
      EXPECT_EQ(pulses, so_far) << "no further pulse";
      EXPECT_FALSE(is_high);
      for (const ChipEvent& event : rig.events) {
        EXPECT_NE(event.kind, ChipEvent::Kind::unmodelled) << event.text;
      }
    }
    [[nodiscard]] std::ptrdiff_t resets() const {
      return std::ranges::count(rig.events, ChipEvent::Kind::reset, &ChipEvent::kind);
    }
    void raise_nmi() {
      rig.chip.cpu().set_non_maskable(true);
      rig.chip.cpu().set_non_maskable(false);
    }
    /// All of the program's data.
    void damage_ram(std::uint8_t byte) {
      rig.chip.write(rig.address_of("stack_top"),
                     std::vector<std::uint8_t>(rig.address_of("ram_end") - rig.address_of("stack_top"), byte));
    }

    ChipRig rig;
    bool is_high = false;
    unsigned pulses = 0;
    Pulse pulse;
    BusTime until_reset = 0;
  };

  static void expect_length(const Module& module, BusTime width, BusTime shorter, BusTime longer, BusTime after) {
    EXPECT_GE(module.pulse.length + shorter, width) << "stopped after " << after << " ns";
    EXPECT_LE(module.pulse.length, width + longer) << "stopped after " << after << " ns";
    EXPECT_LE(module.until_reset, 3 * ms);
  }
};

/// Widths, and instants in such a pulse, also close to its ends.
constexpr BusTime widths[] = {600 * us, 1'000 * us, 1'500 * us, 2'500 * us};
std::vector<BusTime> instants_of(BusTime width) {
  std::vector<BusTime> instants{2 * us, 5 * us, 20 * us};
  for (BusTime after = 100 * us; after + 50 * us < width; after += width / 6) {
    instants.push_back(after);
  }
  for (const BusTime before : {20 * us, 12 * us, 8 * us, 5 * us, 2 * us}) {
    instants.push_back(width - before);
  }
  return instants;
}

/// Without crystal: no clock runs in the 10 us until the chip detects the failure.
constexpr BusTime two_percent_of(BusTime width) { return width / 50; }

TEST_F(LastPulse, EndsAtItsWidthIfTheCrystalStops) {
  BusTime longest_excess = 0;
  for (const BusTime width : widths) {
    for (const BusTime after : instants_of(width)) {
      Module module(width, after);
      module.rig.chip.set_crystal(false);
      module.run_to_reset();
      expect_length(module, width, us, two_percent_of(width), after);
      longest_excess = std::max(longest_excess, module.pulse.length - std::min(module.pulse.length, width));
    }
  }
  RecordProperty("longest_excess_ns", static_cast<int>(longest_excess));
}

TEST_F(LastPulse, EndsAtItsWidthIfTheProgramHasAFault) {
  for (const BusTime width : widths) {
    for (const BusTime after : instants_of(width)) {
      Module module(width, after);
      module.raise_nmi();  // a fault at this instant
      module.run_to_reset();
      expect_length(module, width, width / 1'000, width / 1'000, after);
    }
  }
}

TEST_F(LastPulse, EndsAtItsWidthIfAnInstructionIsUndefined) {
  for (const BusTime width : widths) {
    Module module(width, 100 * us);
    module.rig.break_program({undefined_instruction});
    module.rig.host.send({0x7FF, 0, {}});  // whose end the program reaches in the pulse
    ASSERT_TRUE(module.rig.run_until_true([&] { return !module.rig.events.empty(); }, width));
    EXPECT_EQ(module.rig.events[0].kind, ChipEvent::Kind::fault);
    EXPECT_LT(module.rig.events[0].time, module.pulse.start + width);
    module.rig.mend_program();
    module.run_to_reset();
    expect_length(module, width, width / 1'000, width / 1'000, 100 * us);
  }
}

TEST_F(LastPulse, EndsAtItsWidthIfTheCrystalStopsInTheFirstPulse) {
  constexpr BusTime width = 1'000 * us;
  for (const BusTime after : instants_of(width)) {
    Module module(width, after, 0);
    module.rig.chip.set_crystal(false);
    module.run_to_reset();
    expect_length(module, width, us, two_percent_of(width), after);
  }
}

TEST_F(LastPulse, EndsAtItsWidthIfTheCrystalStopsInAPulseThatTheTimerRepeats) {
  constexpr BusTime width = 1'000 * us;
  constexpr BusTime after = 300 * us;
  Module module(width, 100 * us);
  module.rig.break_program({branch_to_itself});
  ASSERT_TRUE(module.rig.run_until_true([&] { return !module.is_high; }));
  ASSERT_TRUE(module.rig.run_until_true([&] { return module.is_high; }));
  module.rig.run_for(after);
  module.rig.chip.set_crystal(false);
  module.run_to_reset();
  expect_length(module, width, us, two_percent_of(width), after);
}

TEST_F(LastPulse, EndsAtItsWidthIfTheCrystalStopsAfterTheServoWasSwitchedOff) {
  constexpr BusTime width = 1'000 * us;
  constexpr BusTime after = 600 * us;
  Module module(width, 100 * us);
  module.rig.host.send({0x000, 2, {0x02, 0x00}});  // NMT stop
  module.rig.run_until(module.pulse.start + after);
  ASSERT_TRUE(module.rig.host.is_done());
  module.rig.chip.set_crystal(false);
  module.run_to_reset();
  expect_length(module, width, us, two_percent_of(width), after);
}

TEST_F(LastPulse, EndsAtOnceIfTheCrystalStopsAndItsWidthIsLost) {
  for (const unsigned byte : {0x00U, 0x55U, 0xFFU}) {
    Module module(1'500 * us, 500 * us);
    module.rig.chip.set_crystal(false);
    module.damage_ram(static_cast<std::uint8_t>(byte));
    module.run_to_reset();
    EXPECT_LE(module.pulse.length, 515 * us);
  }
}

TEST_F(LastPulse, EndsAtItsWidthIfTheProgramHasAFaultAndTheRamIsLost) {
  Module module(1'500 * us, 500 * us);
  module.damage_ram(0x55);
  module.raise_nmi();
  module.run_to_reset();
  expect_length(module, 1'500 * us, us, us, 500 * us);
}

TEST_F(LastPulse, EndsIfItsTimerStandsStill) {
  // movs r3, #1; lsls r3, r3, #30; movs r2, #0; str r2, [r3]: TIM2_CR1 = 0; then a fault. The watchdog would come 136
  // ms after it was fed, so 86 ms after a program that feeds it every 50 ms.
  Module module(1'500 * us, 100 * us);
  module.rig.break_program({0x2301, 0x079B, 0x2200, 0x601A, undefined_instruction});
  module.rig.host.send({0x7FF, 0, {}});
  ASSERT_TRUE(module.rig.run_until_true([&] { return !module.rig.events.empty(); }, ms));
  module.rig.mend_program();
  module.run_to_reset();
  EXPECT_LE(module.until_reset, 20 * ms);
  RecordProperty("until_reset_us", static_cast<int>(module.until_reset / us));
}

}  // namespace
}  // namespace proleg::sim
