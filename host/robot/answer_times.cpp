#include "host/robot/answer_times.hpp"

#include "shared/canopen/sdo_frame.hpp"

namespace proleg::host {

void AnswerTimes::requested(Microseconds now, const CanFrame& frame) {
  namespace identifier = canopen::identifier;
  const std::uint8_t node = identifier::node_of(frame.identifier);
  if (identifier::base_of(frame.identifier) != identifier::sdo_request || node >= waiting_.size()) {
    return;
  }
  std::optional<Request>& waiting = waiting_.at(node);
  if (frame.length > 0 && frame.data[0] == canopen::sdo::abort) {
    waiting.reset();  // the old request has no answer
  } else if (!waiting || waiting->frame != frame) {
    waiting = Request{now, frame};
  }
}

void AnswerTimes::receive(Microseconds now, const CanFrame& frame) {
  namespace identifier = canopen::identifier;
  const std::uint8_t node = identifier::node_of(frame.identifier);
  if (identifier::base_of(frame.identifier) != identifier::sdo_answer || node >= waiting_.size()) {
    return;
  }
  if (std::optional<Request>& waiting = waiting_.at(node)) {
    microseconds_.add(now - waiting->time);
    waiting.reset();
  }
}

}  // namespace proleg::host
