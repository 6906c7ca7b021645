#pragma once

// What the module of a joint reads of its sensors: the touch sensors, and the inclination and acceleration of its link.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "shared/gait/joint_readings.hpp"
#include "sim/scenario/scenario.hpp"
#include "sim/sensor/attached_sensors.hpp"

namespace proleg::sim {

// The module of a joint has the touch sensors of the link behind it, and the head's module those of link 0 as well.
// link_contacts: per link, bit 0 rear, bit 1 front. Contacts of a joint: bits 0 to 3 as in the state frame's flags.

/// The contacts of a joint.
[[nodiscard]] inline std::uint8_t joint_contacts(std::span<const std::uint8_t> link_contacts, std::size_t joint) {
  const unsigned behind = link_contacts[joint + 1];
  const unsigned head = joint == 0 ? unsigned{link_contacts[0]} << 2U : 0U;
  return static_cast<std::uint8_t>(behind | head);
}

/// The reverse: writes the contacts of a joint to its links. Other bits of `contacts` are ignored.
inline void write_link_contacts(std::span<std::uint8_t> link_contacts, std::size_t joint, unsigned contacts) {
  link_contacts[joint + 1] = contacts & StateFrame::rear_link_contact_bits;
  if (joint == 0) {
    link_contacts[0] = static_cast<std::uint8_t>((contacts & StateFrame::contact_bits) >> 2U);
  }
}

/// The touch sensors of all joints, debounced at each SYNC as the modules do it.
class TouchInputs {
 public:
  explicit TouchInputs(std::size_t joints) : debouncers_(joints), contacts_(joints) {}

  /// Samples the sensors of a joint's link at SYNC. Returns its debounced contacts.
  std::uint8_t sample(std::span<const std::uint8_t> link_contacts, std::size_t joint) {
    contacts_[joint] = debouncers_[joint].sample(joint_contacts(link_contacts, joint));
    return contacts_[joint];
  }
  /// The module of the joint restarts.
  void reset(std::size_t joint) {
    debouncers_[joint].reset();
    contacts_[joint] = 0;
  }

  /// Writes the latched contacts by link, as recordings have them.
  void write_links(std::span<std::uint8_t> link_contacts) const {
    for (std::size_t joint = 0; joint < contacts_.size(); ++joint) {
      write_link_contacts(link_contacts, joint, contacts_[joint]);
    }
  }

  /// The last sample, by joint.
  [[nodiscard]] std::span<const std::uint8_t> contacts() const { return contacts_; }

 private:
  std::vector<ContactDebouncer> debouncers_;
  std::vector<std::uint8_t> contacts_;
};

/// Inclination and acceleration of the link behind each joint, for algorithms that read them. No cost without such an
/// algorithm.
class ModuleReadings {
 public:
  /// world: in which the robot is.
  ModuleReadings(const Scenario& scenario, World& world);

  void add_step(const World& world) { sensors_.add_step(world); }
  void finish_tick(const World& world, std::span<const Pose> link_poses) {
    sensors_.finish_tick(world, link_poses, {});
  }
  void rest_at(std::span<const Pose> link_poses) { sensors_.rest_at(link_poses); }

  /// The readings of the last tick. servo: of the joint. Absent are those that no algorithm of the scenario reads.
  [[nodiscard]] JointReadings of(std::size_t joint, const ServoReadings& servo) const;

 private:
  std::uint8_t needed_;  ///< bits of JointReadings::Sensor
  std::vector<AttachedSensor> models_;
  AttachedSensors sensors_;
};

}  // namespace proleg::sim
