#pragma once

// What an actuation module of a recording contributed to the set-points: recordings have its internal values, and the
// sum of all modules.

#include <array>
#include <cstdint>
#include <vector>

#include "shared/gait/actuation_module.hpp"
#include "sim/record/recording.hpp"

namespace proleg::sim {

/// The outputs of one slot on its joints, computed by the core from recorded parameters and internal values. Ticks must
/// ascend.
class ModuleOutput {
 public:
  /// recording: must outlive this object.
  ModuleOutput(const Recording& recording, const RecordedSlot& slot);

  /// False if this program's core has no such algorithm, or one with other internal values.
  [[nodiscard]] bool is_known() const { return algorithm_ != nullptr; }
  /// The output that belongs to the recorded state of `tick` (90 degrees = 2^30), without the limits of the joint.
  /// state: the internal values of the joint in their order. is_known() must hold, and the joint must be of the slot.
  [[nodiscard]] std::int32_t at(std::uint32_t tick, std::uint32_t joint, const std::int32_t* state);

 private:
  struct JointTuning {
    std::array<std::int32_t, max_parameters> parameters{};
    std::array<std::int32_t, max_derived> derived{};
  };

  void apply(const RecordedSetting& setting);
  void derive(std::uint32_t joint);

  const Recording& recording_;
  const RecordedSlot& slot_;
  const ActuationModule* algorithm_ = nullptr;
  std::vector<RecordedSetting> settings_;  ///< of the slot; those of the start first
  std::size_t next_setting_ = 0;
  std::vector<JointTuning> tunings_;  ///< by joint
};

}  // namespace proleg::sim
