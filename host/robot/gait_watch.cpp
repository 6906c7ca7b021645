#include "host/robot/gait_watch.hpp"

#include <algorithm>

#include "shared/canopen/declared_objects.hpp"
#include "shared/canopen/power_state.hpp"

namespace proleg::host {
namespace {

/// Time between two readings of a round with this number of readings.
Microseconds period_for(std::size_t readings) {
  constexpr Microseconds round_us = 800'000;
  constexpr Microseconds longest_us = 100'000;
  constexpr Microseconds shortest_us = 20'000;
  return std::clamp(round_us / std::max<std::size_t>(readings, 1), shortest_us, longest_us);
}

}  // namespace

GaitWatch::GaitWatch(CanPort& port, std::vector<std::uint8_t> nodes)
    : readings_(port, periodic_reading_options()), period_us_(period_for(2 * nodes.size())) {
  for (const std::uint8_t node : nodes) {
    modules_.push_back({node});
  }
}

void GaitWatch::start(Microseconds now) { next_reading_ = now + period_us_; }

void GaitWatch::look_at_all() {
  for (Module& module : modules_) {
    if (!module.is_away) {
      read_statusword(module);
    }
  }
}

void GaitWatch::return_to_gait(std::uint8_t node) {
  if (Module* module = module_of(node)) {
    module->is_away = false;
  }
}

GaitWatch::Module* GaitWatch::module_of(std::uint8_t node) {
  const auto found = std::ranges::find(modules_, node, &Module::node);
  return found == modules_.end() ? nullptr : &*found;
}

std::optional<std::uint16_t> GaitWatch::statusword(std::uint8_t node) const {
  const auto found = std::ranges::find(modules_, node, &Module::node);
  return found == modules_.end() ? std::nullopt : found->statusword;
}

void GaitWatch::receive(Microseconds now, const CanFrame& frame) {
  namespace identifier = canopen::identifier;
  readings_.receive(now, frame);
  if (next_reading_ == never || loss_) {
    return;
  }
  if (const auto emergency = canopen::decode_emergency(frame)) {
    on_emergency(*emergency);
  } else if (const auto heartbeat = canopen::decode_heartbeat(frame)) {
    on_heartbeat(*heartbeat);
  } else if (identifier::base_of(frame.identifier) == identifier::state_frame) {
    const auto state = canopen::decode_state(frame);
    Module* module = module_of(identifier::node_of(frame.identifier));
    if (module != nullptr && !module->is_away && state && (state->flags() & StateFrame::fault) != 0 &&
        readings_.is_idle()) {
      read_statusword(*module);  // the statusword shows the fault
    }
  }
}

void GaitWatch::on_emergency(const canopen::Emergency& emergency) {
  if (Module* module = module_of(emergency.node)) {
    module->emergency = emergency.code;
    module->is_suspect = emergency.code != canopen::EmergencyCode::none;
  }
}

void GaitWatch::on_heartbeat(const canopen::Heartbeat& heartbeat) {
  Module* module = module_of(heartbeat.node);
  if (module == nullptr) {
    return;
  }
  module->is_away = module->is_away || heartbeat.state == canopen::NmtState::boot_up;
  if (!module->is_away && heartbeat.state != canopen::NmtState::operational) {
    lose(*module, {.node = module->node, .reason = Reason::network, .state = heartbeat.state});
  }
}

void GaitWatch::poll(Microseconds now) {
  if (now >= next_reading_) {
    next_reading_ = now + period_us_;
    if (readings_.is_idle() && !loss_) {
      read_next();
    }
  }
  readings_.poll(now);
}

void GaitWatch::read_next() {
  const auto suspect =
      std::ranges::find_if(modules_, [](const Module& module) { return module.is_suspect && !module.is_away; });
  if (suspect != modules_.end()) {
    read_statusword(*suspect);
    return;
  }
  Module& module = modules_[next_ % modules_.size()];
  const bool reads_mode = next_ >= modules_.size();
  next_ = (next_ + 1) % (2 * modules_.size());
  if (!module.is_away) {
    reads_mode ? read_mode(module) : read_statusword(module);
  }
}

Microseconds GaitWatch::next_deadline() const { return std::min(next_reading_, readings_.next_deadline()); }

// Nothing is done for a module that does not answer, because the master reports it.

void GaitWatch::read_statusword(Module& module) {
  module.is_suspect = false;
  readings_.read(module.node, canopen::object::statusword.address, [this, node = module.node](const SdoResult& result) {
    const auto statusword = static_cast<std::uint16_t>(result.number());
    if (result.is_good()) {
      module_of(node)->statusword = statusword;
    }
    if (result.is_good() && (statusword & canopen::drive_state_bits) != canopen::drive_operation_enabled) {
      lose(*module_of(node), {.node = node, .reason = Reason::drive, .statusword = statusword});
    }
  });
}

void GaitWatch::read_mode(const Module& module) {
  readings_.read(module.node, canopen::object::mode_display.address,
                 [this, node = module.node](const SdoResult& result) {
                   const auto mode = static_cast<std::int8_t>(result.number());
                   if (result.is_good() && expected_mode_ && mode != *expected_mode_) {
                     lose(*module_of(node), {.node = node, .reason = Reason::mode, .mode = mode});
                   }
                 });
}

void GaitWatch::lose(const Module& module, Loss loss) {
  if (!loss_ && !module.is_away && next_reading_ != never) {
    loss_ = loss;
    loss_->emergency = module.emergency;
  }
}

}  // namespace proleg::host
