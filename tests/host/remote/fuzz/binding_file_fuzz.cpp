// Files of bindings. A file is refused in one line, or its bindings move a parameter within its limits only, and are
// read again as they were written.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "host/remote/binding.hpp"
#include "host/remote/bound_elements.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "tests/support/fuzz_input.hpp"

namespace {

using namespace proleg::host;
using proleg::test::require;

void check_values(const ParameterBinding& binding) {
  const double low = std::min(binding.lower, binding.upper);
  const double high = std::max(binding.lower, binding.upper);
  for (const double position : {-1.0, -0.3, 0.0, 0.4, 1.0}) {
    const double value = stepped_value(binding, linear_value(binding, ElementKind::axis, position));
    require(std::isfinite(value) && value >= low && value <= high, "a value is within the limits");
  }
  require(stepped_value(binding, linear_value(binding, ElementKind::axis, 1)) == binding.upper, "an end is a limit");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const std::vector<Binding> bindings =
        read_bindings(std::string_view(reinterpret_cast<const char*>(data), size), "robot.remote.json");
    for (const Binding& binding : bindings) {
      if (const auto* const target = std::get_if<ParameterBinding>(&binding.target)) {
        check_values(*target);
      }
    }
    const std::string text = bindings_text(bindings);
    require(bindings_text(read_bindings(text, "again")) == text, "a file that was written is read as it was");
  } catch (const proleg::InputError& error) {
    const std::string what = error.what();
    require(what.starts_with("robot.remote.json"), "an error names the file");
    require(what.find('\n') == std::string::npos, "an error is one line");
  }
  return 0;
}
