#include "sim/loop/native_module.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace proleg::sim {

bool NativeModule::Flash::erase(unsigned sector) {
  std::ranges::fill(sectors_.at(sector), erased);
  return true;
}

bool NativeModule::Flash::program(unsigned sector, std::uint32_t offset, std::span<const std::uint8_t> bytes) {
  for (const std::uint8_t byte : bytes) {
    sectors_.at(sector).at(offset++) &= byte;  // programming only clears bits
  }
  return true;
}

NativeModule::NativeModule(Bus& bus, const firmware::ModuleIdentity& identity, Crystal crystal, Sensors sensors,
                           Readings readings)
    : crystal_(crystal),
      sensors_(std::move(sensors)),
      meters_(std::move(readings)),
      controller_(bus.attach(*this)),
      module_(identity, {controller_, *this, *this, meters_, flash_}) {
  if (identity.node == 0) {
    return;  // factory-fresh
  }
  firmware::BoardRecord board;
  board.node = identity.node;
  board.has_feedback = (identity.capabilities & canopen::measures_angle) != 0;
  board.feedback_at_plus_90 = firmware::BoardRecord::max_reading;
  if (firmware::append(flash_, board) != firmware::AppendResult::ok) {
    throw std::invalid_argument("node id: found " + std::to_string(identity.node) + ", expected at most " +
                                std::to_string(firmware::BoardRecord::max_node));
  }
  controller_.switch_off();
}

void NativeModule::power_on(BusTime now) {
  controller_.switch_off();
  controller_.switch_on();
  pulse_.reset();
  module_.power_on(crystal_.at(now));
  update_deadline();
}

void NativeModule::advance_to(BusTime now, BusTime /*quiet_until*/) {
  module_.poll(crystal_.at(now));
  update_deadline();
}

void NativeModule::received(BusTime time, const CanFrame& frame) {
  if (tamper_) {
    tamper_(frame, [&](const CanFrame& given) { module_.receive(crystal_.at(time), given); });
  } else {
    module_.receive(crystal_.at(time), frame);
  }
  update_deadline();
}

void NativeModule::transmitted(BusTime time, const CanFrame& frame) {
  module_.transmitted(crystal_.at(time), frame);
  update_deadline();
}

void NativeModule::error_state_changed(BusTime time) {
  // The controller handles the other states itself; the module ignores bus_back() if it was not in bus-off.
  if (controller_.error_state() == ErrorState::bus_off) {
    module_.bus_off(crystal_.at(time));
  } else {
    module_.bus_back(crystal_.at(time));
  }
  update_deadline();
}

}  // namespace proleg::sim
