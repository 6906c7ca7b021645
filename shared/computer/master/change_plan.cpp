#include "shared/computer/master/change_plan.hpp"

#include <array>

#include "shared/canopen/objects.hpp"

namespace proleg::canopen {
namespace {

constexpr std::uint8_t value_size = 4;

}  // namespace

ChangePlan::ChangePlan(const KernelConfiguration& kernel, std::span<Change> changes, std::size_t next)
    : kernel_(kernel), changes_(changes), next_(next), pending_from_(next) {
  for (Change& change : changes_.subspan(next)) {
    change.dropped = false;
  }
}

bool ChangePlan::exists(const Setting& setting) const {
  if (setting.slot >= max_slots || setting.joint >= kernel_.joint_count) {
    return false;
  }
  const Slot& slot = kernel_.slots[setting.slot];
  if (slot.algorithm == nullptr || !slot.group.contains(setting.joint)) {
    return false;
  }
  const Declaration& declaration = slot.algorithm->declaration();
  return setting.number < (setting.internal ? declaration.internal_values.size() : declaration.parameters.size());
}

bool ChangePlan::fits(const Change& change) const {
  std::array<std::uint8_t, max_joints> count{};
  for (const Setting& setting : change.settings) {
    if (!exists(setting) || count[setting.joint] == max_staged_values) {
      return false;
    }
    ++count[setting.joint];
  }
  return true;
}

std::optional<std::size_t> ChangePlan::find_bad() const {
  for (std::size_t i = next_; i < changes_.size(); ++i) {
    const bool is_in_order = i == 0 || changes_[i].tick > changes_[i - 1].tick || changes_[i].tick == Change::soon;
    if (!is_in_order || !fits(changes_[i])) {
      return i;
    }
  }
  return std::nullopt;
}

bool ChangePlan::can_stage() const {
  if (next_ == changes_.size()) {
    return false;
  }
  std::size_t pending = 0;
  std::array<std::uint16_t, max_joints> count{};
  const auto add = [&count](const Change& change) {
    bool room = true;
    for (const Setting& setting : change.settings) {
      ++count[setting.joint];
      room = room && count[setting.joint] <= max_staged_values;
    }
    return room;
  };
  for (std::size_t i = pending_from_; i < next_; ++i) {
    if (!changes_[i].dropped) {
      ++pending;
      static_cast<void>(add(changes_[i]));
    }
  }
  return pending < max_pending && add(changes_[next_]);
}

void ChangePlan::decide_tick(std::uint32_t earliest) {
  Change& change = changes_[next_];
  if (change.tick == Change::soon) {
    change.tick = next_ > 0 && changes_[next_ - 1].tick >= earliest ? changes_[next_ - 1].tick + 1 : earliest;
  }
}

void ChangePlan::commit_next() { ++next_; }

void ChangePlan::drop_next() {
  decide_tick(0);  // the changes behind it need a tick before theirs
  changes_[next_].dropped = true;
  ++next_;
}

void ChangePlan::pass(std::uint32_t tick) {
  while (pending_from_ < next_ && (changes_[pending_from_].dropped || changes_[pending_from_].tick <= tick)) {
    ++pending_from_;
  }
}

std::optional<SdoRequest> ChangePlan::staging(std::size_t change, unsigned joint, std::size_t n) const {
  if (n == 0) {
    return SdoRequest{object::transaction.address, size_of(object::transaction.type), transaction(change)};
  }
  for (const Setting& setting : changes_[change].settings) {
    if (setting.joint == joint && --n == 0) {
      const ValueKind kind = setting.internal ? ValueKind::internal_value : ValueKind::staged_parameter;
      return SdoRequest{address_of({kind, kernel_.slots[setting.slot].algorithm_id(), setting.number, setting.slot}),
                        value_size, static_cast<std::uint32_t>(setting.value)};
    }
  }
  return std::nullopt;
}

std::optional<std::int32_t> ChangePlan::parameter_before(std::size_t end, unsigned joint, unsigned slot,
                                                         unsigned parameter) const {
  for (std::size_t i = end; i-- > 0;) {
    if (changes_[i].dropped) {
      continue;
    }
    std::optional<std::int32_t> last;
    for (const Setting& setting : changes_[i].settings) {
      if (!setting.internal && setting.joint == joint && setting.slot == slot && setting.number == parameter) {
        last = setting.value;
      }
    }
    if (last) {
      return last;
    }
  }
  return std::nullopt;
}

std::optional<SdoRequest> ChangePlan::parameter_write(std::size_t end, unsigned joint, std::size_t n) const {
  for (std::uint8_t slot = 0; slot < max_slots; ++slot) {
    if (kernel_.slots[slot].algorithm == nullptr) {
      continue;
    }
    const std::size_t parameters = kernel_.slots[slot].algorithm->declaration().parameters.size();
    for (std::uint8_t parameter = 0; parameter < parameters; ++parameter) {
      const std::optional<std::int32_t> value = parameter_before(end, joint, slot, parameter);
      if (value && n-- == 0) {
        return SdoRequest{address_of({ValueKind::parameter, kernel_.slots[slot].algorithm_id(), parameter, slot}),
                          value_size, static_cast<std::uint32_t>(*value)};
      }
    }
  }
  return std::nullopt;
}

}  // namespace proleg::canopen
