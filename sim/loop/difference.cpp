#include "sim/loop/difference.hpp"

#include <sstream>

#include "shared/kernel/servo_pulses.hpp"

namespace proleg::sim {
namespace {

bool before(const ServoPulse& a, const ServoPulse& b) {
  return a.time_us != b.time_us ? a.time_us < b.time_us : a.joint < b.joint;
}

const char* name_of(Difference::Kind kind) {
  switch (kind) {
    case Difference::Kind::setpoint:
      return "set-point";
    case Difference::Kind::servo_command:
      return "servo command";
    case Difference::Kind::last_servo_command:
      return "last servo command";
    case Difference::Kind::internal_value:
      return "internal value";
    case Difference::Kind::late_servo_command:
    case Difference::Kind::missed_tick:
      break;
  }
  return "tick";
}

std::string in_words(Difference::Kind kind, std::optional<std::int32_t> value) {
  if (!value) {
    return "none";
  }
  std::ostringstream text;
  text << *value;
  if (kind == Difference::Kind::setpoint) {
    text << " (" << *value * (90.0 / (1 << 30)) << " deg)";
  } else if (kind != Difference::Kind::internal_value) {
    text << " (" << *value / static_cast<double>(servo_counts_per_us) << " us)";
  }
  return text.str();
}

}  // namespace

void compare_setpoints(std::uint32_t tick, std::span<const std::int32_t> found, std::span<const std::int32_t> expected,
                       const DifferenceNote& note) {
  for (std::uint32_t joint = 0; joint < expected.size(); ++joint) {
    if (found[joint] != expected[joint]) {
      note({Difference::Kind::setpoint, tick, joint, found[joint], expected[joint]});
    }
  }
}

void compare_pulses(std::uint32_t tick, std::span<const ServoPulse> found, std::span<const ServoPulse> expected,
                    const DifferenceNote& note) {
  constexpr auto kind = Difference::Kind::servo_command;
  std::size_t f = 0;
  std::size_t e = 0;
  while (f < found.size() || e < expected.size()) {
    if (e == expected.size() || (f < found.size() && before(found[f], expected[e]))) {
      note({kind, tick, found[f].joint, found[f].command, std::nullopt});
      ++f;
    } else if (f == found.size() || before(expected[e], found[f])) {
      note({kind, tick, expected[e].joint, std::nullopt, expected[e].command});
      ++e;
    } else {
      if (found[f].command != expected[e].command) {
        note({kind, tick, found[f].joint, found[f].command, expected[e].command});
      }
      ++f;
      ++e;
    }
  }
}

std::string describe(const Difference& difference, const std::string& joint_name) {
  std::ostringstream text;
  if (difference.kind == Difference::Kind::missed_tick) {
    text << joint_name << " was gone at the end of tick " << difference.tick << ", and this run had not stopped it";
    return text.str();
  }
  if (difference.kind == Difference::Kind::late_servo_command) {
    text << "servo command of " << joint_name << " at tick " << difference.tick << ", "
         << in_words(difference.kind, difference.found)
         << ": came after the next SYNC, too late for the simulated world";
    return text.str();
  }
  text << name_of(difference.kind) << " of " << joint_name << " at tick " << difference.tick << ": found "
       << in_words(difference.kind, difference.found) << ", expected "
       << in_words(difference.kind, difference.expected);
  return text.str();
}

}  // namespace proleg::sim
