#pragma once

// The values that a kernel keeps for each of its joints.

#include <array>
#include <cstddef>
#include <cstdint>

#include "shared/kernel/kernel_configuration.hpp"

namespace proleg {

/// Greatest number of values of one joint that are staged at the same time, in all transactions together: as many as
/// its slots have parameters at most.
inline constexpr std::size_t max_staged_values = max_slots * max_parameters;

/// A change of one value of a joint that waits for its transaction to take effect.
struct StagedValue {
  std::int32_t value;
  std::uint8_t transaction;  ///< position in the list of Staging
  std::uint8_t slot;
  std::uint8_t number;  ///< number of the parameter or internal value
  bool internal;
};

struct StagedValues {
  std::array<StagedValue, max_staged_values> values;
  std::uint8_t count;
};

/// The values of one slot on one joint.
struct SlotMemory {
  JointContext context;
  Neighbour ahead;
  Neighbour behind;
  std::array<std::int32_t, max_parameters> parameters;
  std::array<std::int32_t, max_derived> derived;
  std::array<std::array<std::int32_t, max_internal_values>, 2>
      values;                    ///< two buffers: advance() reads one and writes the other
  const Declaration* broadcast;  ///< null if the slot sends nothing
  std::uint8_t channel;
  bool active;
  std::uint8_t sensed_joints;  ///< number of joints whose contacts the algorithm receives: all, or 0
};

struct JointMemory {
  std::array<SlotMemory, max_slots> slots;
  StagedValues staged;
  std::int32_t lower_limit;
  std::int32_t upper_limit;
  std::int32_t previous_setpoint;
  std::int32_t setpoint;
  std::uint8_t contacts;
  bool limited;
  std::uint8_t needed_readings;  ///< bits of JointReadings::Sensor, for all slots of the joint together
  JointReadings readings;
};

}  // namespace proleg
