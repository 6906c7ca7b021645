#include "shared/canopen/block_transfer.hpp"

namespace proleg::canopen {

BlockReceiver::Segment BlockReceiver::take(std::uint8_t head) {
  const auto number = static_cast<std::uint8_t>(head & ~unsigned{last_segment});
  if (number == 0 || number > size_) {
    return Segment::invalid;
  }
  has_come_ = true;
  has_ended_ = number == size_ || (head & last_segment) != 0;
  if (number != taken_ + 1) {
    return Segment::skipped;
  }
  ++taken_;
  unanswered_ = 0;
  is_complete_ = (head & last_segment) != 0;
  return Segment::taken;
}

std::uint8_t BlockReceiver::acknowledge() {
  ++unanswered_;
  if (has_come_) {
    acknowledged_ = taken_;
    has_acknowledged_ = true;
  }
  taken_ = 0;
  has_come_ = false;
  has_ended_ = false;
  return acknowledged_;
}

bool BlockSender::start(std::uint8_t size) {
  *this = {};
  size_ = size;
  return size != 0 && size <= max_block_size;
}

void BlockSender::restart() {
  sent_ = 0;
  has_sent_last_ = false;
}

std::uint8_t BlockSender::send(bool is_last) {
  has_sent_last_ = is_last;
  ++sent_;
  return static_cast<std::uint8_t>(sent_ | (is_last ? last_segment : 0U));
}

BlockSender::Answer BlockSender::acknowledge(std::uint8_t number, std::uint8_t next_size) {
  if (next_size == 0 || next_size > max_block_size) {
    return Answer::invalid_size;
  }
  if (number > sent_) {
    if (number != acknowledged_) {
      return Answer::invalid_sequence_number;
    }
    if (!can_send()) {
      restart();
    }
    return Answer::repeated;
  }
  acknowledged_ = number;
  size_ = next_size;
  restart();
  return Answer::accepted;
}

}  // namespace proleg::canopen
