#include "sim/fault/fault.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "shared/computer/text/text.hpp"

namespace proleg::sim {
namespace {

using Argument = FaultDeclaration::Argument;
using Duration = FaultDeclaration::Duration;

constexpr std::array declarations{
    FaultDeclaration{FaultKind::unplug, "unplug", true, Argument::none, Duration::needed, false, false,
                     "The module's bus wires are off; it keeps its supply."},
    FaultDeclaration{
        FaultKind::supply, "supply", true, Argument::voltage, Duration::needed, false, true,
        "The supply of the module's chip falls to this voltage, from 2.94V on by 0.1V a millisecond, and "
        "rises again in the same way. 0V: it has no power, at once. Below 2.93V the servo gets no pulses, "
        "below 2.6V the program ends. The board sets no brown-out level, so the chip itself is reset below "
        "1.68V."},
    FaultDeclaration{FaultKind::reset, "reset", true, Argument::none, Duration::none, false, false,
                     "The module restarts, as by its reset pin."},
    FaultDeclaration{FaultKind::crystal, "crystal", true, Argument::none, Duration::needed, true, false,
                     "The module's crystal stops. Together with 'supply JOINT 0V' it does not start."},
    FaultDeclaration{FaultKind::pll, "pll", true, Argument::none, Duration::needed, true, false,
                     "The clock multiplier of the module's chip loses its lock, and runs on with a wrong frequency."},
    FaultDeclaration{
        FaultKind::adc, "adc", true, Argument::none, Duration::needed, false, true,
        "The results of the module's converter are not read: no new measurements, and an overrun that the program must "
        "end."},
    FaultDeclaration{FaultKind::touch, "touch", true, Argument::touch, Duration::needed, false, true,
                     "All touch sensors of the module read pressed or open, or change from tick to tick."},
    FaultDeclaration{FaultKind::jam, "jam", true, Argument::current, Duration::needed, false, true,
                     "The joint does not turn, and its servo draws this current while it gets pulses."},
    FaultDeclaration{FaultKind::babble, "babble", false, Argument::identifier, Duration::needed, false, false,
                     "Another node sends empty frames with this identifier without a pause."},
    FaultDeclaration{FaultKind::dominant, "dominant", false, Argument::none, Duration::needed, false, false,
                     "The bus is held dominant. Senders are in bus-off then, all others error-passive."},
    FaultDeclaration{FaultKind::corrupt, "corrupt", false, Argument::rate, Duration::needed, false, false,
                     "Frames are destroyed on the bus with this probability. Their senders send them again."},
    FaultDeclaration{FaultKind::lose, "lose", true, Argument::rate, Duration::needed, false, true,
                     "The module does not get frames, each with this probability."},
    FaultDeclaration{FaultKind::delay, "delay", true, Argument::time, Duration::needed, false, false,
                     "The module gets all frames later by this time."},
    FaultDeclaration{FaultKind::send, "send", false, Argument::frame, Duration::optional, false, false,
                     "Another node sends this frame, hexadecimal as for cansend: a foreign SYNC (080#05), TICK, NMT "
                     "command (000#0200: all stop), or any other. With 'every TIME' it is sent again and again."},
    FaultDeclaration{FaultKind::master, "master", false, Argument::none, Duration::optional, false, false,
                     "A second host sets the robot up and starts it, as the first one did."},
    FaultDeclaration{FaultKind::host_stall, "host-stall", false, Argument::none, Duration::needed, false, false,
                     "The host does nothing; what it received meanwhile it handles at the end."},
    FaultDeclaration{FaultKind::host_dies, "host-dies", false, Argument::none, Duration::none, false, false,
                     "The host is gone for the rest of the run."},
};

std::string frame_word(const CanFrame& frame) {
  std::string word = hexadecimal(frame.identifier, 3).substr(2) + "#";
  for (const std::uint8_t byte : frame.bytes()) {
    word += hexadecimal(byte, 2).substr(2);
  }
  return word;
}

std::string touch_word(TouchFault touch) {
  switch (touch) {
    case TouchFault::pressed:
      return "pressed";
    case TouchFault::open:
      return "open";
    default:
      return "bouncing";
  }
}

/// The shortest percentage that gives the same threshold again.
std::string rate_word(std::uint32_t threshold) {
  const double percent = std::ldexp(threshold, -32) * 100.0;
  for (double scale = 1.0; scale < 1e12; scale *= 10.0) {
    const std::string word = exact_text(std::round(percent * scale) / scale) + "%";
    if (parse_rate(word) == threshold) {
      return word;
    }
  }
  return exact_text(percent) + "%";
}

std::string argument_word(const Fault& fault, Argument argument) {
  switch (argument) {
    case Argument::none:
      return {};
    case Argument::voltage:
      return exact_text(fault.amount / 1000.0) + "V";
    case Argument::current:
      return exact_text(fault.amount / 1000.0) + "A";
    case Argument::rate:
      return rate_word(fault.amount);
    case Argument::time:
      return time_word(fault.amount);
    case Argument::touch:
      return touch_word(fault.touch);
    case Argument::frame:
      return frame_word(fault.frame);
    case Argument::identifier:
      return hexadecimal(fault.frame.identifier, 3).substr(2);
  }
  return {};
}

const char* argument_name(Argument argument) {
  switch (argument) {
    case Argument::none:
      break;
    case Argument::voltage:
      return " VOLTAGE";
    case Argument::current:
      return " CURRENT";
    case Argument::rate:
      return " RATE";
    case Argument::time:
      return " TIME";
    case Argument::touch:
      return " pressed|open|bouncing";
    case Argument::frame:
      return " ID#DATA";
    case Argument::identifier:
      return " ID";
  }
  return "";
}

}  // namespace

std::span<const FaultDeclaration> fault_declarations() { return declarations; }

std::uint64_t moved_between_syncs(std::uint64_t time_us, std::uint32_t tick_period_us) {
  constexpr std::uint32_t reading_us = 1'000;
  constexpr std::uint32_t before_us = 200;
  const std::uint32_t shortest_part = tick_period_us / 4;
  const std::uint64_t phase = time_us % tick_period_us;
  const std::uint64_t lowest = std::min(reading_us, shortest_part);
  const std::uint64_t highest = tick_period_us - std::min(before_us, shortest_part);
  return time_us - phase + std::clamp(phase, lowest, highest);
}

bool acts_between_syncs(std::uint64_t time_us, std::uint32_t tick_period_us) {
  return moved_between_syncs(time_us, tick_period_us) == time_us;
}

bool act_at_ticks(const FaultSchedule& schedule, std::uint32_t tick_period_us) {
  constexpr std::uint32_t max_reset_threshold_mv = 2'600;  // below it the program restarts, and ends this at no tick
  return std::ranges::all_of(schedule, [tick_period_us](const Fault& fault) {
    return declaration_of(fault.kind).acts_at_ticks &&
           (fault.kind != FaultKind::supply || fault.amount > max_reset_threshold_mv) &&
           acts_between_syncs(fault.start_us, tick_period_us) &&
           acts_between_syncs(fault.start_us + fault.duration_us.value_or(0), tick_period_us);
  });
}

const FaultDeclaration& declaration_of(FaultKind kind) { return declarations.at(static_cast<std::size_t>(kind)); }

std::string form_of(const FaultDeclaration& declaration) {
  std::string form = "at TIME ";
  form += declaration.name;
  form += declaration.has_joint ? " JOINT" : "";
  form += argument_name(declaration.argument);
  form += declaration.kind == FaultKind::send ? " [every TIME]" : "";
  switch (declaration.duration) {
    case Duration::none:
      return form;
    case Duration::needed:
      return form + " for TIME";
    case Duration::optional:
      return form + " [for TIME]";
  }
  return form;
}

std::string describe(const Fault& fault, const RobotModel& robot) {
  const FaultDeclaration& declaration = declaration_of(fault.kind);
  std::string text = "at " + time_word(fault.start_us) + " ";
  text += declaration.name;
  if (fault.joint) {
    text += " " + robot.joints[*fault.joint].name;
  }
  if (const std::string word = argument_word(fault, declaration.argument); !word.empty()) {
    text += " " + word;
  }
  if (fault.repeat_us != 0) {
    text += " every " + time_word(fault.repeat_us);
  }
  if (fault.duration_us) {
    text += " for " + time_word(*fault.duration_us);
  }
  return text;
}

std::string time_word(std::uint64_t us) {
  constexpr std::uint64_t ms = 1'000;
  constexpr std::uint64_t s = 1'000'000;
  const auto in = [us](std::uint64_t unit, std::uint64_t digits) {
    std::string text = std::to_string(us / unit);
    std::string rest = std::to_string(us % unit);
    rest.insert(0, digits - rest.size(), '0');
    rest.erase(rest.find_last_not_of('0') + 1);
    return rest.empty() ? text : text + "." + rest;
  };
  if (us >= s || us == 0) {
    return in(s, 6) + "s";
  }
  return us >= ms ? in(ms, 3) + "ms" : std::to_string(us) + "us";
}

}  // namespace proleg::sim
