#pragma once

// The runs that must come out the same bit for bit everywhere. This file and its .cpp are compiled unchanged into the
// programs for this computer and into the image for Cortex-M, so they keep to the rules of the core: integers only, no
// heap.
//
// A case is an algorithm and a number. From the two follows, by seeded noise, everything that can happen to a robot of
// five joints in 1000 ticks: groups, parameters of each joint over their whole ranges, a second slot, limits, contacts
// in every tick, up to two commits and a distortion.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "shared/kernel/kernel.hpp"

namespace proleg::identity {

inline constexpr unsigned joint_count = 5;
inline constexpr unsigned tick_count = 1000;

/// An algorithm of the registry, or the sensing probe, by the id of its declaration; null if there is none.
[[nodiscard]] const ActuationModule* find_algorithm(std::uint8_t id);

/// What a run leaves: for ticks 1 to 1000, within a tick in kernel order, the joint's set-point (90 degrees = 2^30) and
/// a servo command somewhere on the way to it, within the greatest speed of commanded angles.
struct Trace {
  std::uint32_t missed_frames;  ///< of all kernels together; 0 unless a fault was injected
  std::array<std::int32_t, std::size_t{tick_count} * joint_count> setpoints;
  std::array<std::int32_t, std::size_t{tick_count} * joint_count> servo_commands;
};

/// What goes wrong between one pair of joints, once.
enum class Fault : std::uint8_t {
  none,
  dropped_frame,   ///< the frame is never delivered
  late_frame,      ///< the frame is delivered a tick after its own
  stale_contacts,  ///< the frame is delivered in time with the contacts of the tick before
};
struct FaultInjection {
  Fault fault = Fault::none;
  std::uint32_t tick = 0;  ///< label of the frame
  std::uint8_t sender = 0;
  std::uint8_t receiver = 0;
};

/// Five kernels of one joint each, as in five modules; they exchange packed state frames and nothing else.
class Modules {
 public:
  [[nodiscard]] std::array<Kernel*, joint_count> kernels();

 private:
  std::array<KernelOf<1>, joint_count> kernels_;
};

/// One kernel of all joints, as in the simulator.
class WholeRobot {
 public:
  [[nodiscard]] std::array<Kernel*, 1> kernels() { return {&kernel_}; }

 private:
  KernelOf<joint_count> kernel_;
};

/// Runs a case. kernels: together they have the memory of five joints, in kernel order. number: of the
/// case. Returns the first status that a kernel should not have answered, else `ok`.
Status run(std::span<Kernel* const> kernels, const ActuationModule& algorithm, std::uint32_t number,
           const FaultInjection& fault, Trace& trace);

}  // namespace proleg::identity
