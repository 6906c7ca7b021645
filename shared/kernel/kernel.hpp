#pragma once

// The control kernel (thesis, section 4.3.1 and algorithm 1): up to four slots, each an algorithm on a group of joints;
// groups may overlap, outputs are added joint by joint. The same code computes one joint (in a module) or all joints
// (in the simulator). Joints exchange nothing but state frames.
//
// Order of a tick k, at SYNC k: set_contacts, then advance(): commits due at k take effect, every local joint computes
// state k + 1 from the frames labelled k, then the frames labelled k + 1 are packed and may be sent. Frames of other
// joints labelled k + 1 are handed to receive() before SYNC k + 1.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "shared/kernel/joint_memory.hpp"
#include "shared/kernel/kernel_configuration.hpp"
#include "shared/kernel/staging.hpp"
#include "shared/kernel/status.hpp"

namespace proleg {

class Kernel {
 public:
  /// memory: one element for each joint that the kernel computes; it must outlive the kernel.
  explicit Kernel(std::span<JointMemory> memory) : memory_(memory) {}
  Kernel(const Kernel&) = delete;
  Kernel& operator=(const Kernel&) = delete;

  /// Takes a configuration, sets all parameters to their defaults and all limits to +-90 degrees, drops all staged
  /// values, and resets. The kernel computes the joints first_joint .. first_joint + size of the memory - 1.
  Status configure(const KernelConfiguration& configuration, unsigned first_joint);

  /// Sets the limits to which the sum of a joint's slots is cut (90 degrees = 2^30).
  Status set_limits(unsigned joint, std::int32_t lower, std::int32_t upper);

  /// Sets a parameter at once, for use before the first tick. The start state follows with the next reset().
  Status set_parameter(unsigned slot, unsigned joint, unsigned parameter, std::int32_t value);
  /// Sets the parameter of a setting at once. setting: not of an internal value.
  Status set_parameter(const Setting& setting) {
    return set_parameter(setting.slot, setting.joint, setting.number, setting.value);
  }

  /// Returns to tick 0 and state 0. Parameters and staged values stay.
  void reset();

  /// Opens a transaction under which values can be staged, even if it has none for the local joints. Drops the values
  /// of another transaction that is open. Opening the open transaction again changes nothing.
  Status open(std::uint16_t transaction) { return staging_.open(memory_, transaction); }
  /// Stages a parameter that takes effect at the commit's tick. Opens the transaction if necessary.
  Status stage(std::uint16_t transaction, unsigned slot, unsigned joint, unsigned parameter, std::int32_t value);
  /// Stages a setting: a parameter or an internal value.
  Status stage(std::uint16_t transaction, const Setting& setting) {
    return setting.internal ? stage_internal(transaction, setting.slot, setting.joint, setting.number, setting.value)
                            : stage(transaction, setting.slot, setting.joint, setting.number, setting.value);
  }
  /// Stages an internal value (thesis listing A.2, setDistortion). It is overwritten before the commit's tick is
  /// computed; neighbours receive it one tick later.
  Status stage_internal(std::uint16_t transaction, unsigned slot, unsigned joint, unsigned internal_value,
                        std::int32_t value);
  /// Commits the open transaction for a tick that is not computed yet. Repeating a commit, also the last one that took
  /// effect, is ok.
  Status commit(std::uint16_t transaction, std::uint32_t tick);
  [[nodiscard]] bool has_open_transaction() const { return staging_.has_open_transaction(); }
  /// Number of the open transaction; 0 if none is open.
  [[nodiscard]] std::uint16_t open_transaction() const { return staging_.open_transaction(); }
  /// Number of values that are staged under the open transaction.
  [[nodiscard]] unsigned staged_count() const { return staging_.open_count(memory_); }
  /// Reads a staged parameter or internal value of the open transaction; false if it is not staged.
  [[nodiscard]] bool staged_value(unsigned slot, unsigned joint, unsigned number, bool internal,
                                  std::int32_t& value) const;

  /// Joins a robot that already moves: tick() becomes `tick`, and the coming advance() starts from a state that it
  /// makes from the neighbours' frames labelled `tick`. That state is exact for the plain sine, which is a function of
  /// the tick, and approximate for other algorithms. Commits for earlier ticks take effect at once, without their
  /// internal values. The first frame sent has the flag `holdover`.
  void join(std::uint32_t tick);

  /// Sets the flags `fault` and `holdover` in the frames to come; other bits are ignored.
  void set_flags(std::uint8_t flags);

  /// Sets the contacts of a local joint as of the coming SYNC, with the bits of the state frame: bits 0-1 are the link
  /// behind the joint, bits 2-3 the link in front of joint 0.
  void set_contacts(unsigned joint, std::uint8_t contacts);

  /// Sets what the module of a local joint measured at the SYNC before the coming one. Sensors that no slot of the
  /// joint uses are left out.
  void set_readings(unsigned joint, const JointReadings& readings);
  /// The sensors that the slots of a local joint use: bits of JointReadings::Sensor.
  [[nodiscard]] std::uint8_t needed_readings(unsigned joint) const { return joint_memory(joint).needed_readings; }

  /// Computes state tick() + 1 of all local joints.
  void advance();

  /// Takes a frame of another joint, and returns whether it was accepted. A frame that is not labelled with the coming
  /// tick, or does not hold a valid state, is ignored and so counted as missed.
  bool receive(unsigned joint, unsigned channel, const StateFrame& frame);

  /// The coming tick: number of times that advance() was called since the reset.
  [[nodiscard]] std::uint32_t tick() const { return tick_; }
  [[nodiscard]] const KernelConfiguration& configuration() const { return configuration_; }
  [[nodiscard]] unsigned first_joint() const { return first_joint_; }
  [[nodiscard]] unsigned local_joint_count() const { return static_cast<unsigned>(memory_.size()); }
  [[nodiscard]] bool is_local(unsigned joint) const {
    return joint >= first_joint_ && joint - first_joint_ < memory_.size();
  }

  // Values of a local joint that can be read.
  /// out(tick()), towards which the servo moves until the coming SYNC.
  [[nodiscard]] std::int32_t setpoint(unsigned joint) const { return joint_memory(joint).setpoint; }
  /// out(tick() - 1), from which the servo moves.
  [[nodiscard]] std::int32_t previous_setpoint(unsigned joint) const { return joint_memory(joint).previous_setpoint; }
  [[nodiscard]] bool drives(unsigned slot, unsigned joint) const;
  [[nodiscard]] std::int32_t parameter(unsigned slot, unsigned joint, unsigned parameter) const;
  [[nodiscard]] std::int32_t internal_value(unsigned slot, unsigned joint, unsigned internal_value) const;
  /// Whether a local joint depends on this state frame of another joint: the other one is next to it in a slot, or a
  /// slot senses contacts. Other frames need not be received.
  [[nodiscard]] bool needs_frame(unsigned joint, unsigned channel) const {
    return needed_[channel].contains(joint) && !is_local(joint);
  }
  /// Number of state frames that a joint sends in a tick: 1 or 2.
  [[nodiscard]] unsigned channel_count(unsigned joint) const { return senders_[1].contains(joint) ? 2 : 1; }
  /// The frame of a local joint labelled tick(), or the last one received from another joint.
  [[nodiscard]] const StateFrame& frame(unsigned joint, unsigned channel) const { return frames_[channel][joint]; }

  /// Number of needed state frames of other joints that were missing when their tick was computed, since the reset.
  [[nodiscard]] std::uint32_t missed_frames() const { return missed_frames_; }

 private:
  friend class KernelSnapshot;  // it belongs to the tests

  [[nodiscard]] JointMemory& joint_memory(unsigned joint) { return memory_[joint - first_joint_]; }
  [[nodiscard]] const JointMemory& joint_memory(unsigned joint) const { return memory_[joint - first_joint_]; }
  [[nodiscard]] Tuning tuning(const SlotMemory& slot) const { return {slot.parameters.data(), slot.derived.data()}; }
  [[nodiscard]] std::array<std::int32_t, max_internal_values>& current(SlotMemory& slot) const {
    return slot.values[tick_ & 1U];
  }
  [[nodiscard]] const std::array<std::int32_t, max_internal_values>& current(const SlotMemory& slot) const {
    return slot.values[tick_ & 1U];
  }

  void set_up(unsigned joint);
  void note_needed_frames(unsigned slot, unsigned joint);
  [[nodiscard]] Neighbour neighbour(unsigned slot, int joint) const;
  void derive(unsigned slot, SlotMemory& memory);
  Status check_slot(unsigned slot, unsigned joint) const;
  Status check_parameter(unsigned slot, unsigned joint, unsigned parameter, std::int32_t value) const;
  void apply_commits();
  void rejoin();
  void fill_missed_frames();
  void compute_next_state(JointMemory& joint);
  void update_setpoint(JointMemory& joint);
  void pack_frames(unsigned joint);

  std::span<JointMemory> memory_;
  KernelConfiguration configuration_;
  unsigned first_joint_ = 0;
  unsigned slots_in_use_ = 0;  ///< the slots from here on are empty
  std::uint32_t tick_ = 0;
  std::uint32_t missed_frames_ = 0;
  bool joining_ = false;
  std::uint8_t flags_ = 0;
  std::array<JointMask, max_channels> senders_;  ///< all joints on the first channel, some on the second
  /// For each slot, the joints that send its state on the second channel.
  std::array<JointMask, max_slots> second_channel_;
  std::array<JointMask, max_channels> needed_;   ///< joints whose frames a local joint depends on
  std::array<JointMask, max_channels> arrived_;  ///< joints whose frames with the label tick_ are in frames_
  Staging staging_;
  std::array<std::array<StateFrame, max_joints>, max_channels> frames_;
  /// For each slot, the joints of other modules that are next to a local one.
  std::array<JointMask, max_slots> beside_;
};

/// A kernel with memory for its joints.
template <std::size_t LocalJoints>
class KernelOf : private std::array<JointMemory, LocalJoints>, public Kernel {
 public:
  KernelOf()
      : std::array<JointMemory, LocalJoints>{}, Kernel(static_cast<std::array<JointMemory, LocalJoints>&>(*this)) {}
};

}  // namespace proleg
