#include "kernel_snapshot.hpp"

#include <type_traits>

// Writing, checking and reading use the same list of the values in the state. They are little-endian, without padding.

namespace proleg {
namespace {

constexpr std::uint32_t snapshot_magic = 0x324B5350;  // "PSK2"

class Writer {
 public:
  template <typename Integer>
  void identity(Integer value) {
    for (std::size_t i = 0; i < sizeof(Integer); ++i) {
      bytes_.push_back(static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> (8 * i)));
    }
  }
  template <typename Integer>
  void value(const Integer& value) {
    identity(value);
  }
  template <typename Integer>
  void ranged(const Integer& value, std::int32_t /*minimum*/, std::int32_t /*maximum*/) {
    identity(value);
  }
  template <typename Integer>
  void local(const Integer& value) {
    identity(value);
  }
  void expect(bool /*holds*/) {}
  [[nodiscard]] static bool applies() { return false; }

  [[nodiscard]] const std::vector<std::uint8_t>& bytes() const { return bytes_; }

 private:
  std::vector<std::uint8_t> bytes_;
};

/// Reads a snapshot. With `apply` false it only checks whether the snapshot fits the kernel.
class Reader {
 public:
  Reader(std::span<const std::uint8_t> bytes, bool apply) : bytes_(bytes), apply_(apply) {}

  template <typename Integer>
  void identity(Integer value) {
    expect(read<Integer>() == value);
  }
  template <typename Integer>
  void value(Integer& value) {
    const auto found = read<Integer>();
    if (apply_) {
      value = found;
    }
  }
  void value(bool& value) {
    const auto found = read<std::uint8_t>();
    expect(found <= 1);
    if (apply_) {
      value = found == 1;
    }
  }
  template <typename Integer>
  void ranged(Integer& value, std::int32_t minimum, std::int32_t maximum) {
    const auto found = read<Integer>();
    expect(found >= minimum && found <= maximum);
    if (apply_) {
      value = found;
    }
  }

  /// The value is read in both passes, into a copy.
  template <typename Integer>
  void local(Integer& value) {
    value = read<Integer>();
  }
  void expect(bool holds) { fits_ = fits_ && holds; }
  [[nodiscard]] bool applies() const { return apply_; }

  [[nodiscard]] bool fits() const { return fits_ && position_ == bytes_.size(); }

 private:
  template <typename Integer>
  Integer read() {
    if (bytes_.size() - position_ < sizeof(Integer)) {
      fits_ = false;
      return {};
    }
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

bool KernelSnapshot::is_stageable(const Kernel& kernel, const JointMemory& joint, const StagedValue& staged) {
  if (staged.slot >= max_slots || !joint.slots[staged.slot].active) {
    return false;
  }
  const Declaration& declaration = kernel.configuration_.slots[staged.slot].algorithm->declaration();
  if (staged.internal) {
    return staged.number < declaration.internal_values.size();
  }
  return staged.number < declaration.parameters.size() &&
         staged.value >= declaration.parameters[staged.number].minimum &&
         staged.value <= declaration.parameters[staged.number].maximum;
}

/// The size does not depend on the number of staged values: unused elements are 0.
template <typename AnyKernel, typename Archive>
void KernelSnapshot::visit_staged(AnyKernel& kernel, JointMemory& joint, Archive& archive) {
  std::uint8_t count = joint.staged.count;
  archive.local(count);
  archive.expect(count <= max_staged_values);
  for (std::size_t i = 0; i < max_staged_values; ++i) {
    StagedValue staged = i < joint.staged.count ? joint.staged.values[i] : StagedValue{};
    auto internal = static_cast<std::uint8_t>(staged.internal ? 1 : 0);
    archive.local(staged.value);
    archive.local(staged.transaction);
    archive.local(staged.slot);
    archive.local(staged.number);
    archive.local(internal);
    staged.internal = internal != 0;
    archive.expect(i >= count || (internal <= 1 && is_stageable(kernel, joint, staged)));
    if (archive.applies()) {
      joint.staged.values[i] = staged;
    }
  }
  if (archive.applies()) {
    joint.staged.count = count;
  }
}

template <typename AnyStaging, typename Archive>
void KernelSnapshot::visit_transactions(AnyStaging& staging, Archive& archive) {
  archive.ranged(staging.committed_count_, 0, static_cast<std::int32_t>(max_transactions) - 1);
  for (auto& commit : staging.transactions_) {
    archive.value(commit.transaction);
    archive.value(commit.tick);
  }
  archive.value(staging.has_open_);
  archive.value(staging.open_);
}

template <typename AnyKernel, typename Archive>
void KernelSnapshot::visit_state(AnyKernel& kernel, Archive& archive) {
  archive.identity(snapshot_magic);
  archive.identity(kernel.configuration_.joint_count);
  archive.identity(kernel.configuration_.tick_period_us);
  archive.identity(static_cast<std::uint8_t>(kernel.first_joint_));
  archive.identity(static_cast<std::uint8_t>(kernel.memory_.size()));
  for (const Slot& slot : kernel.configuration_.slots) {
    archive.identity(slot.algorithm_id());
    archive.identity(slot.group.bits());
  }

  archive.value(kernel.tick_);
  archive.value(kernel.missed_frames_);
  visit_transactions(kernel.staging_, archive);
  archive.value(kernel.joining_);
  archive.value(kernel.flags_);
  for (JointMemory& joint : kernel.memory_) {
    archive.value(joint.lower_limit);
    archive.value(joint.upper_limit);
    archive.value(joint.previous_setpoint);
    archive.value(joint.setpoint);
    archive.value(joint.contacts);
    archive.value(joint.readings.present);
    archive.value(joint.readings.current_ma);
    archive.value(joint.readings.pitch);
    archive.value(joint.readings.roll);
    archive.value(joint.readings.angle);
    for (auto& axis : joint.readings.acceleration_mm_s2) {
      archive.value(axis);
    }
    archive.value(joint.limited);
    visit_staged(kernel, joint, archive);
    for (unsigned s = 0; s < max_slots; ++s) {
      SlotMemory& slot = joint.slots[s];
      if (!slot.active) {
        continue;
      }
      const Declaration& declaration = kernel.configuration_.slots[s].algorithm->declaration();
      for (std::size_t p = 0; p < declaration.parameters.size(); ++p) {
        const Parameter& parameter = declaration.parameters[p];
        archive.ranged(slot.parameters[p], parameter.minimum, parameter.maximum);
      }
      for (std::size_t v = 0; v < declaration.internal_values.size(); ++v) {
        archive.value(kernel.current(slot)[v]);
      }
    }
  }
  for (unsigned channel = 0; channel < max_channels; ++channel) {
    std::uint64_t arrived = kernel.arrived_[channel].bits();
    archive.value(arrived);
    if constexpr (!std::is_const_v<AnyKernel>) {
      kernel.arrived_[channel] = JointMask(arrived);
    }
    for (unsigned joint = 0; joint < kernel.configuration_.joint_count; ++joint) {
      for (auto& byte : kernel.frames_[channel][joint].bytes) {
        archive.value(byte);
      }
    }
  }
}

std::vector<std::uint8_t> KernelSnapshot::save(const Kernel& kernel) {
  Writer writer;
  visit_state(kernel, writer);
  return writer.bytes();
}

bool KernelSnapshot::restore(Kernel& kernel, std::span<const std::uint8_t> snapshot) {
  Reader check(snapshot, false);
  visit_state(kernel, check);
  if (!check.fits()) {
    return false;
  }
  Reader reader(snapshot, true);
  visit_state(kernel, reader);
  for (JointMemory& joint : kernel.memory_) {
    for (unsigned s = 0; s < max_slots; ++s) {
      if (joint.slots[s].active) {
        kernel.derive(s, joint.slots[s]);
      }
    }
  }
  return true;
}

}  // namespace proleg
