#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shared/kernel/kernel.hpp"

namespace proleg {

/// The whole state of a kernel, parameters included, as bytes that are the same on every computer. The list of values
/// in the state is the test's own: a kernel that holds more would not continue bit for bit from a snapshot.
class KernelSnapshot {
 public:
  [[nodiscard]] static std::vector<std::uint8_t> save(const Kernel& kernel);
  /// Restores a state. False, without an effect, for bytes that save() cannot have written for a kernel with this
  /// configuration and these local joints.
  [[nodiscard]] static bool restore(Kernel& kernel, std::span<const std::uint8_t> snapshot);

 private:
  template <typename AnyKernel, typename Archive>
  static void visit_state(AnyKernel& kernel, Archive& archive);
  template <typename AnyStaging, typename Archive>
  static void visit_transactions(AnyStaging& staging, Archive& archive);
  template <typename AnyKernel, typename Archive>
  static void visit_staged(AnyKernel& kernel, JointMemory& joint, Archive& archive);
  static bool is_stageable(const Kernel& kernel, const JointMemory& joint, const StagedValue& staged);
};

}  // namespace proleg
