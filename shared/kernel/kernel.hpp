#pragma once

// The control kernel (thesis, section 4.3.1 and algorithm 1): up to four slots, each an actuation module on a group of
// joints; groups may overlap, outputs are added joint by joint. The same code runs one joint (in a module) or all
// joints (in the simulator); joints learn of each other only through state frames.
//
// Order of a tick k, at SYNC k: set_contacts, then advance(): commits due at k take effect, every local joint computes
// state k + 1 from the frames labelled k, then the frames labelled k + 1 are packed and may be sent. Frames of other
// joints labelled k + 1 are handed to receive() before SYNC k + 1.
//
// Changes in flight come in two phases: values are staged under a transaction number, then the transaction is committed
// at a tick. One transaction is open at a time; committed ones wait, in the order of their commits, for their ticks.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "shared/gait/actuation_module.hpp"
#include "shared/kernel/status.hpp"

namespace proleg {

inline constexpr std::size_t max_slots = 4;
/// State frames a joint sends in a tick: the first broadcasting slot of the joint and the second.
inline constexpr std::size_t max_channels = 2;

/// An actuation module on a group of joints.
struct Slot {
  const ActuationModule* algorithm = nullptr;  ///< null: the slot is empty
  JointMask group;

  /// Whether neighbours learn of the algorithm's state.
  [[nodiscard]] bool broadcasts() const { return algorithm != nullptr && !algorithm->declaration().frame.empty(); }
  /// 0 if the slot is empty.
  [[nodiscard]] std::uint8_t algorithm_id() const {
    return algorithm == nullptr ? std::uint8_t{0} : algorithm->declaration().id;
  }
  /// None if the slot is empty, whatever the group is.
  [[nodiscard]] JointMask driven_joints() const { return algorithm == nullptr ? JointMask() : group; }
};

/// What all modules of a robot agree on.
struct KernelConfiguration {
  std::uint8_t joint_count = 0;
  std::uint32_t tick_period_us = 10'000;
  std::uint64_t seed = 1;  ///< of the noise at reset
  std::array<Slot, max_slots> slots;

  /// Joints whose state in this slot travels in their second frame, because an earlier slot of theirs broadcasts.
  [[nodiscard]] JointMask second_channel(unsigned slot) const;
  /// Joints that send two state frames in a tick.
  [[nodiscard]] JointMask second_channel_senders() const;
};

/// Transactions that wait for their tick at the same time, and one that is open. A ramp is a row of them, each sent 20
/// ticks ahead.
inline constexpr std::size_t max_transactions = 32;
/// Values of one joint that are staged at the same time, over all transactions.
inline constexpr std::size_t max_staged_values = 64;

/// A change of one value of a joint, waiting for its transaction.
struct StagedValue {
  std::int32_t value;
  std::uint8_t transaction;  ///< place in the kernel's list
  std::uint8_t slot;
  std::uint8_t number;  ///< of the parameter or internal value
  bool internal;
};

/// What the kernel keeps for a slot on a joint.
struct SlotMemory {
  JointContext context;
  Neighbour ahead;
  Neighbour behind;
  std::array<std::int32_t, max_parameters> parameters;
  std::array<std::int32_t, max_derived> derived;
  std::array<std::array<std::int32_t, max_internal_values>, 2> values;  ///< two buffers, never in place
  const Declaration* broadcast;  ///< what the slot sends; null if it sends nothing
  std::uint8_t channel;
  bool active;
  std::uint8_t sensed_joints;  ///< whose contacts the algorithm is given: all joints, or none
};

/// What the kernel keeps for a joint.
struct JointMemory {
  std::array<SlotMemory, max_slots> slots;
  std::array<StagedValue, max_staged_values> staged;
  std::uint8_t staged_count;
  std::int32_t lower_limit;
  std::int32_t upper_limit;
  std::int32_t previous_setpoint;
  std::int32_t setpoint;
  std::uint8_t contacts;
  bool limited;
};

class Kernel {
 public:
  /// memory: one element for each joint that the kernel computes; it must outlive the kernel.
  explicit Kernel(std::span<JointMemory> memory) : memory_(memory) {}
  Kernel(const Kernel&) = delete;
  Kernel& operator=(const Kernel&) = delete;

  /// Takes a configuration, sets all parameters to their defaults and all limits to +-90 degrees, forgets what was
  /// staged, and resets.
  /// The kernel computes the joints first_joint .. first_joint + size of the memory - 1.
  Status configure(const KernelConfiguration& configuration, unsigned first_joint);

  /// The sum of the slots is cut to these limits (90 degrees = 2^30).
  Status set_limits(unsigned joint, std::int32_t lower, std::int32_t upper);

  /// Sets a parameter at once, for use before the first tick; reset() makes the start state follow.
  Status set_parameter(unsigned slot, unsigned joint, unsigned parameter, std::int32_t value);

  /// Back to tick 0 and state 0. Parameters and what is staged stay.
  void reset();

  /// Opens a transaction under which values can be staged, even if there is none for the local joints. What was staged
  /// under another number that is not committed is dropped; opening the open one again changes nothing.
  Status open(std::uint16_t transaction);
  /// A parameter, in force from the commit's tick on.
  Status stage(std::uint16_t transaction, unsigned slot, unsigned joint, unsigned parameter, std::int32_t value);
  /// An internal value (thesis listing A.2, setDistortion), overwritten before the commit's tick is computed;
  /// neighbours see it one tick later.
  Status stage_internal(std::uint16_t transaction, unsigned slot, unsigned joint, unsigned internal_value,
                        std::int32_t value);
  /// For a tick that is not computed yet. Repeating a commit, also the last one that took effect, is ok.
  Status commit(std::uint16_t transaction, std::uint32_t tick);
  /// The transaction that is open, if one is, and the number of values staged under it.
  [[nodiscard]] bool has_open_transaction() const { return has_open_; }
  [[nodiscard]] std::uint16_t open_transaction() const { return open_; }
  [[nodiscard]] unsigned staged_count() const;
  /// A staged parameter or internal value of the open transaction; false if there is none.
  [[nodiscard]] bool staged_value(unsigned slot, unsigned joint, unsigned number, bool internal,
                                  std::int32_t& value) const;

  /// Takes a place in a robot that moves already: tick() becomes `tick`, and the coming advance() starts from a state
  /// that it makes from the neighbours' frames labelled `tick` (approximately, but for the plain sine, which is a
  /// function of the tick). Parameters of commits for earlier ticks are in force at once, internal values of theirs are
  /// dropped. The first frame sent has the flag `holdover`.
  void join(std::uint32_t tick);

  /// Sets the flags `fault` and `holdover` in the frames to come; other bits are ignored.
  void set_flags(std::uint8_t flags);

  /// Contacts of a local joint as of the coming SYNC: bits 0-1 the link behind the joint, bits 2-3 the link before
  /// joint 0, as in the state frame.
  void set_contacts(unsigned joint, std::uint8_t contacts);

  /// Computes state tick() + 1 of all local joints.
  void advance();

  /// A frame of another joint. Ignored, and so counted as missed, unless it is labelled with the coming tick and holds
  /// a valid state.
  /// Returns whether it was taken.
  bool receive(unsigned joint, unsigned channel, const StateFrame& frame);

  /// The coming tick: number of times that advance() was called since the reset.
  [[nodiscard]] std::uint32_t tick() const { return tick_; }
  [[nodiscard]] const KernelConfiguration& configuration() const { return configuration_; }
  [[nodiscard]] unsigned first_joint() const { return first_joint_; }
  [[nodiscard]] unsigned local_joint_count() const { return static_cast<unsigned>(memory_.size()); }
  [[nodiscard]] bool is_local(unsigned joint) const {
    return joint >= first_joint_ && joint - first_joint_ < memory_.size();
  }

  // Readings of a local joint.
  /// out(tick()), towards which the servo moves until the coming SYNC.
  [[nodiscard]] std::int32_t setpoint(unsigned joint) const { return joint_memory(joint).setpoint; }
  /// out(tick() - 1), from which it moves.
  [[nodiscard]] std::int32_t previous_setpoint(unsigned joint) const { return joint_memory(joint).previous_setpoint; }
  [[nodiscard]] bool drives(unsigned slot, unsigned joint) const;
  [[nodiscard]] std::int32_t parameter(unsigned slot, unsigned joint, unsigned parameter) const;
  [[nodiscard]] std::int32_t internal_value(unsigned slot, unsigned joint, unsigned internal_value) const;
  /// Whether what a local joint does depends on this state frame of another one: that of the next joint in a slot, or
  /// of any joint if a slot senses contacts. Others need not be received.
  [[nodiscard]] bool needs_frame(unsigned joint, unsigned channel) const {
    return needed_[channel].contains(joint) && !is_local(joint);
  }
  /// Number of state frames that a joint sends in a tick: 1 or 2.
  [[nodiscard]] unsigned channel_count(unsigned joint) const { return senders_[1].contains(joint) ? 2 : 1; }
  /// The frame of a local joint labelled tick(), or the latest known of another joint.
  [[nodiscard]] const StateFrame& frame(unsigned joint, unsigned channel) const { return frames_[channel][joint]; }

  /// State frames of other joints that had not come when their tick was computed, since the reset.
  [[nodiscard]] std::uint32_t missed_frames() const { return missed_frames_; }

  /// The whole state, parameters included, in a byte order and layout that is the same everywhere. A kernel with the
  /// same configuration and the same local joints continues from it bit for bit.
  [[nodiscard]] std::size_t snapshot_size() const;
  Status save(std::span<std::uint8_t> snapshot) const;
  Status restore(std::span<const std::uint8_t> snapshot);

 private:
  struct Commit {
    std::uint16_t transaction;
    std::uint32_t tick;
  };

  template <typename Self, typename Archive>
  static void visit_state(Self& self, Archive& archive);
  template <typename Self, typename Archive>
  static void visit_staged(Self& self, JointMemory& joint, Archive& archive);
  [[nodiscard]] bool is_stageable(const JointMemory& joint, const StagedValue& staged) const;

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
  Status add_staged(std::uint16_t transaction, unsigned joint, const StagedValue& value);
  [[nodiscard]] bool is_committed(std::uint16_t transaction) const;
  void drop_open_transaction();
  void apply_commits();
  void take_effect(unsigned place, bool with_internal_values);
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
  /// Committed transactions in the order of their commits, then, if has_open_, the open one.
  std::array<Commit, max_transactions> transactions_{};
  std::uint8_t committed_count_ = 0;
  bool has_open_ = false;
  std::uint16_t open_ = 0;
  Commit last_effective_{};  ///< so that its repeats are recognised
  bool has_last_effective_ = false;
  bool joining_ = false;
  std::uint8_t flags_ = 0;
  std::array<JointMask, max_channels> senders_;  ///< all joints on the first channel, some on the second
  /// For each slot the joints of which it uses the second channel.
  std::array<JointMask, max_slots> second_channel_;
  std::array<JointMask, max_channels> needed_;   ///< joints on whose frames a local joint depends
  std::array<JointMask, max_channels> arrived_;  ///< whose frames with the label tick_ are in frames_
  std::array<std::array<StateFrame, max_joints>, max_channels> frames_;
  /// For each slot the joints of other modules that are next to a local one.
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
