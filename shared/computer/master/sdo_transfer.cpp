#include "shared/computer/master/sdo_transfer.hpp"

#include <algorithm>

#include "shared/canopen/declared_objects.hpp"
#include "shared/canopen/sdo_frame.hpp"

namespace proleg::canopen {
namespace {

/// Time after which the receiver of a block acknowledges the segments that it has, as SdoServer does.
constexpr Microseconds silence_us = 200'000;
constexpr unsigned max_silences = 5;
/// Time for an acknowledgement. It is longer than the time in which the receiver repeats it.
constexpr Microseconds acknowledgement_timeout_us = (max_silences + 1) * silence_us;

/// Whether lost frames can be the reason of an abort.
bool may_be_lost_frames(AbortCode code) {
  switch (code) {
    case AbortCode::toggle_not_alternated:
    case AbortCode::timeout:
    case AbortCode::unknown_command:
    case AbortCode::invalid_sequence_number:
    case AbortCode::crc_error:
      return true;
    default:
      return false;
  }
}

/// Number of bytes without data in the last segment of a value with `size` bytes.
std::uint8_t unused_in_last_segment(std::size_t size) {
  return static_cast<std::uint8_t>(size == 0 ? segment_bytes : (segment_bytes - size % segment_bytes) % segment_bytes);
}

std::uint16_t crc_of(std::span<const std::uint8_t> bytes) {
  BlockCrc crc;
  crc.add(bytes);
  return crc.value();
}

}  // namespace

void SdoTransfer::download(std::uint8_t node, Address address, std::span<const std::uint8_t> data,
                           const SdoTransferOptions& options) {
  is_download_ = true;
  data_ = data;
  start(node, address, options);
}

void SdoTransfer::upload(std::uint8_t node, Address address, std::span<std::uint8_t> buffer,
                         const SdoTransferOptions& options) {
  is_download_ = false;
  buffer_ = buffer;
  start(node, address, options);
}

void SdoTransfer::start(std::uint8_t node, Address address, const SdoTransferOptions& options) {
  options_ = options;
  node_ = node;
  address_ = address;
  attempts_ = 0;
  has_no_block_ = false;
  abort_.reset();
  abort_code_ = AbortCode::none;
  state_ = State::running;
  begin();
}

void SdoTransfer::begin() {
  ++attempts_;
  step_ = Step::initiate;
  toggle_ = 0;
  held_ = 0;
  offset_ = 0;
  silences_ = 0;
  const std::size_t size = is_download_ ? data_.size() : buffer_.size();
  uses_block_ = size > options_.largest_segmented && !has_no_block_;
  CanFrame frame = make(0);
  write_little_endian(frame.data, 1, 2, address_.index);
  frame.data[3] = address_.sub;
  if (!is_download_) {
    frame.data[0] = sdo::request_upload;
    if (uses_block_) {
      frame.data[0] = sdo::answer_block_download | sdo::block_crc;
      frame.data[4] = options_.block_size;
      frame.data[5] = options_.largest_segmented;
    }
  } else if (size >= 1 && size <= 4) {
    uses_block_ = false;
    frame.data[0] = sdo::with_size(sdo::request_download, static_cast<unsigned>(size));
    std::copy(data_.begin(), data_.end(), frame.data.begin() + 4);
  } else {
    frame.data[0] = uses_block_ ? sdo::block_download | sdo::block_crc | sdo::block_size
                                : sdo::request_download | sdo::size_indicated;
    write_little_endian(frame.data, 4, 4, static_cast<std::uint32_t>(size));
  }
  request(frame);
}

void SdoTransfer::abort(AbortCode code) {
  if (state_ == State::running) {
    fail(code);
  }
}

void SdoTransfer::fail(AbortCode code) {
  abort_ = sdo::make(static_cast<std::uint16_t>(identifier::sdo_request + node_), sdo::abort, address_, 4,
                     static_cast<std::uint32_t>(code));
  request_.reset();
  state_ = State::aborted;
  abort_code_ = code;
}

/// Begins another attempt. The server has aborted this one, or was sent the abort of the client.
void SdoTransfer::retry(AbortCode code) {
  if (attempts_ < options_.attempts) {
    state_ = State::running;
    begin();
  } else {
    request_.reset();
    state_ = State::aborted;
    abort_code_ = code;
  }
}

void SdoTransfer::abort_attempt(AbortCode code) {
  fail(code);
  retry(code);
}

void SdoTransfer::request(const CanFrame& frame) {
  request_ = last_request_ = frame;
  deadline_ = never;
}

CanFrame SdoTransfer::make(std::uint8_t command) const {
  return {static_cast<std::uint16_t>(identifier::sdo_request + node_), 8, {command}};
}

Microseconds SdoTransfer::wait_us() const {
  if (step_ == Step::end || (step_ == Step::block && !is_download_)) {
    return silence_us;
  }
  if (step_ == Step::block) {
    return acknowledgement_timeout_us;
  }
  return is_download_ ? std::max(options_.timeout_us, min_write_timeout_us(address_)) : options_.timeout_us;
}

std::optional<CanFrame> SdoTransfer::next_frame(Microseconds now) {
  std::optional<CanFrame> frame;
  if (abort_) {
    frame.swap(abort_);
    return frame;
  }
  if (request_) {
    frame.swap(request_);
  } else if (state_ == State::running && step_ == Step::block && is_download_ && sender_.can_send()) {
    frame = next_block_segment();
  } else {
    return std::nullopt;
  }
  deadline_ = now + wait_us();
  return frame;
}

void SdoTransfer::receive(Microseconds now, const CanFrame& frame) {
  if (state_ != State::running || frame.identifier != identifier::sdo_answer + node_ || frame.length != 8) {
    return;
  }
  if (frame.data[0] == sdo::abort) {
    receive_abort(frame);
    return;
  }
  switch (step_) {
    case Step::initiate:
      if (sdo::address(frame) == address_) {
        receive_initiate(now, frame);
      }
      break;
    case Step::segment:
      receive_segment(frame);
      break;
    case Step::block:
      if (is_download_) {
        receive_acknowledgement(now, frame);
      } else {
        receive_block_segment(now, frame);
      }
      break;
    case Step::end:
      receive_end(frame);
      break;
  }
}

void SdoTransfer::receive_abort(const CanFrame& frame) {
  const auto code = static_cast<AbortCode>(sdo::data(frame));
  const bool is_own = sdo::address(frame) == address_;
  if (step_ == Step::initiate && !is_own) {
    return;  // the frame belongs to a transfer before
  }
  if (step_ == Step::initiate && uses_block_ && code == AbortCode::unknown_command) {
    has_no_block_ = true;
    --attempts_;
    begin();
  } else if (!is_own || may_be_lost_frames(code)) {
    retry(code);
  } else {
    request_.reset();
    state_ = State::aborted;
    abort_code_ = code;
  }
}

void SdoTransfer::receive_initiate(Microseconds now, const CanFrame& frame) {
  const std::uint8_t command = frame.data[0];
  if (!is_download_) {
    receive_upload(frame);
  } else if (uses_block_) {
    if (sdo::specifier(frame) != sdo::answer_block_download || (command & sdo::block_command) != 0) {
      return;
    }
    if (!sender_.start(frame.data[4])) {
      fail(AbortCode::invalid_block_size);
      return;
    }
    uses_crc_ = (command & sdo::block_crc) != 0;
    step_ = Step::block;
    deadline_ = now + wait_us();
  } else if (command == sdo::answer_download) {
    if ((last_request_.data[0] & sdo::expedited) != 0) {
      offset_ = static_cast<std::uint32_t>(data_.size());
      finish();
    } else {
      step_ = Step::segment;
      send_segment();
    }
  }
}

void SdoTransfer::receive_upload(const CanFrame& frame) {
  const std::uint8_t command = frame.data[0];
  const bool is_block = uses_block_ && sdo::specifier(frame) == sdo::block_download && (command & sdo::block_end) == 0;
  if (!is_block && sdo::specifier(frame) != sdo::answer_upload) {
    return;
  }
  if (!is_block && (command & sdo::expedited) != 0) {
    const std::uint8_t indicated = sdo::indicated_size(command);
    if (store(std::span(frame.data).subspan(4, indicated != 0 ? indicated : 4U))) {
      finish();
    }
    return;
  }
  has_size_ = (command & (is_block ? sdo::block_size : sdo::size_indicated)) != 0;
  announced_ = sdo::data(frame);
  if (has_size_ && announced_ > buffer_.size()) {
    fail(AbortCode::out_of_memory);
    return;
  }
  uses_block_ = is_block;
  step_ = is_block ? Step::block : Step::segment;
  if (is_block) {
    uses_crc_ = (command & sdo::block_crc) != 0;
    receiver_.start(options_.block_size);
    request(make(sdo::answer_block_download | sdo::block_start));
  } else {
    request(make(sdo::request_upload_segment));
  }
}

// Segmented transfers.

void SdoTransfer::send_segment() {
  const std::size_t bytes = std::min<std::size_t>(segment_bytes, data_.size() - offset_);
  const bool is_last = offset_ + bytes == data_.size();
  CanFrame segment = make(static_cast<std::uint8_t>(sdo::request_download_segment | toggle_ |
                                                    (segment_bytes - bytes) << 1U | (is_last ? 1U : 0U)));
  const std::span<const std::uint8_t> part = data_.subspan(offset_, bytes);
  std::copy(part.begin(), part.end(), segment.data.begin() + 1);
  request(segment);
}

void SdoTransfer::receive_segment(const CanFrame& frame) {
  const std::uint8_t command = frame.data[0];
  if (sdo::specifier(frame) != (is_download_ ? sdo::answer_download_segment : sdo::answer_upload_segment)) {
    return;
  }
  if ((command & sdo::toggle) != toggle_) {
    abort_attempt(AbortCode::toggle_not_alternated);
    return;
  }
  toggle_ ^= sdo::toggle;
  if (is_download_) {
    offset_ = static_cast<std::uint32_t>(std::min<std::size_t>(data_.size(), std::size_t{offset_} + segment_bytes));
    if (offset_ == data_.size()) {
      finish();
    } else {
      send_segment();
    }
    return;
  }
  const std::size_t bytes = segment_bytes - sdo::unused_in_segment(frame);
  const bool is_last = (command & sdo::no_more_segments) != 0;
  if (bytes == 0 && !is_last) {  // an upload of such segments would never end
    fail(AbortCode::unknown_command);
    return;
  }
  if (!store(std::span(frame.data).subspan(1, bytes))) {
    return;
  }
  if (is_last) {
    end_upload();
  } else {
    request(make(sdo::request_upload_segment | toggle_));
  }
}

// Block download.

CanFrame SdoTransfer::next_block_segment() {
  const std::size_t offset = offset_ + std::size_t{segment_bytes} * sender_.sent();
  const std::span<const std::uint8_t> part =
      data_.subspan(offset, std::min<std::size_t>(segment_bytes, data_.size() - offset));
  CanFrame segment = make(sender_.send(offset + part.size() == data_.size()));
  std::copy(part.begin(), part.end(), segment.data.begin() + 1);
  return segment;
}

void SdoTransfer::receive_acknowledgement(Microseconds now, const CanFrame& frame) {
  const std::uint8_t command = frame.data[0] & (sdo::block_command | 0xE0U);
  if (command == sdo::answer_block_download && offset_ == 0 && !sender_.can_send()) {
    sender_.restart();  // the server has received no segment
    return;
  }
  if (command != (sdo::answer_block_download | sdo::block_acknowledge)) {
    return;
  }
  const std::uint8_t number = frame.data[1];
  switch (sender_.acknowledge(number, frame.data[2])) {
    case BlockSender::Answer::invalid_size:
      fail(AbortCode::invalid_block_size);
      return;
    case BlockSender::Answer::invalid_sequence_number:
      abort_attempt(AbortCode::invalid_sequence_number);
      return;
    case BlockSender::Answer::repeated:
      return;
    case BlockSender::Answer::accepted:
      break;
  }
  const std::size_t bytes = std::size_t{segment_bytes} * number;
  deadline_ = now + wait_us();
  if (number == 0 || bytes < data_.size() - offset_) {
    offset_ += static_cast<std::uint32_t>(bytes);
    return;
  }
  offset_ = static_cast<std::uint32_t>(data_.size());
  step_ = Step::end;
  CanFrame end = make(
      static_cast<std::uint8_t>(sdo::block_download | unused_in_last_segment(data_.size()) << 2U | sdo::block_end));
  write_little_endian(end.data, 1, 2, uses_crc_ ? crc_of(data_) : 0U);
  request(end);
}

// Block upload.

void SdoTransfer::receive_block_segment(Microseconds now, const CanFrame& frame) {
  switch (receiver_.take(frame.data[0])) {
    case BlockReceiver::Segment::invalid:
      abort_attempt(AbortCode::invalid_sequence_number);
      return;
    case BlockReceiver::Segment::taken:
      if (!store(std::span(segment_).first(held_))) {
        return;
      }
      held_ = segment_bytes;
      std::copy_n(frame.data.begin() + 1, segment_bytes, segment_.begin());
      break;
    case BlockReceiver::Segment::skipped:
      break;
  }
  silences_ = 0;
  deadline_ = now + wait_us();
  if (receiver_.has_ended()) {
    acknowledge();
  }
}

void SdoTransfer::acknowledge() {
  if (!receiver_.has_begun()) {
    request(make(sdo::answer_block_download | sdo::block_start));
    return;
  }
  if (receiver_.is_stuck()) {
    abort_attempt(AbortCode::timeout);
    return;
  }
  CanFrame frame = make(sdo::answer_block_download | sdo::block_acknowledge);
  frame.data[1] = receiver_.acknowledge();
  frame.data[2] = receiver_.size();
  step_ = receiver_.is_complete() ? Step::end : Step::block;
  request(frame);
}

void SdoTransfer::receive_end(const CanFrame& frame) {
  const std::uint8_t command = frame.data[0];
  if (is_download_) {
    if (command == (sdo::answer_block_download | sdo::block_end)) {
      finish();
    } else if (command == (sdo::answer_block_download | sdo::block_acknowledge)) {
      request(last_request_);  // the server has not received the end
    }
    return;
  }
  if (sdo::specifier(frame) != sdo::block_download || (command & sdo::block_end) == 0) {
    return;
  }
  if (!store(std::span(segment_).first(segment_bytes - std::min(sdo::unused_at_end(frame), held_)))) {
    return;
  }
  if (uses_crc_ && read_little_endian(frame.data, 1, 2) != crc_of(buffer_.first(offset_))) {
    abort_attempt(AbortCode::crc_error);
    return;
  }
  end_upload();
  if (state_ == State::done) {
    request(make(sdo::answer_block_download | sdo::block_end));
  }
}

bool SdoTransfer::store(std::span<const std::uint8_t> bytes) {
  if (bytes.size() > buffer_.size() - offset_) {
    fail(AbortCode::out_of_memory);
    return false;
  }
  std::ranges::copy(bytes, buffer_.subspan(offset_).begin());
  offset_ += static_cast<std::uint32_t>(bytes.size());
  return true;
}

void SdoTransfer::end_upload() {
  if (has_size_ && offset_ != announced_) {
    fail(AbortCode::wrong_length);
  } else {
    finish();
  }
}

void SdoTransfer::finish() {
  request_.reset();
  state_ = State::done;
}

void SdoTransfer::poll(Microseconds now) {
  if (now < next_deadline()) {
    return;
  }
  const bool repeats = step_ == Step::end || (step_ == Step::block && !is_download_);
  if (!repeats || ++silences_ >= max_silences) {
    abort_attempt(AbortCode::timeout);
  } else if (is_download_) {
    request(last_request_);
  } else {
    acknowledge();
  }
}

}  // namespace proleg::canopen
