#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "shared/gait/contact_debouncer.hpp"

namespace proleg::sim {

/// The touch sensors that are wired to the module of a joint, as bits 0 to 3 of the state frame's flags: those of the
/// link behind it, and for the head module those of link 0. link_contacts: per link, bit 0 rear, bit 1 front.
[[nodiscard]] inline std::uint8_t wired_sensors(std::span<const std::uint8_t> link_contacts, std::size_t joint) {
  const unsigned behind = link_contacts[joint + 1];
  const unsigned far = joint == 0 ? unsigned{link_contacts[0]} << 2U : 0U;
  return static_cast<std::uint8_t>(behind | far);
}

/// What the modules make of their touch sensors at each SYNC.
class TouchInputs {
 public:
  explicit TouchInputs(std::size_t joints) : debouncers_(joints), contacts_(joints) {}

  /// At SYNC: the debounced contacts of a joint.
  std::uint8_t sample(std::span<const std::uint8_t> link_contacts, std::size_t joint) {
    contacts_[joint] = debouncers_[joint].sample(wired_sensors(link_contacts, joint));
    return contacts_[joint];
  }
  /// The module of the joint restarts.
  void reset(std::size_t joint) {
    debouncers_[joint].reset();
    contacts_[joint] = 0;
  }

  /// The same by links, as recordings have it.
  void write_links(std::span<std::uint8_t> link_contacts) const {
    for (std::size_t joint = 0; joint < contacts_.size(); ++joint) {
      link_contacts[joint + 1] = contacts_[joint] & StateFrame::rear_link_contact_bits;
    }
    link_contacts[0] = static_cast<std::uint8_t>(contacts_[0] >> 2U);
  }

  /// Of each joint, as sampled last.
  [[nodiscard]] std::span<const std::uint8_t> contacts() const { return contacts_; }

 private:
  std::vector<ContactDebouncer> debouncers_;
  std::vector<std::uint8_t> contacts_;
};

}  // namespace proleg::sim
