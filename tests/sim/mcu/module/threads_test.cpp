// Virtual chips on several threads: everything that a run reports is the same with any number of threads, and the same
// as when each chip runs at its own time, with nothing prepared.
//
// Run n draws the scenario, the seed, losses, restarts and faults. PROLEG_THREADS_FIRST and PROLEG_THREADS_RUNS choose
// the runs.

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <memory>
#include <sstream>
#include <string>
#include <utility>

#include "shared/fixed/random.hpp"
#include "sim/fault/fault.hpp"
#include "sim/hardware_loop/hardware_loop.hpp"
#include "sim/scenario/losses.hpp"
#include "tests/support/from_environment.hpp"
#include "virtual_robot.hpp"

namespace proleg::sim {
namespace {

constexpr std::uint32_t ticks = 150;
constexpr std::array scenarios{"travelling_wave/uniform", "travelling_wave/coupled", "obstacle/reflex"};

/// A virtual module that is never prepared.
class AtItsOwnTime final : public JointModule {
 public:
  explicit AtItsOwnTime(std::unique_ptr<JointModule> module) : module_(std::move(module)) {}

  void power_on(BusTime now) override { module_->power_on(now); }
  [[nodiscard]] BusTime next_event() const override { return module_->next_event(); }
  void advance_to(BusTime now, BusTime quiet_until) override { module_->advance_to(now, quiet_until); }
  void catch_up_before(BusTime time) override { module_->catch_up_before(time); }
  void run_out(BusTime now, BusTime until) override { module_->run_out(now, until); }
  void set_supply(BusTime now, std::uint32_t mv) override { module_->set_supply(now, mv); }
  void set_adc(BusTime now, bool converts) override { module_->set_adc(now, converts); }
  void set_crystal(BusTime now, bool runs) override { module_->set_crystal(now, runs); }
  void set_pll(BusTime now, bool locks) override { module_->set_pll(now, locks); }
  [[nodiscard]] canopen::PowerState power() const override { return module_->power(); }
  void set_pulse_watch(PulseWatch watch) override { module_->set_pulse_watch(std::move(watch)); }
  void set_command_watch(CommandWatch watch) override { module_->set_command_watch(std::move(watch)); }
  void begin_serial_input(BusTime now, const SerialCharacter& character, BusTime bit) override {
    module_->begin_serial_input(now, character, bit);
  }
  void set_serial_watch(SerialWatch watch) override { module_->set_serial_watch(std::move(watch)); }
  [[nodiscard]] firmware::TickRecord last_tick() const override { return module_->last_tick(); }
  [[nodiscard]] std::optional<std::int32_t> pulse() const override { return module_->pulse(); }
  [[nodiscard]] std::size_t controller() const override { return module_->controller(); }
  void note_sync(std::uint32_t tick) override { module_->note_sync(tick); }
  void note_missing_sync() override { module_->note_missing_sync(); }
  [[nodiscard]] std::optional<std::string> take_problem() override { return module_->take_problem(); }

 private:
  std::unique_ptr<JointModule> module_;
};

struct RandomRun {
  Scenario scenario;
  Losses losses;
  HardwareOptions options;
  std::string description;
};

RandomRun draw(std::uint32_t number) {
  Pcg32 noise(number, 62);
  const char* const name = scenarios.at(noise.below(scenarios.size()));
  RandomRun run{shipped(name), {}, {}, name};
  std::ostringstream text;
  run.scenario.kernel.seed = noise.next();
  // Most chips measure pulses with periods of common servos only.
  run.scenario.robot.servo.period_us = noise.below(2) == 0 ? 20'000 : 1'000 * (1 + noise.below(4));
  text << ", seed " << run.scenario.kernel.seed << ", servo period " << run.scenario.robot.servo.period_us << " us";
  if (noise.below(2) == 0) {
    run.losses = Losses(RandomLosses{noise.next(), noise.below(1U << 29U)});
    run.options.bit_errors = {noise.next(), noise.below(1U << 28U)};
    const auto joint = noise.below(static_cast<std::uint32_t>(run.scenario.modules.size()));
    run.options.restarts = {{20 + noise.below(60), joint}};
    text << ", losses and bit errors, a restart of joint " << joint;
  } else {
    RandomFaults settings;
    settings.seed = noise.next();
    settings.has_chips = true;
    run.options.faults = random_faults(settings, run.scenario);
    text << "\n" << faults_text(run.options.faults, run.scenario.robot);
  }
  run.description += text.str();
  return run;
}

/// All that a run reports, as text.
std::string report_of(const RandomRun& run, unsigned threads, bool is_prepared) {
  std::ostringstream report;
  HardwareOptions options = run.options;
  options.losses = &run.losses;
  options.threads = threads;
  options.notice = [&](const std::string& text) { report << "notice: " << text << "\n"; };
  options.on_frame = [&](const Transmission& sent) {
    report << sent.start << " to " << sent.end << ": " << sent.sender << " sends " << sent.frame.identifier << ":";
    for (const std::uint8_t byte : sent.frame.bytes()) {
      report << ' ' << unsigned{byte};
    }
    report << "\n";
  };
  options.make_module = [&](const ModuleParts& parts) -> std::unique_ptr<JointModule> {
    VirtualModuleOptions chip;
    chip.console = [&report, joint = parts.joint](const std::string& line) {
      report << "console of " << joint << ": " << line << "\n";
    };
    chip.on_tick = [&report, joint = parts.joint](const TickCost& cost) {
      report << "tick " << cost.tick << " of " << joint << ": " << cost.to_state_frame << " of " << cost.whole
             << " instructions\n";
    };
    auto module = std::make_unique<VirtualModule>(parts, flashed_image(), std::move(chip));
    if (is_prepared) {
      return module;
    }
    return std::make_unique<AtItsOwnTime>(std::move(module));
  };
  HardwareLoop loop(run.scenario, std::move(options));
  try {
    while (loop.tick() < ticks) {
      loop.advance();
      for (const ServoPulse& pulse : loop.sample().servo_pulses) {
        report << "servo of " << pulse.joint << ": " << pulse.command << "\n";
      }
    }
  } catch (const HardwareError& error) {
    report << "ends: " << error.what() << "\n";
  }
  loop.finish_watch();
  for (const std::string& violation : loop.motion_watch().violations()) {
    report << "violation: " << violation << "\n";
  }
  const MotionWatch::Worst worst = loop.motion_watch().worst();
  report << worst.change_steps << ' ' << worst.beyond_limit_deg << ' ' << worst.motion_after_command_s << "\n"
         << loop.setpoint_hash().hex() << ' ' << loop.servo_hash().hex() << ' ' << loop.world_hash().value_or("-")
         << ' ' << loop.differences() << ' ' << loop.command_latency_ns().count() << ' '
         << loop.command_latency_ns().median().value_or(0) << "\n";
  return std::move(report).str();
}

/// The first line in which two reports differ; empty if they are equal.
std::string first_difference(const std::string& left, const std::string& right) {
  std::istringstream lefts(left);
  std::istringstream rights(right);
  std::string one;
  std::string other;
  for (unsigned line = 1;; ++line) {
    const bool has_one = static_cast<bool>(std::getline(lefts, one));
    const bool has_other = static_cast<bool>(std::getline(rights, other));
    if (!has_one && !has_other) {
      return "";
    }
    if (!has_one || !has_other || one != other) {
      return "line " + std::to_string(line) + ": " + (has_one ? one : "the end") +
             "\n     and: " + (has_other ? other : "the end");
    }
  }
}

TEST(Threads, AnyNumberOfThemGivesTheSameFramesPulsesInstructionsAndReports) {
  const std::uint32_t first = from_environment("PROLEG_THREADS_FIRST", 0);
  const std::uint32_t runs = from_environment("PROLEG_THREADS_RUNS", 6);
  for (std::uint32_t number = first; number < first + runs; ++number) {
    const RandomRun run = draw(number);
    SCOPED_TRACE("run " + std::to_string(number) + ": " + run.description);
    const std::string with_one = report_of(run, 1, true);
    EXPECT_EQ(first_difference(with_one, report_of(run, 2, true)), "") << "with 2 threads";
    EXPECT_EQ(first_difference(with_one, report_of(run, 3, true)), "") << "with 3 threads";
    EXPECT_EQ(first_difference(with_one, report_of(run, 1, false)), "") << "with each chip at its own time";
  }
}

}  // namespace
}  // namespace proleg::sim
