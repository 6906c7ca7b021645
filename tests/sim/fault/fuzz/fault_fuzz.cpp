// Reads arbitrary input as a fault file. For every input the reader must return a schedule that is the same when it is
// written and read again, or throw an InputError of one line.

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "shared/computer/errors/input_error.hpp"
#include "sim/fault/fault.hpp"
#include "sim/scenario/reader.hpp"
#include "tests/support/files.hpp"

namespace {

using namespace proleg;
using namespace proleg::sim;

const RobotModel& caterpillar() {
  static const RobotModel robot = [] {
    DiskFiles files;
    return read_scenario(source_path("/sim/scenarios/travelling_wave/uniform.simulation.xml"), files).robot;
  }();
  return robot;
}

void require(bool holds, const char* what) {
  if (!holds) {
    std::fprintf(stderr, "broken promise: %s\n", what);
    std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::uint64_t run_us = 5'000'000;
  const std::string text(data, data + size);
  try {
    const FaultSchedule schedule = parse_faults(text, "input", caterpillar(), run_us);
    const std::string written = faults_text(schedule, caterpillar());
    require(parse_faults(written, "written", caterpillar(), run_us) == schedule, "what is written is read again");
  } catch (const InputError& error) {
    require(std::string(error.what()).find('\n') == std::string::npos, "an error is one line");
  }
  return 0;
}
