#pragma once

// The faults of a run with hardware in the loop: as data, as the text of a file, and drawn at random. docs/faults.md
// comes from the declarations.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "shared/can/can_frame.hpp"
#include "sim/robot/robot_model.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

enum class FaultKind : std::uint8_t {
  unplug,
  supply,
  reset,
  crystal,
  pll,
  adc,
  touch,
  jam,
  babble,
  dominant,
  corrupt,
  lose,
  delay,
  send,
  master,
  host_stall,
  host_dies,
};

/// Faults of touch sensors.
enum class TouchFault : std::uint8_t { none, pressed, open, bouncing };

/// One fault. Times are microseconds after SYNC 0 of the run.
struct Fault {
  FaultKind kind{};
  std::uint64_t start_us = 0;
  std::optional<std::uint64_t> duration_us;  ///< nothing: the fault occurs once, or lasts to the end of the run
  std::optional<unsigned> joint;             ///< joint of the faulty module, in kernel order
  /// Amount in a unit that depends on the kind: mV (supply), mA (jam), probability times 2^32 (corrupt, lose),
  /// microseconds (delay); else 0.
  std::uint32_t amount = 0;
  TouchFault touch = TouchFault::none;  ///< fault of the kind touch
  CanFrame frame;                       ///< frame of the kinds send and babble
  std::uint64_t repeat_us = 0;          ///< period of the kind send; 0: it sends once

  friend bool operator==(const Fault&, const Fault&) = default;
};

using FaultSchedule = std::vector<Fault>;  ///< in the order of their starts

/// The text form and the meaning of a kind of fault.
struct FaultDeclaration {
  enum class Argument : std::uint8_t { none, voltage, current, rate, time, touch, frame, identifier };
  enum class Duration : std::uint8_t { none, needed, optional };

  FaultKind kind;
  std::string_view name;  ///< name in files
  bool has_joint;
  Argument argument;
  Duration duration;
  bool needs_chip;     ///< only a virtual chip can play it
  bool acts_at_ticks;  ///< its effect does not depend on the microseconds that a program needs
  std::string_view help;
};

/// All kinds, in the order of FaultKind.
[[nodiscard]] std::span<const FaultDeclaration> fault_declarations();
[[nodiscard]] const FaultDeclaration& declaration_of(FaultKind kind);

/// The form of a kind in a file: "at TIME unplug JOINT for TIME".
[[nodiscard]] std::string form_of(const FaultDeclaration& declaration);

/// Whether all faults act at ticks: then native modules and virtual chips have the same set-points and pulses. With
/// other faults they mostly have them, but microseconds may decide which frame a fault hits, or which of two events
/// comes first. For this reason a fault also must not begin or end around a SYNC, while programs read their sensors:
/// acts_between_syncs().
[[nodiscard]] bool act_at_ticks(const FaultSchedule& schedule, std::uint32_t tick_period_us);

/// Whether a time since SYNC 0 is not around a SYNC: a millisecond after it, or a fifth of one before it; both are
/// shorter if a tick is shorter than 4 ms.
[[nodiscard]] bool acts_between_syncs(std::uint64_t time_us, std::uint32_t tick_period_us);
/// The time between SYNCs that is nearest to a time, in the same tick.
[[nodiscard]] std::uint64_t moved_between_syncs(std::uint64_t time_us, std::uint32_t tick_period_us);

/// Text of a fault as in a file: "at 1.2s unplug J3 for 400ms".
[[nodiscard]] std::string describe(const Fault& fault, const RobotModel& robot);

/// Shortest text of a time: "1.2s", "400ms", "50us".
[[nodiscard]] std::string time_word(std::uint64_t us);

/// Reads a fault schedule (docs/faults.md): a fault in each line, "#" starts a comment; JOINT is a name of the robot or
/// "*" for one fault at each joint. Throws InputError that names file and line: for an unknown kind, joint or form, for
/// a time at or after the end of the run, and for two faults of one kind at one place at the same time.
[[nodiscard]] FaultSchedule read_faults(const std::string& path, const RobotModel& robot, std::uint64_t run_us);

/// Reads a fault schedule from text. path: name for messages.
[[nodiscard]] FaultSchedule parse_faults(const std::string& text, const std::string& path, const RobotModel& robot,
                                         std::uint64_t run_us);

/// Parses a frame as cansend of can-utils does: "080#05", three hexadecimal digits up to 7FF, up to 8 bytes in
/// hexadecimal.
[[nodiscard]] std::optional<CanFrame> parse_frame(std::string_view word);

/// Text of a file with the faults, which read_faults() reads.
[[nodiscard]] std::string faults_text(const FaultSchedule& schedule, const RobotModel& robot);

/// Settings for random schedules.
struct RandomFaults {
  std::uint64_t seed = 0;
  std::uint64_t run_us = 5'000'000;  ///< at least min_random_run_us
  bool has_chips = false;            ///< whether to draw faults that only a virtual chip can play
  bool only_at_ticks = false;        ///< whether act_at_ticks() must be true
};

/// Time between the end of all random faults and the end of a run, so that each module comes to rest in a safe state.
inline constexpr std::uint64_t rest_after_faults_us = 2'000'000;
/// Shortest run with random faults.
inline constexpr std::uint64_t min_random_run_us = rest_after_faults_us + 500'000;

/// Draws one to four faults of any kind, which depend only on the seed and the robot. Times, durations and places are
/// random; each kind has mild and severe cases.
[[nodiscard]] FaultSchedule random_faults(const RandomFaults& settings, const Scenario& scenario);

}  // namespace proleg::sim
