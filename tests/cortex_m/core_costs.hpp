#pragma once

// What the core costs on a Cortex-M: instructions and stack, measured on the emulated CPU. Instructions count when they
// are issued; the counts do not depend on the computer that measures.

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "tests/cortex_m/machine.hpp"

namespace proleg::cortex_m {

struct Instructions {
  double mean = 0;
  std::uint64_t worst = 0;
};

/// A joint of five, and parameters of the algorithm that have other values than the default there.
struct MeasuredJoint {
  std::uint32_t joint = 2;
  std::vector<std::pair<std::uint32_t, std::int32_t>> parameters;  ///< number and raw value
};

/// The joint of the gait selector that decides, with rules of which it evaluates all conditions. features: their
/// numbers in the rules for the sets 2, 3 and 4, two each.
[[nodiscard]] MeasuredJoint deciding_joint(const std::array<std::int32_t, 6>& features);
/// Rules that name the features of touch, and rules that name as many features as six conditions can, the most
/// expensive ones: pitch_swing, for which pitch is computed too, roll, touch, touch_changes, current and
/// tracking_error.
constexpr std::array<std::int32_t, 6> of_touch{4, 5, 5, 6, 6, 4};
constexpr std::array<std::int32_t, 6> of_most_features{2, 3, 4, 6, 7, 8};

/// One tick of a joint of five, alone in its kernel, with an algorithm in one slot. The cost of giving the kernel its
/// readings is not in it: it is that of every algorithm.
struct TickCost {
  Instructions set_contacts;
  Instructions receive;  ///< all four frames of the other joints
  Instructions advance;
  Instructions total;
};
[[nodiscard]] TickCost measure_tick(Machine& machine, std::uint8_t algorithm_id, unsigned ticks,
                                    const MeasuredJoint& measured = {});

/// The same ticks of the middle joint, each as one call of a function of the image: with the instructions that call the
/// parts.
[[nodiscard]] Instructions measure_whole_tick(Machine& machine, std::uint8_t algorithm_id, unsigned ticks);

/// sine() over phases in all quarters.
[[nodiscard]] Instructions measure_sine(Machine& machine);

/// Deepest stack of a kernel's function, in bytes, over all algorithms of the core, with a commit and with missing
/// frames.
struct StackUse {
  std::string function;  ///< qualified, e.g. "proleg::Kernel::advance"
  std::size_t bytes;
};
[[nodiscard]] std::vector<StackUse> measure_stack(Machine& machine);

/// Sizes in bytes of what a module keeps: one JointMemory and one Kernel.
struct Sizes {
  std::uint32_t joint_memory;
  std::uint32_t kernel;
};
[[nodiscard]] Sizes read_sizes(const Machine& machine);

}  // namespace proleg::cortex_m
