#include <type_traits>

#include "shared/kernel/kernel.hpp"

// One list of what makes up the state serves counting, writing, checking and reading. Little-endian, no padding.

namespace proleg {
namespace {

constexpr std::uint32_t snapshot_magic = 0x324B5350;  // "PSK2"

class Counter {
 public:
  template <typename Integer>
  void identity(Integer /*value*/) {
    size_ += sizeof(Integer);
  }
  template <typename Integer>
  void value(const Integer& /*value*/) {
    size_ += sizeof(Integer);
  }
  template <typename Integer>
  void ranged(const Integer& value, std::int32_t /*lowest*/, std::int32_t /*highest*/) {
    this->value(value);
  }

  template <typename Integer>
  void local(const Integer& value) {
    this->value(value);
  }
  void expect(bool /*holds*/) {}
  [[nodiscard]] static bool applies() { return false; }

  [[nodiscard]] std::size_t size() const { return size_; }

 private:
  std::size_t size_ = 0;
};

class Writer {
 public:
  explicit Writer(std::span<std::uint8_t> bytes) : bytes_(bytes) {}

  template <typename Integer>
  void identity(Integer value) {
    for (std::size_t i = 0; i < sizeof(Integer); ++i) {
      bytes_[position_++] = static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> (8 * i));
    }
  }
  template <typename Integer>
  void value(const Integer& value) {
    identity(value);
  }
  template <typename Integer>
  void ranged(const Integer& value, std::int32_t /*lowest*/, std::int32_t /*highest*/) {
    identity(value);
  }
  template <typename Integer>
  void local(const Integer& value) {
    identity(value);
  }
  void expect(bool /*holds*/) {}
  [[nodiscard]] static bool applies() { return false; }

 private:
  std::span<std::uint8_t> bytes_;
  std::size_t position_ = 0;
};

/// Reads a snapshot of the right size; `apply` false only looks whether it fits the kernel.
class Reader {
 public:
  Reader(std::span<const std::uint8_t> bytes, bool apply) : bytes_(bytes), apply_(apply) {}

  template <typename Integer>
  void identity(Integer value) {
    fits_ = take<Integer>() == value && fits_;
  }
  template <typename Integer>
  void value(Integer& value) {
    const auto read = take<Integer>();
    if (apply_) {
      value = read;
    }
  }
  void value(bool& value) {
    const auto read = take<std::uint8_t>();
    fits_ = fits_ && read <= 1;
    if (apply_) {
      value = read == 1;
    }
  }
  template <typename Integer>
  void ranged(Integer& value, std::int32_t lowest, std::int32_t highest) {
    const auto read = take<Integer>();
    fits_ = fits_ && read >= lowest && read <= highest;
    if (apply_) {
      value = read;
    }
  }

  /// Read in both passes, into a copy.
  template <typename Integer>
  void local(Integer& value) {
    value = take<Integer>();
  }
  void expect(bool holds) { fits_ = fits_ && holds; }
  [[nodiscard]] bool applies() const { return apply_; }

  [[nodiscard]] bool fits() const { return fits_; }

 private:
  template <typename Integer>
  Integer take() {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < sizeof(Integer); ++i) {
      value |= std::uint64_t{bytes_[position_++]} << (8 * i);
    }
    return static_cast<Integer>(value);
  }

  std::span<const std::uint8_t> bytes_;
  std::size_t position_ = 0;
  bool apply_;
  bool fits_ = true;
};

}  // namespace

bool Kernel::is_stageable(const JointMemory& joint, const StagedValue& staged) const {
  if (staged.slot >= max_slots || !joint.slots[staged.slot].active) {
    return false;
  }
  const Declaration& declaration = configuration_.slots[staged.slot].algorithm->declaration();
  if (staged.internal) {
    return staged.number < declaration.internal_values.size();
  }
  return staged.number < declaration.parameters.size() &&
         staged.value >= declaration.parameters[staged.number].minimum &&
         staged.value <= declaration.parameters[staged.number].maximum;
}

/// Of the same size whatever is staged: places that are not in use are 0.
template <typename Self, typename Archive>
void Kernel::visit_staged(Self& self, JointMemory& joint, Archive& archive) {
  std::uint8_t count = joint.staged_count;
  archive.local(count);
  archive.expect(count <= max_staged_values);
  for (std::size_t i = 0; i < max_staged_values; ++i) {
    StagedValue staged = i < joint.staged_count ? joint.staged[i] : StagedValue{};
    auto internal = static_cast<std::uint8_t>(staged.internal ? 1 : 0);
    archive.local(staged.value);
    archive.local(staged.transaction);
    archive.local(staged.slot);
    archive.local(staged.number);
    archive.local(internal);
    staged.internal = internal != 0;
    archive.expect(i >= count || (internal <= 1 && self.is_stageable(joint, staged)));
    if (archive.applies()) {
      joint.staged[i] = staged;
    }
  }
  if (archive.applies()) {
    joint.staged_count = count;
  }
}

template <typename Self, typename Archive>
void Kernel::visit_state(Self& self, Archive& archive) {
  archive.identity(snapshot_magic);
  archive.identity(self.configuration_.joint_count);
  archive.identity(self.configuration_.tick_period_us);
  archive.identity(static_cast<std::uint8_t>(self.first_joint_));
  archive.identity(static_cast<std::uint8_t>(self.memory_.size()));
  for (const Slot& slot : self.configuration_.slots) {
    archive.identity(slot.algorithm == nullptr ? std::uint8_t{0} : slot.algorithm->declaration().id);
    archive.identity(slot.group.bits());
  }

  archive.value(self.tick_);
  archive.value(self.missed_frames_);
  archive.ranged(self.committed_count_, 0, static_cast<std::int32_t>(max_transactions));
  for (auto& commit : self.transactions_) {
    archive.value(commit.transaction);
    archive.value(commit.tick);
  }
  archive.value(self.has_open_);
  archive.value(self.open_);
  archive.value(self.joining_);
  archive.value(self.flags_);
  for (JointMemory& joint : self.memory_) {
    archive.value(joint.lower_limit);
    archive.value(joint.upper_limit);
    archive.value(joint.previous_setpoint);
    archive.value(joint.setpoint);
    archive.value(joint.contacts);
    archive.value(joint.limited);
    visit_staged(self, joint, archive);
    for (unsigned s = 0; s < max_slots; ++s) {
      SlotMemory& slot = joint.slots[s];
      if (!slot.active) {
        continue;
      }
      const Declaration& declaration = self.configuration_.slots[s].algorithm->declaration();
      for (std::size_t p = 0; p < declaration.parameters.size(); ++p) {
        const Parameter& parameter = declaration.parameters[p];
        archive.ranged(slot.parameters[p], parameter.minimum, parameter.maximum);
      }
      for (std::size_t v = 0; v < declaration.internal_values.size(); ++v) {
        archive.value(self.current(slot)[v]);
      }
    }
  }
  for (unsigned channel = 0; channel < max_channels; ++channel) {
    std::uint64_t arrived = self.arrived_[channel].bits();
    archive.value(arrived);
    if constexpr (!std::is_const_v<Self>) {
      self.arrived_[channel] = JointMask(arrived);
    }
    for (unsigned joint = 0; joint < self.configuration_.joint_count; ++joint) {
      for (auto& byte : self.frames_[channel][joint].bytes) {
        archive.value(byte);
      }
    }
  }
}

std::size_t Kernel::snapshot_size() const {
  Counter counter;
  visit_state(*this, counter);
  return counter.size();
}

Status Kernel::save(std::span<std::uint8_t> snapshot) const {
  if (snapshot.size() < snapshot_size()) {
    return Status::no_room;
  }
  Writer writer(snapshot);
  visit_state(*this, writer);
  return Status::ok;
}

Status Kernel::restore(std::span<const std::uint8_t> snapshot) {
  if (snapshot.size() != snapshot_size()) {
    return Status::bad_snapshot;
  }
  Reader check(snapshot, false);
  visit_state(*this, check);
  if (!check.fits()) {
    return Status::bad_snapshot;
  }
  Reader reader(snapshot, true);
  visit_state(*this, reader);
  for (JointMemory& joint : memory_) {
    for (unsigned s = 0; s < max_slots; ++s) {
      if (joint.slots[s].active) {
        derive(s, joint.slots[s]);
      }
    }
  }
  return Status::ok;
}

}  // namespace proleg
