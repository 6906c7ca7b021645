#pragma once

// The interface of all actuation algorithms (thesis, section 5.2 and listing A.1, adapted to one joint on one module).
// An algorithm is a constant object without state: parameters, derived constants and internal values are plain int32_t
// arrays that the control kernel owns. So the kernel can read, change, log, distort and copy them without code in the
// algorithm.

#include <array>
#include <cstdint>
#include <span>

#include "shared/fixed/random.hpp"
#include "shared/gait/declaration.hpp"
#include "shared/gait/joint_mask.hpp"
#include "shared/gait/joint_readings.hpp"
#include "shared/gait/state_frame.hpp"

namespace proleg {

/// The two touch sensors under each link.
enum class TouchSensor : std::uint8_t {
  rear,   ///< nearer to the tail
  front,  ///< nearer to the head
};

/// The contacts of all links at one tick, as the joints' state frames report them. Link 0 is the head; link j + 1 lies
/// behind joint j. A link is not pressed until the first frame of its joint is received.
class Contacts {
 public:
  /// frames: the latest state frame of every joint, in kernel order. If it is empty, nothing is pressed.
  explicit Contacts(std::span<const StateFrame> frames) : frames_(frames) {}

  [[nodiscard]] unsigned link_count() const { return static_cast<unsigned>(frames_.size()) + 1; }

  [[nodiscard]] bool pressed(unsigned link, TouchSensor sensor) const {
    return ((sensors(link) >> static_cast<unsigned>(sensor)) & 1U) != 0;
  }

  /// Whether either sensor of the link is pressed.
  [[nodiscard]] bool pressed(unsigned link) const { return sensors(link) != 0; }

 private:
  /// Bit n for TouchSensor n.
  [[nodiscard]] unsigned sensors(unsigned link) const {
    if (link >= link_count() || frames_.empty()) {
      return 0;
    }
    const unsigned flags = link == 0 ? frames_.front().flags() >> 2U : frames_[link - 1].flags();
    return flags & 3U;
  }

  std::span<const StateFrame> frames_;
};

/// The joint that an algorithm computes, and its robot.
struct JointContext {
  std::uint8_t joint;        ///< kernel order: 0 is at the head
  std::uint8_t joint_count;  ///< number of joints of the whole robot
  JointMask group;           ///< joints that the slot drives
  std::uint32_t tick_period_us;
};

/// Constants of a slot on a joint between two commits.
struct Tuning {
  const std::int32_t* parameters;  ///< in the order of the declaration
  const std::int32_t* derived;     ///< what `derive` computed from them
};

/// The state frame of a neighbour at tick k.
class Neighbour {
 public:
  Neighbour() = default;
  Neighbour(const Declaration& declaration, unsigned joint, const StateFrame& frame)
      : declaration_(&declaration), frame_(&frame), joint_(joint) {}

  /// Whether the neighbour's state is known: not at the ends of the group, and not until its first frame is received.
  [[nodiscard]] bool present() const { return frame_ != nullptr && (frame_->flags() & StateFrame::valid) != 0; }
  [[nodiscard]] unsigned joint() const { return joint_; }
  /// A field of the declared frame; present() must hold.
  [[nodiscard]] std::int32_t value(std::size_t field) const { return unpack(*declaration_, field, *frame_); }

 private:
  const Declaration* declaration_ = nullptr;
  const StateFrame* frame_ = nullptr;
  unsigned joint_ = 0;
};

/// The inputs of a joint at SYNC k. All of them are of tick k.
struct Surroundings {
  std::uint32_t tick;  ///< k; the step leads to state k + 1
  const JointContext& context;
  const Neighbour& ahead;   ///< nearest joint of the group towards the head
  const Neighbour& behind;  ///< nearest joint of the group towards the tail
  const Contacts& contacts;
  std::int32_t setpoint;  ///< set-point of the joint: the sum of all slots in state k, within the joint's limits
  const JointReadings& readings;  ///< readings of the joint's own module; only those that senses_readings() names
};

/// The basic interface: an algorithm that gives one joint an angle.
class ActuationModule {
 public:
  constexpr ActuationModule() = default;
  ActuationModule(const ActuationModule&) = delete;
  ActuationModule& operator=(const ActuationModule&) = delete;

  [[nodiscard]] virtual const Declaration& declaration() const = 0;

  /// Whether the algorithm reads the contacts of links. If not, every computer shows it no contact, so a module need
  /// not receive the frames of joints that the algorithm does not depend on.
  [[nodiscard]] virtual bool senses_contacts() const { return false; }

  /// The readings of its module that the algorithm uses: bits of JointReadings::Sensor. The others are absent on every
  /// computer. A host refuses to drive modules that do not have them.
  [[nodiscard]] virtual std::uint8_t senses_readings() const { return 0; }

  /// Computes constants from the parameters. Called after each change of a parameter, never in a tick without one.
  virtual void derive(const JointContext& context, const std::int32_t* parameters, std::int32_t* derived) const;

  /// Writes state 0, whose values are all 0 before. `noise` is seeded by the robot's seed and the joint.
  virtual void reset(const JointContext& context, const Tuning& tuning, Pcg32& noise, std::int32_t* state) const;

  /// Estimates state k for a joint that joins a moving robot. `surroundings` hold the neighbours' frames of tick k,
  /// `state` holds what reset() has written. The default changes nothing.
  virtual void rejoin(const Surroundings& surroundings, const Tuning& tuning, std::int32_t* state) const;

  /// Computes state k + 1 from state k and the received frames. `state` and `next` never overlap.
  virtual void advance(const Surroundings& surroundings, const Tuning& tuning, const std::int32_t* state,
                       std::int32_t* next) const = 0;

  /// The joint angle of a state (90 degrees = 2^30).
  [[nodiscard]] virtual std::int32_t output(const Tuning& tuning, const std::int32_t* state) const = 0;

  /// Turns the last state frame of a neighbour into the one expected a tick later. It is called when a frame was
  /// missed. `state` is the joint's own. The default changes nothing.
  virtual void extrapolate(const Tuning& tuning, const std::int32_t* state, StateFrame& frame) const;

 protected:
  ~ActuationModule() = default;  // algorithms are static objects, never deleted through the interface
};

inline void ActuationModule::derive(const JointContext& /*context*/, const std::int32_t* /*parameters*/,
                                    std::int32_t* /*derived*/) const {}
inline void ActuationModule::reset(const JointContext& /*context*/, const Tuning& /*tuning*/, Pcg32& /*noise*/,
                                   std::int32_t* /*state*/) const {}
inline void ActuationModule::rejoin(const Surroundings& /*surroundings*/, const Tuning& /*tuning*/,
                                    std::int32_t* /*state*/) const {}
inline void ActuationModule::extrapolate(const Tuning& /*tuning*/, const std::int32_t* /*state*/,
                                         StateFrame& /*frame*/) const {}

}  // namespace proleg
