#include "sim/fault/fault.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <stdexcept>
#include <string>

#include "shared/canopen/messages.hpp"
#include "shared/fixed/random.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {
namespace {

constexpr std::uint64_t ms = 1'000;

/// Draws one schedule.
class Dice {
 public:
  Dice(const RandomFaults& settings, const Scenario& scenario)
      : settings_(settings), scenario_(scenario), noise_(settings.seed, random_stream::faults) {}

  FaultSchedule throw_all() {
    FaultSchedule schedule;
    const unsigned count = 1 + noise_.below(max_count);
    while (schedule.size() < count) {
      Fault fault = one();
      // The end of a fault would end another fault of its kind.
      const bool is_new = std::ranges::none_of(
          schedule, [&](const Fault& other) { return other.kind == fault.kind && other.joint == fault.joint; });
      if (is_new) {
        schedule.push_back(fault);
      }
      // A crystal does not start if it stops while the module has no power.
      if (is_new && fault.kind == FaultKind::crystal && noise_.below(2) == 0 && !has_supply_fault(schedule, fault)) {
        Fault off;
        off.kind = FaultKind::supply;
        off.start_us = fault.start_us;
        off.duration_us = 50 * ms;
        off.joint = fault.joint;
        schedule.push_back(off);
      }
    }
    std::ranges::stable_sort(schedule, {}, &Fault::start_us);
    return schedule;
  }

 private:
  static constexpr unsigned max_count = 4;

  [[nodiscard]] static bool has_supply_fault(const FaultSchedule& schedule, const Fault& fault) {
    return std::ranges::any_of(
        schedule, [&](const Fault& other) { return other.kind == FaultKind::supply && other.joint == fault.joint; });
  }

  Fault one() {
    const FaultDeclaration* declaration = nullptr;
    do {
      const auto kinds = fault_declarations();
      declaration = &kinds[noise_.below(static_cast<std::uint32_t>(kinds.size()))];
    } while ((declaration->needs_chip && !settings_.has_chips) ||
             (!declaration->acts_at_ticks && settings_.only_at_ticks));
    Fault fault;
    fault.kind = declaration->kind;
    const std::uint64_t last_us = settings_.run_us - rest_after_faults_us;
    fault.start_us = between(100 * ms, last_us - 100 * ms);
    if (declaration->has_joint) {
      fault.joint = noise_.below(static_cast<std::uint32_t>(scenario_.modules.size()));
    }
    if (declaration->duration != FaultDeclaration::Duration::none) {
      fault.duration_us = std::min(duration_of(fault.kind), last_us - fault.start_us);
    }
    choose_argument(fault);
    if (settings_.only_at_ticks) {
      move_between_syncs(fault);
    }
    return fault;
  }

  void move_between_syncs(Fault& fault) const {
    const std::uint32_t tick_us = scenario_.kernel.tick_period_us;
    const std::uint64_t end_us = fault.start_us + fault.duration_us.value_or(0);
    fault.start_us = moved_between_syncs(fault.start_us, tick_us);
    if (fault.duration_us) {
      std::uint64_t moved_end_us = moved_between_syncs(end_us, tick_us);
      moved_end_us -= moved_end_us > settings_.run_us - rest_after_faults_us ? tick_us : 0;
      fault.duration_us =
          std::max(moved_end_us, moved_between_syncs(fault.start_us + tick_us, tick_us)) - fault.start_us;
    }
  }

  std::uint64_t duration_of(FaultKind kind) {
    switch (kind) {
      case FaultKind::dominant:
        return uniform_in_logarithm(1 * ms, 800 * ms);
      case FaultKind::babble:
        return uniform_in_logarithm(5 * ms, 1'500 * ms);
      case FaultKind::master:
        return between(100 * ms, 2'000 * ms);
      default:
        return uniform_in_logarithm(5 * ms, 2'500 * ms);
    }
  }

  void choose_argument(Fault& fault) {
    const auto percent = [this](const std::array<unsigned, 4>& choices) {
      return static_cast<std::uint32_t>(((std::uint64_t{choices.at(noise_.below(4))} << 32U) + 50U) / 100U);
    };
    switch (fault.kind) {
      case FaultKind::supply:
        fault.amount = std::array<std::uint32_t, 6>{2'700, 2'800, 0, 1'500, 2'000, 2'400}.at(
            noise_.below(settings_.only_at_ticks ? 2 : 6));
        break;
      case FaultKind::jam:
        fault.amount = std::array<std::uint32_t, 3>{1'500, 2'200, 3'000}.at(noise_.below(3));
        break;
      case FaultKind::touch:
        fault.touch = static_cast<TouchFault>(1 + noise_.below(3));
        break;
      case FaultKind::babble:
        fault.frame.identifier = std::array<std::uint16_t, 4>{0x001, 0x07F, 0x101, 0x7FF}.at(noise_.below(4));
        break;
      case FaultKind::corrupt:
        fault.amount = percent({1, 10, 50, 95});
        break;
      case FaultKind::lose:
        fault.amount = percent({1, 20, 60, 99});
        break;
      case FaultKind::delay:
        fault.amount = static_cast<std::uint32_t>(uniform_in_logarithm(100, 200 * ms));
        break;
      case FaultKind::send:
        choose_frame(fault);
        break;
      default:
        break;
    }
  }

  /// Chooses a foreign SYNC, TICK or NMT command, a frame of a module or host, or any frame.
  void choose_frame(Fault& fault) {
    namespace identifier = canopen::identifier;
    const auto node = static_cast<std::uint8_t>(
        scenario_.modules[noise_.below(static_cast<std::uint32_t>(scenario_.modules.size()))].node);
    CanFrame& frame = fault.frame;
    switch (noise_.below(6)) {
      case 0:
        frame = {identifier::sync, 1, {static_cast<std::uint8_t>(1 + noise_.below(128))}};
        break;
      case 1:
        frame = {identifier::tick, 8, {}};
        fill(frame);
        break;
      case 2: {
        constexpr std::array<std::uint8_t, 5> commands{0x01, 0x02, 0x80, 0x81, 0x82};
        frame = {identifier::nmt, 2, {commands.at(noise_.below(5)), noise_.below(2) == 0 ? node : std::uint8_t{0}}};
        break;
      }
      case 3:
        frame = {static_cast<std::uint16_t>(identifier::state_frame + node), 8, {}};
        fill(frame);
        break;
      case 4:
        frame = {static_cast<std::uint16_t>(identifier::command + node), 8, {}};
        fill(frame);
        break;
      default:
        frame = {static_cast<std::uint16_t>(noise_.below(CanFrame::max_identifier + 1U)),
                 static_cast<std::uint8_t>(noise_.below(9)),
                 {}};
        fill(frame);
        break;
    }
    if (noise_.below(2) == 0) {
      fault.repeat_us = uniform_in_logarithm(500, 100 * ms);
    } else {
      fault.duration_us.reset();
    }
  }

  void fill(CanFrame& frame) {
    for (std::size_t i = 0; i < frame.length; ++i) {
      frame.data.at(i) = static_cast<std::uint8_t>(noise_.next() >> 24U);
    }
  }

  std::uint64_t between(std::uint64_t low, std::uint64_t high) {
    return low + noise_.below(static_cast<std::uint32_t>(high - low + 1));
  }

  /// Draws a time; short times are as likely as long ones. It uses powers of two with a linear part, so that all
  /// computers draw the same.
  std::uint64_t uniform_in_logarithm(std::uint64_t low, std::uint64_t high) {
    unsigned doublings = 0;
    while ((low << (doublings + 1)) <= high) {
      ++doublings;
    }
    const std::uint64_t base = low << noise_.below(doublings + 1);
    return std::min(between(base, 2 * base), high);
  }

  const RandomFaults& settings_;
  const Scenario& scenario_;
  Pcg32 noise_;
};

}  // namespace

FaultSchedule random_faults(const RandomFaults& settings, const Scenario& scenario) {
  if (settings.run_us < min_random_run_us || settings.run_us > std::numeric_limits<std::uint32_t>::max()) {
    throw std::invalid_argument("a run of " + time_word(settings.run_us) + " for random faults, expected at least " +
                                time_word(min_random_run_us) + " and at most 71 minutes");
  }
  return Dice(settings, scenario).throw_all();
}

}  // namespace proleg::sim
