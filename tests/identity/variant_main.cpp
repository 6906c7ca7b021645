// Plays the identity cases as one particular compiler and optimisation level have made them, and writes the traces to
// standard output: for each case the set-points, then the servo commands, as little-endian int32_t.
// Arguments: id of the algorithm, "whole" or "modules", first case, number of cases.

#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "tests/identity/identity_case.hpp"

namespace {

bool write_out(const std::array<std::int32_t, proleg::identity::tick_count * proleg::identity::joint_count>& values) {
  for (const std::int32_t value : values) {
    const auto bits = static_cast<std::uint32_t>(value);
    const unsigned char bytes[] = {
        static_cast<unsigned char>(bits & 0xFFU), static_cast<unsigned char>(bits >> 8U & 0xFFU),
        static_cast<unsigned char>(bits >> 16U & 0xFFU), static_cast<unsigned char>(bits >> 24U)};
    if (std::fwrite(bytes, 1, sizeof bytes, stdout) != sizeof bytes) {
      return false;
    }
  }
  return true;
}

template <typename Robot>
int play(const proleg::ActuationModule& algorithm, unsigned long first, unsigned long count) {
  static Robot robot;
  static proleg::identity::Trace trace;
  const auto kernels = robot.kernels();
  for (unsigned long number = first; number < first + count; ++number) {
    const proleg::Status status =
        proleg::identity::run(kernels, algorithm, static_cast<std::uint32_t>(number), {}, trace);
    if (status != proleg::Status::ok || trace.missed_frames != 0) {
      std::fprintf(stderr, "case %lu: status %d, %u missed frames\n", number, static_cast<int>(status),
                   static_cast<unsigned>(trace.missed_frames));
      return 1;
    }
    if (!write_out(trace.setpoints) || !write_out(trace.servo_commands)) {
      return 1;
    }
  }
  return 0;
}

}  // namespace

int main(int argument_count, char** arguments) {
  if (argument_count != 5) {
    std::fputs("arguments: ALGORITHM_ID whole|modules FIRST_CASE CASES\n", stderr);
    return 2;
  }
  const auto id = static_cast<std::uint8_t>(std::strtoul(arguments[1], nullptr, 10));
  const proleg::ActuationModule* algorithm = proleg::identity::find_algorithm(id);
  if (algorithm == nullptr) {
    std::fprintf(stderr, "no algorithm has the id %s\n", arguments[1]);
    return 2;
  }
  const unsigned long first = std::strtoul(arguments[3], nullptr, 10);
  const unsigned long count = std::strtoul(arguments[4], nullptr, 10);
  return std::string_view(arguments[2]) == "whole" ? play<proleg::identity::WholeRobot>(*algorithm, first, count)
                                                   : play<proleg::identity::Modules>(*algorithm, first, count);
}
