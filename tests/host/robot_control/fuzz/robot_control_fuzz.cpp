// A plug-in that returns anything. The host accepts only values that a robot can have, and throws one-line errors.

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>

#include "tests/host/robot_control/scripted_plugin.hpp"
#include "tests/support/fuzz_input.hpp"

namespace {

using namespace proleg;
using test::FuzzInput;
using test::PluginScript;
using test::require;

/// Ordinary numbers, and any others.
double number(FuzzInput& input) {
  if (input.byte() < 200) {
    return static_cast<std::int8_t>(input.byte());
  }
  const std::uint64_t low = input.word();
  return std::bit_cast<double>(low | std::uint64_t{input.word()} << 32U);
}

std::string text(FuzzInput& input) {
  std::string characters;
  for (unsigned size = input.byte(); size > 0 && !input.empty(); --size) {
    characters.push_back(static_cast<char>(input.byte()));
  }
  return characters;
}

void choose_replies(PluginScript& script, FuzzInput& input) {
  script.result = input.byte() < 200 ? PROLEG_OK : static_cast<std::int8_t>(input.byte());
  script.error = text(input);
  script.count = input.byte() < 128 ? UINT32_MAX : input.word();
  script.values.resize(input.byte() < 200 ? 2 : input.byte() % 8);
  for (double& value : script.values) {
    value = number(input);
  }
}

template <typename Action>
void attempt(const Action& action) {
  try {
    action();
  } catch (const host::RobotControlError& error) {
    require(std::string(error.what()).find('\n') == std::string::npos, "an error is one line");
  }
}

void use(FuzzInput& input) {
  PluginScript script;
  script.open_result = input.byte() < 240 ? PROLEG_OK : PROLEG_FAILED;
  script.error = text(input).substr(0, 500);
  script.joints = input.byte() < 240 ? 2 : input.word();
  script.sensor_modules = input.byte() < 128 ? 0 : input.byte() % 5;
  script.sensors_per_module = script.sensor_modules == 0 ? 0 : input.byte() % 4;
  script.topology = text(input);
  script.lower_deg = input.byte() < 200 ? -90.0 : number(input);
  script.upper_deg = input.byte() < 200 ? 90.0 : number(input);
  attempt([&] {
    host::RobotControl control(test::plugin_of(script), test::setup_of(2), {});
    const auto& description = control.description();
    require(description.lower_limit_deg[1] <= 0.0 && description.upper_limit_deg[1] >= 0.0, "limits contain 0");
    for (int i = 0; i < 8 && !input.empty(); ++i) {
      choose_replies(script, input);
      attempt([&] { control.connect(); });
      attempt([&] {
        for (const double angle : control.request_information("position")) {
          require(std::abs(angle) <= 360.0, "an angle is one that a robot has");
        }
      });
      attempt([&] {
        const std::size_t sensors = std::size_t{description.sensor_modules} * description.sensors_per_module;
        require(control.request_information("contact").size() == sensors, "a value for each sensor");
      });
      attempt([&] { require(control.request_information("anything").size() == 2, "a value for each joint"); });
      attempt([&] { require(control.request_all_information().size() <= 65'536, "no more than there is room for"); });
    }
  });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  FuzzInput input({data, size});
  use(input);
  return 0;
}
