#include "firmware/bootloader/handover.hpp"

namespace proleg::bootloader {

NextStep next_step(const Slots& slots, const Handover& left) {
  if (left.action == HandoverAction::stay || left.action == HandoverAction::install || starts_badly(left)) {
    return NextStep::serve_bus;
  }
  const bool may_run = left.action == HandoverAction::start || slots.is_confirmed(FlashSlot::a);
  return may_run && !slots.image_in(FlashSlot::a).empty() ? NextStep::start_program : NextStep::prepare;
}

}  // namespace proleg::bootloader
