#include "sim/fault/fault.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <sstream>
#include <string_view>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/scenario/names.hpp"

namespace proleg::sim {
namespace {

using Argument = FaultDeclaration::Argument;
using Duration = FaultDeclaration::Duration;

constexpr std::size_t max_faults = 10'000;
constexpr std::uint64_t max_time_us = 1'000'000'000'000;

/// Parses a number with a unit: "2.5V". Nothing for another unit, or a number outside of the range.
std::optional<std::uint32_t> scaled(std::string_view word, std::string_view unit, double scale, double max) {
  if (!word.ends_with(unit)) {
    return std::nullopt;
  }
  const auto number = parse_number(word.substr(0, word.size() - unit.size()));
  if (!number || *number < 0.0 || *number > max) {
    return std::nullopt;
  }
  return static_cast<std::uint32_t>(std::lround(*number * scale));
}

/// Parses "1.2s", "400ms" or "50us"; in microseconds.
std::optional<std::uint64_t> parse_time(std::string_view word) {
  double scale = 1e6;
  std::size_t unit = 1;
  if (word.ends_with("ms")) {
    scale = 1e3;
    unit = 2;
  } else if (word.ends_with("us")) {
    scale = 1.0;
    unit = 2;
  } else if (!word.ends_with('s')) {
    return std::nullopt;
  }
  const auto number = parse_number(word.substr(0, word.size() - unit));
  if (!number || *number < 0.0 || *number * scale > static_cast<double>(max_time_us)) {
    return std::nullopt;
  }
  return static_cast<std::uint64_t>(std::llround(*number * scale));
}

std::optional<std::uint16_t> parse_identifier(std::string_view word) {
  const auto identifier = parse_whole<std::uint16_t>(word, 16);
  return word.size() == 3 && identifier && *identifier <= CanFrame::max_identifier ? identifier : std::nullopt;
}

/// The words of a line, taken one after the other.
class FaultLine {
 public:
  FaultLine(const std::string& text, const std::string& path, int line, const RobotModel& robot, std::uint64_t run_us)
      : text_(text), path_(path), line_(line), robot_(robot), run_us_(run_us), words_(words(text)) {}

  /// The faults of the line: one, or one for each joint.
  [[nodiscard]] std::vector<Fault> read() {
    take_keyword("at", "at TIME KIND ...; 'proleg faults' lists the kinds");
    Fault fault;
    fault.start_us = take_time();
    if (fault.start_us >= run_us_) {
      refuse("the time " + time_word(fault.start_us), "less than the " + time_word(run_us_) + " of the run");
    }
    const FaultDeclaration& declaration = take_kind();
    form_ = form_of(declaration);
    fault.kind = declaration.kind;
    std::vector<unsigned> joints;
    if (declaration.has_joint) {
      joints = take_joints();
    }
    take_argument(declaration, fault);
    if (fault.kind == FaultKind::send && is_next("every")) {
      ++next_;
      fault.repeat_us = take_nonzero_time();
    }
    take_duration(declaration, fault);
    if (next_ != words_.size()) {
      refuse(in_quotes(words_[next_]), form_);
    }
    if (joints.empty()) {
      return {fault};
    }
    std::vector<Fault> faults(joints.size(), fault);
    for (std::size_t i = 0; i < joints.size(); ++i) {
      faults[i].joint = joints[i];
    }
    return faults;
  }

  [[noreturn]] void refuse(const std::string& found, const std::string& expected) const {
    throw InputError(path_, line_, found, expected);
  }

 private:
  [[nodiscard]] bool is_next(std::string_view word) const { return next_ < words_.size() && words_[next_] == word; }
  std::string_view take(const std::string& expected) {
    if (next_ == words_.size()) {
      refuse(in_quotes(text_), expected);
    }
    return words_[next_++];
  }
  void take_keyword(std::string_view keyword, const std::string& expected) {
    if (const std::string_view word = take(expected); word != keyword) {
      refuse(in_quotes(word), expected);
    }
  }
  std::uint64_t take_time() {
    const std::string_view word = take(form_);
    const auto time = parse_time(word);
    if (!time) {
      refuse("the time " + in_quotes(word), "a number with s, ms or us, for example 1.2s");
    }
    return *time;
  }
  std::uint64_t take_nonzero_time() {
    const std::uint64_t time = take_time();
    if (time == 0) {
      refuse("a time of 0", "at least 1us");
    }
    return time;
  }
  const FaultDeclaration& take_kind() {
    const std::string_view word = take(form_);
    std::vector<std::string> names;
    for (const FaultDeclaration& declaration : fault_declarations()) {
      if (declaration.name == word) {
        return declaration;
      }
      names.emplace_back(declaration.name);
    }
    refuse("the fault " + in_quotes(word), "one of " + listed(names));
  }
  std::vector<unsigned> take_joints() {
    const std::string name(take(form_));
    if (name == "*") {
      std::vector<unsigned> all(robot_.joints.size());
      for (unsigned joint = 0; joint < all.size(); ++joint) {
        all[joint] = joint;
      }
      return all;
    }
    const int joint = find_joint(robot_, name);
    if (joint < 0) {
      refuse("the joint " + in_quotes(name), "one of " + listed(joint_names(robot_)) + ", or * for all");
    }
    return {static_cast<unsigned>(joint)};
  }
  void take_argument(const FaultDeclaration& declaration, Fault& fault) {
    if (declaration.argument == Argument::none) {
      return;
    }
    const std::string_view word = take(form_);
    const auto set = [&](const auto& value, auto& target, const char* expected) {
      if (!value) {
        refuse(in_quotes(word), expected);
      }
      target = *value;
    };
    switch (declaration.argument) {
      case Argument::none:
        break;
      case Argument::voltage:
        set(scaled(word, "V", 1000.0, 3.6), fault.amount, "0V to 3.6V");
        break;
      case Argument::current:
        set(scaled(word, "A", 1000.0, 10.0), fault.amount, "0A to 10A");
        break;
      case Argument::rate:
        set(parse_rate(word), fault.amount, "a probability, 0 to 1 or 0% to 100%");
        break;
      case Argument::time: {
        const std::uint64_t time = parse_time(word).value_or(0);
        const bool fits = time > 0 && time <= max_delay_us;
        set(fits ? std::optional(static_cast<std::uint32_t>(time)) : std::nullopt, fault.amount, "1us to 10s");
        break;
      }
      case Argument::touch:
        fault.touch = touch_of(word);
        break;
      case Argument::frame:
        set(parse_frame(word), fault.frame,
            "ID#DATA: three hexadecimal digits up to 7FF, up to 8 bytes in hexadecimal; for example 080#05");
        break;
      case Argument::identifier:
        set(parse_identifier(word), fault.frame.identifier, "three hexadecimal digits up to 7FF");
        break;
    }
  }
  TouchFault touch_of(std::string_view word) const {
    if (word == "pressed") {
      return TouchFault::pressed;
    }
    if (word == "open") {
      return TouchFault::open;
    }
    if (word != "bouncing") {
      refuse(in_quotes(word), "pressed, open or bouncing");
    }
    return TouchFault::bouncing;
  }
  void take_duration(const FaultDeclaration& declaration, Fault& fault) {
    if (declaration.duration == Duration::none) {
      return;
    }
    if (declaration.duration == Duration::optional && !is_next("for")) {
      return;
    }
    take_keyword("for", form_);
    fault.duration_us = take_nonzero_time();
    if (fault.kind == FaultKind::dominant && *fault.duration_us < min_dominant_us) {
      refuse("a dominant bus for " + time_word(*fault.duration_us), "at least " + time_word(min_dominant_us));
    }
  }

  static constexpr std::uint64_t max_delay_us = 10'000'000;
  static constexpr std::uint64_t min_dominant_us = 300;  ///< Bus::hold_dominant() models no shorter times

  const std::string& text_;
  const std::string& path_;
  int line_;
  const RobotModel& robot_;
  std::uint64_t run_us_;
  std::vector<std::string_view> words_;
  std::size_t next_ = 0;
  std::string form_ = "at TIME KIND ...; 'proleg faults' lists the kinds";
};

/// Two faults of one kind at one place must not overlap: the end of the first would end the second. Frames may.
const Fault* find_overlap(const FaultSchedule& schedule, const Fault& fault) {
  if (fault.kind == FaultKind::send || fault.kind == FaultKind::reset) {
    return nullptr;
  }
  const auto end = [](const Fault& one) {
    return one.duration_us ? one.start_us + *one.duration_us : std::numeric_limits<std::uint64_t>::max();
  };
  const auto other = std::ranges::find_if(schedule, [&](const Fault& one) {
    return one.kind == fault.kind && one.joint == fault.joint && one.start_us <= end(fault) &&
           fault.start_us <= end(one);
  });
  return other == schedule.end() ? nullptr : &*other;
}

/// The line without its comment, which begins with "#" at the start or after a blank. (A frame has a "#" in its
/// middle.)
std::string without_comment(const std::string& line) {
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '#' && (i == 0 || line[i - 1] == ' ' || line[i - 1] == '\t')) {
      return line.substr(0, i);
    }
  }
  return line;
}

}  // namespace

std::optional<CanFrame> parse_frame(std::string_view word) {
  const std::size_t hash = word.find('#');
  const auto identifier = parse_identifier(word.substr(0, hash));
  if (!identifier || hash == std::string_view::npos) {
    return std::nullopt;
  }
  const std::string_view data = word.substr(hash + 1);
  if (data.size() % 2 != 0 || data.size() > std::size_t{2} * CanFrame::max_length) {
    return std::nullopt;
  }
  CanFrame frame{*identifier, static_cast<std::uint8_t>(data.size() / 2), {}};
  for (std::size_t i = 0; i < frame.length; ++i) {
    const auto byte = parse_whole<std::uint8_t>(data.substr(2 * i, 2), 16);
    if (!byte) {
      return std::nullopt;
    }
    frame.data.at(i) = *byte;
  }
  return frame;
}

FaultSchedule parse_faults(const std::string& text, const std::string& path, const RobotModel& robot,
                           std::uint64_t run_us) {
  FaultSchedule schedule;
  TextLines lines(text);
  while (const std::optional<std::string_view> whole = lines.next()) {
    const std::string line = without_comment(std::string(*whole));
    if (trimmed(line).empty()) {
      continue;
    }
    FaultLine reader(line, path, lines.number(), robot, run_us);
    for (const Fault& fault : reader.read()) {
      if (const Fault* other = find_overlap(schedule, fault)) {
        reader.refuse(in_quotes(describe(fault, robot)) + " while " + in_quotes(describe(*other, robot)) + " lasts",
                      "faults of one kind one after the other");
      }
      if (schedule.size() == max_faults) {
        reader.refuse("more than " + std::to_string(max_faults) + " faults", "fewer");
      }
      schedule.push_back(fault);
    }
  }
  std::ranges::stable_sort(schedule, {}, &Fault::start_us);
  return schedule;
}

FaultSchedule read_faults(const std::string& path, const RobotModel& robot, std::uint64_t run_us) {
  constexpr std::uintmax_t max_bytes = 16U << 20U;
  if (const std::optional<std::string> found = found_instead_of_file(path)) {
    throw InputError(in_quotes(path), 0, *found, "a fault schedule, or SEED or SEED:COUNT");
  }
  std::error_code error;
  if (std::filesystem::file_size(path, error) > max_bytes) {
    throw InputError(path, 0, "a file above 16 MiB", "a fault schedule");
  }
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file || (text.fail() && std::filesystem::file_size(path, error) > 0)) {
    throw InputError(path, 0, "a file that cannot be read", "a fault schedule");
  }
  FaultSchedule schedule = parse_faults(text.str(), path, robot, run_us);
  if (schedule.empty()) {
    throw InputError(path, 0, "no fault", "a line 'at TIME KIND ...' for each fault");
  }
  return schedule;
}

std::string faults_text(const FaultSchedule& schedule, const RobotModel& robot) {
  std::string text;
  for (const Fault& fault : schedule) {
    text += describe(fault, robot) + "\n";
  }
  return text;
}

}  // namespace proleg::sim
