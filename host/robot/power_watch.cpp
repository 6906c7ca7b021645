#include "host/robot/power_watch.hpp"

#include <algorithm>

#include "shared/canopen/declared_objects.hpp"
#include "shared/canopen/power_state.hpp"

namespace proleg::host {
namespace {

Microseconds period_for(std::size_t modules) {
  constexpr Microseconds round_us = 800'000;
  constexpr Microseconds longest_us = 100'000;
  constexpr Microseconds shortest_us = 20'000;
  return std::clamp(round_us / std::max<std::size_t>(modules, 1), shortest_us, longest_us);
}

}  // namespace

PowerWatch::PowerWatch(CanPort& port, std::vector<std::uint8_t> nodes)
    : readings_(port, periodic_reading_options()), period_us_(period_for(nodes.size())) {
  for (const std::uint8_t node : nodes) {
    modules_.push_back({node});
  }
}

void PowerWatch::start(Microseconds now) { next_reading_ = now + period_us_; }

void PowerWatch::return_to_gait(std::uint8_t node) {
  if (Module* module = module_of(node)) {
    module->is_away = false;
  }
}

PowerWatch::Module* PowerWatch::module_of(std::uint8_t node) {
  const auto found = std::ranges::find(modules_, node, &Module::node);
  return found == modules_.end() ? nullptr : &*found;
}

void PowerWatch::receive(Microseconds now, const CanFrame& frame) {
  namespace identifier = canopen::identifier;
  readings_.receive(now, frame);
  if (next_reading_ == never || loss_) {
    return;
  }
  if (const auto emergency = canopen::decode_emergency(frame)) {
    if (Module* module = module_of(emergency->node); module != nullptr) {
      module->emergency = emergency->code;
    }
  } else if (const auto heartbeat = canopen::decode_heartbeat(frame)) {
    if (Module* module = module_of(heartbeat->node);
        module != nullptr && heartbeat->state == canopen::NmtState::boot_up) {
      module->is_away = true;
    }
  } else if (identifier::base_of(frame.identifier) == identifier::state_frame) {
    const auto state = canopen::decode_state(frame);
    const Module* module = module_of(identifier::node_of(frame.identifier));
    if (module != nullptr && !module->is_away && state && (state->flags() & StateFrame::fault) != 0 &&
        readings_.is_idle()) {
      read(module->node);  // which fault it is
    }
  }
}

void PowerWatch::poll(Microseconds now) {
  if (now >= next_reading_) {
    next_reading_ = now + period_us_;
    const Module& module = modules_[next_module_];
    if (readings_.is_idle() && !loss_) {
      next_module_ = (next_module_ + 1) % modules_.size();
      if (!module.is_away) {
        read(module.node);
      }
    }
  }
  readings_.poll(now);
}

Microseconds PowerWatch::next_deadline() const { return std::min(next_reading_, readings_.next_deadline()); }

void PowerWatch::read(std::uint8_t node) {
  readings_.read(node, canopen::object::statusword.address, [this, node](const SdoResult& result) {
    // A module that does not answer is silent: the master reports that.
    if (const Module* module = module_of(node); module != nullptr && result.is_good() && next_reading_ != never) {
      judge(*module, static_cast<std::uint16_t>(result.number()));
    }
  });
}

void PowerWatch::judge(const Module& module, std::uint16_t statusword) {
  if (!loss_ && !module.is_away && (statusword & canopen::drive_state_bits) != canopen::drive_operation_enabled) {
    loss_ = Loss{module.node, statusword, module.emergency};
  }
}

}  // namespace proleg::host
