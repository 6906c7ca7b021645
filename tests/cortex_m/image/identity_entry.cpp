// Entry point for tests/identity: a case as five modules play it.

#include "tests/identity/identity_case.hpp"

namespace {

proleg::identity::Modules modules;

}  // namespace

extern "C" {

proleg::identity::Trace identity_trace;

/// Plays a case and leaves its trace in identity_trace. Returns the Status.
std::uint32_t identity_run(std::uint32_t algorithm_id, std::uint32_t number) {
  const auto id = static_cast<std::uint8_t>(algorithm_id);
  const std::array<proleg::Kernel*, proleg::identity::joint_count> kernels = modules.kernels();
  return static_cast<std::uint32_t>(
      proleg::identity::run(kernels, *proleg::identity::find_algorithm(id), number, {}, identity_trace));
}

}  // extern "C"
