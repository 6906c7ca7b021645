#include "shared/computer/master/lss_exchange.hpp"

namespace proleg::canopen {

void LssExchange::begin(Microseconds now, const CanFrame& request, const Answer& answer, Microseconds wait_us) {
  request_ = request;
  answer_ = answer;
  wait_us_ = wait_us;
  is_pending_ = true;
  is_sent_ = false;
  is_answered_ = false;
  error_ = lss::ok;
  begun_ = now;
  deadline_ = now + send_timeout_us_;
  hand_over();
}

void LssExchange::hand_over() {
  if (is_pending_ && port_.send(request_)) {
    is_pending_ = false;
  }
}

void LssExchange::receive(Microseconds now, const CanFrame& frame) {
  // An adapter may report an answer before it reports that the request was sent.
  if (deadline_ == never || is_pending_ || answer_.length == 0) {
    return;
  }
  if (frame.identifier == answer_.identifier && frame.length == answer_.length && frame.data[0] == answer_.first_byte) {
    error_ = is_answered_ && error_ != lss::ok ? error_ : frame.data[1];
    answer_delay_ = is_answered_ ? answer_delay_ : now - begun_;
    is_sent_ = true;
    is_answered_ = true;
    deadline_ = now + settle_us_;
  }
}

void LssExchange::transmitted(Microseconds now, const CanFrame& frame) {
  if (deadline_ == never) {
    return;
  }
  if (is_pending_) {
    hand_over();
  } else if (!is_sent_ && frame == request_) {
    is_sent_ = true;
    deadline_ = now + wait_us_;
  }
}

}  // namespace proleg::canopen
