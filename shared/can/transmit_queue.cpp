#include "shared/can/transmit_queue.hpp"

namespace proleg {

bool TransmitQueue::push(const CanFrame& frame) {
  if (size_ == capacity) {
    hand_over();
  }
  if (size_ == capacity) {
    return false;
  }
  std::size_t position = size_;
  while (position > 0 && frames_[position - 1].identifier > frame.identifier) {
    frames_[position] = frames_[position - 1];
    --position;
  }
  frames_[position] = frame;
  ++size_;
  hand_over();
  return true;
}

bool TransmitQueue::push_newest(const CanFrame& frame) {
  for (std::size_t i = 0; i < size_; ++i) {
    if (frames_[i].identifier == frame.identifier) {
      frames_[i] = frame;
      hand_over();  // the controller may have recovered
      return true;
    }
  }
  return push(frame);
}

void TransmitQueue::sent() { hand_over(); }

void TransmitQueue::hand_over() {
  std::size_t taken = 0;
  while (taken < size_ && port_.send(frames_[taken])) {
    ++taken;
  }
  for (std::size_t i = taken; i < size_; ++i) {
    frames_[i - taken] = frames_[i];
  }
  size_ -= taken;
}

}  // namespace proleg
