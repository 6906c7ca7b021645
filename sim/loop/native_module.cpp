#include "sim/loop/native_module.hpp"

#include <utility>

namespace proleg::sim {

NativeModule::NativeModule(Bus& bus, const firmware::Board& board, Crystal crystal, Sensors sensors)
    : crystal_(crystal),
      sensors_(std::move(sensors)),
      controller_(bus.attach(*this)),
      module_(board, {controller_, *this, *this}) {
  controller_.switch_off();
}

void NativeModule::power_on(BusTime now) {
  controller_.switch_off();
  controller_.switch_on();
  pulse_.reset();
  module_.power_on(crystal_.at(now));
  update_deadline();
}

void NativeModule::advance_to(BusTime now) {
  module_.poll(crystal_.at(now));
  update_deadline();
}

bool NativeModule::has_computed(unsigned joint, std::uint32_t tick) const {
  const Kernel& kernel = module_.kernel();
  return kernel.is_local(joint) && kernel.tick() == tick + 1 &&
         (kernel.frame(joint, 0).flags() & StateFrame::valid) != 0;
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

}  // namespace proleg::sim
