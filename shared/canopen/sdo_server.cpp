#include "shared/canopen/sdo_server.hpp"

#include <algorithm>

#include "shared/canopen/messages.hpp"
#include "shared/canopen/sdo_frame.hpp"

namespace proleg::canopen {

std::optional<CanFrame> SdoServer::receive(Microseconds now, const CanFrame& frame) {
  if (frame.identifier != identifier::sdo_request + node_ || frame.length != 8) {
    return std::nullopt;
  }
  const std::uint8_t command = frame.data[0];
  if (command == sdo::abort) {
    reset();
    return std::nullopt;
  }
  last_frame_at_ = now;
  silences_ = 0;
  if (state_ == State::block_download) {
    return download_block_segment(frame);
  }
  switch (sdo::specifier(frame)) {
    case sdo::request_download:
      return initiate_download(frame);
    case sdo::request_download_segment:
      return download_segment(frame);
    case sdo::request_upload:
      return initiate_upload(frame);
    case sdo::request_upload_segment:
      return sdo_has_long_uploads ? upload_segment(frame) : unexpected(frame);
    case sdo::block_download:
      return (command & sdo::block_end) != 0 ? end_block_download(frame) : initiate_block_download(frame);
    case sdo::answer_block_download:
      break;
    case sdo::abort:  // with other bits it is the repeated last segment of a block download
      return std::nullopt;
    default:
      return unexpected(frame);
  }
  return sdo_has_long_uploads ? receive_block_upload(frame) : unexpected(frame);
}

std::optional<CanFrame> SdoServer::receive_block_upload(const CanFrame& frame) {
  switch (frame.data[0] & sdo::block_command) {
    case sdo::block_start:
      return start_block_upload(frame);
    case sdo::block_acknowledge:
      return acknowledge_block_upload(frame);
    case sdo::block_end:
      if (state_ != State::block_upload_end) {
        return unexpected(frame);
      }
      reset();
      return std::nullopt;
    default:
      return initiate_block_upload(frame);
  }
}

// Expedited and segmented transfers (7.2.4.3.3 to 7.2.4.3.8).

CanFrame SdoServer::initiate_download(const CanFrame& frame) {
  const std::uint8_t command = frame.data[0];
  const bool is_expedited = (command & sdo::expedited) != 0;
  const bool has_size = (command & sdo::size_indicated) != 0;
  constexpr unsigned unused_bytes = 3U << 2U;
  const unsigned used = unsigned{sdo::request_download} | sdo::expedited | sdo::size_indicated |
                        (is_expedited && has_size ? unused_bytes : 0U);
  if ((command & ~used) != 0) {
    return unexpected(frame);
  }
  reset();
  AbortCode code = find(frame);
  if (code == AbortCode::none) {
    if (!is_expedited) {
      code = begin_write(has_size ? std::optional(sdo::data(frame)) : std::nullopt);
      state_ = State::download;
    } else {
      const std::uint8_t own_size = is_long(entry_.type) ? std::uint8_t{4} : size_of(entry_.type);
      const std::uint8_t size = has_size ? sdo::indicated_size(command) : own_size;
      code = begin_write(size);
      if (code == AbortCode::none) {
        code = add(std::span(frame.data).subspan(4, size));
      }
      if (code == AbortCode::none) {
        code = finish_write();
      }
    }
  }
  return code == AbortCode::none ? make(sdo::answer_download, entry_.address) : abort(code);
}

CanFrame SdoServer::download_segment(const CanFrame& frame) {
  const std::uint8_t command = frame.data[0];
  if (state_ != State::download) {
    return unexpected(frame);
  }
  if ((command & sdo::toggle) != toggle_) {
    return abort(AbortCode::toggle_not_alternated);
  }
  AbortCode code = add(std::span(frame.data).subspan(1, segment_bytes - sdo::unused_in_segment(frame)));
  const std::uint8_t answer = sdo::answer_download_segment | toggle_;
  toggle_ ^= sdo::toggle;
  if (code == AbortCode::none && (command & sdo::no_more_segments) != 0) {
    code = finish_write();
  }
  return code == AbortCode::none ? make(answer) : abort(code);
}

CanFrame SdoServer::initiate_upload(const CanFrame& frame) {
  if (frame.data[0] != sdo::request_upload) {
    return unexpected(frame);
  }
  reset();
  AbortCode code = find(frame);
  if (code == AbortCode::none) {
    code = begin_read();
  }
  return code == AbortCode::none ? answer_upload() : abort(code);
}

CanFrame SdoServer::answer_upload() {
  CanFrame answer = make(sdo::answer_upload, entry_.address);
  if (size_ >= 1 && size_ <= 4) {
    answer.data[0] = sdo::with_size(sdo::answer_upload, size_);
    const AbortCode code = read_part(0, std::span(answer.data).subspan(4, size_));
    return code == AbortCode::none ? answer : abort(code);
  }
  if (!sdo_has_long_uploads) {
    return abort(AbortCode::unsupported_access);
  }
  state_ = State::upload;
  answer.data[0] |= sdo::size_indicated;
  write_little_endian(answer.data, 4, 4, size_);
  return answer;
}

CanFrame SdoServer::upload_segment(const CanFrame& frame) {
  if (state_ != State::upload) {
    return unexpected(frame);
  }
  if ((frame.data[0] & sdo::toggle) != toggle_) {
    return abort(AbortCode::toggle_not_alternated);
  }
  const std::uint8_t bytes = bytes_at(offset_);
  CanFrame answer =
      make(static_cast<std::uint8_t>(sdo::answer_upload_segment | toggle_ | (segment_bytes - bytes) << 1U));
  const AbortCode code = read_part(offset_, std::span(answer.data).subspan(1, bytes));
  if (code != AbortCode::none) {
    return abort(code);
  }
  toggle_ ^= sdo::toggle;
  offset_ += bytes;
  if (offset_ == size_) {
    answer.data[0] |= sdo::no_more_segments;
    state_ = State::idle;
  }
  return answer;
}

// Block download (7.2.4.3.9 to 7.2.4.3.11).

CanFrame SdoServer::initiate_block_download(const CanFrame& frame) {
  const std::uint8_t command = frame.data[0];
  reset();
  AbortCode code = find(frame);
  if (code == AbortCode::none) {
    const bool has_size = (command & sdo::block_size) != 0;
    code = begin_write(has_size ? std::optional(sdo::data(frame)) : std::nullopt);
  }
  if (code != AbortCode::none) {
    return abort(code);
  }
  uses_crc_ = (command & sdo::block_crc) != 0;
  receiver_.start(max_block_size);
  state_ = State::block_download;
  return answer_block_download();
}

CanFrame SdoServer::answer_block_download() const {
  CanFrame answer = make(sdo::answer_block_download | sdo::block_crc, entry_.address);
  answer.data[4] = receiver_.size();
  return answer;
}

std::optional<CanFrame> SdoServer::download_block_segment(const CanFrame& frame) {
  const BlockReceiver::Segment segment = receiver_.take(frame.data[0]);
  if (segment == BlockReceiver::Segment::invalid) {
    return abort(AbortCode::invalid_sequence_number);
  }
  if (segment == BlockReceiver::Segment::taken && failure_ == AbortCode::none) {
    failure_ = add(std::span(segment_).first(held_));
    held_ = segment_bytes;
    std::copy_n(frame.data.begin() + 1, segment_bytes, segment_.begin());
  }
  return receiver_.has_ended() ? std::optional(acknowledge_block()) : std::nullopt;
}

/// Acknowledges a sub-block. An abort waits for the end of the sub-block: until then, segments are on their way that
/// would be taken for requests.
CanFrame SdoServer::acknowledge_block() {
  if (failure_ != AbortCode::none) {
    return abort(failure_);
  }
  if (!receiver_.has_begun()) {
    return answer_block_download();
  }
  if (receiver_.is_stuck()) {
    return abort(AbortCode::timeout);
  }
  CanFrame answer = make(sdo::answer_block_download | sdo::block_acknowledge);
  answer.data[1] = receiver_.acknowledge();
  answer.data[2] = receiver_.size();
  state_ = receiver_.is_complete() ? State::block_download_end : State::block_download;
  return answer;
}

CanFrame SdoServer::end_block_download(const CanFrame& frame) {
  const CanFrame answer = make(sdo::answer_block_download | sdo::block_end);
  if (state_ == State::block_download_ended) {
    return answer;  // the client has not received the first answer
  }
  if (state_ != State::block_download_end) {
    return unexpected(frame);
  }
  AbortCode code = add(std::span(segment_).first(segment_bytes - std::min(sdo::unused_at_end(frame), held_)));
  if (code == AbortCode::none && uses_crc_ && read_little_endian(frame.data, 1, 2) != crc_.value()) {
    code = AbortCode::crc_error;
  }
  if (code == AbortCode::none) {
    code = finish_write();
  }
  if (code != AbortCode::none) {
    return abort(code);
  }
  state_ = State::block_download_ended;
  return answer;
}

// Block upload (7.2.4.3.12 to 7.2.4.3.15).

CanFrame SdoServer::initiate_block_upload(const CanFrame& frame) {
  reset();
  AbortCode code = find(frame);
  if (code == AbortCode::none && !sender_.start(frame.data[4])) {
    code = AbortCode::invalid_block_size;
  }
  if (code == AbortCode::none) {
    code = begin_read();
  }
  if (code != AbortCode::none) {
    return abort(code);
  }
  const std::uint8_t switch_threshold = frame.data[5];
  if (size_ <= switch_threshold) {
    return answer_upload();
  }
  uses_crc_ = (frame.data[0] & sdo::block_crc) != 0;
  state_ = State::block_upload_start;
  CanFrame answer = make(sdo::block_download | sdo::block_crc | sdo::block_size, entry_.address);
  write_little_endian(answer.data, 4, 4, size_);
  return answer;
}

std::optional<CanFrame> SdoServer::start_block_upload(const CanFrame& frame) {
  const bool is_repeated = state_ == State::block_upload && offset_ == 0;
  if (state_ != State::block_upload_start && !is_repeated) {
    return unexpected(frame);
  }
  sender_.restart();
  state_ = State::block_upload;
  return std::nullopt;
}

CanFrame SdoServer::next_segment(Microseconds now) {
  last_frame_at_ = now;
  const std::uint32_t offset = offset_ + std::uint32_t{segment_bytes} * sender_.sent();
  const std::uint8_t bytes = bytes_at(offset);
  CanFrame segment = make(0);
  const std::span<std::uint8_t> part = std::span(segment.data).subspan(1, bytes);
  const AbortCode code = read_part(offset, part);
  if (code != AbortCode::none) {
    return abort(code);
  }
  if (offset == summed_) {
    crc_.add(part);
    summed_ += bytes;
  }
  segment.data[0] = sender_.send(offset + bytes == size_);
  return segment;
}

std::optional<CanFrame> SdoServer::acknowledge_block_upload(const CanFrame& frame) {
  if (state_ == State::block_upload_end) {
    return end_block_upload();  // the client has not received the first frame of this kind
  }
  if (state_ != State::block_upload) {
    return unexpected(frame);
  }
  const std::uint8_t number = frame.data[1];
  switch (sender_.acknowledge(number, frame.data[2])) {
    case BlockSender::Answer::invalid_size:
      return abort(AbortCode::invalid_block_size);
    case BlockSender::Answer::invalid_sequence_number:
      return abort(AbortCode::invalid_sequence_number);
    case BlockSender::Answer::repeated:
      return std::nullopt;
    case BlockSender::Answer::accepted:
      break;
  }
  const std::uint32_t bytes = std::uint32_t{segment_bytes} * number;
  if (number == 0 || bytes < size_ - offset_) {
    offset_ += bytes;
    return std::nullopt;
  }
  state_ = State::block_upload_end;
  return end_block_upload();
}

CanFrame SdoServer::end_block_upload() const {
  const auto unused =
      static_cast<std::uint8_t>(size_ == 0 ? segment_bytes : (segment_bytes - size_ % segment_bytes) % segment_bytes);
  CanFrame end = make(static_cast<std::uint8_t>(sdo::block_download | unused << 2U | sdo::block_end));
  write_little_endian(end.data, 1, 2, uses_crc_ ? crc_.value() : 0U);
  return end;
}

// Timeouts.

std::optional<CanFrame> SdoServer::poll(Microseconds now) {
  if (now < next_deadline()) {
    return std::nullopt;
  }
  constexpr unsigned max_silences = timeout_us / silence_us;
  if (!is_receiving_block() || ++silences_ >= max_silences) {
    return abort(AbortCode::timeout);
  }
  last_frame_at_ = now;
  return acknowledge_block();
}

Microseconds SdoServer::next_deadline() const {
  if (!is_active()) {
    return never;
  }
  return last_frame_at_ + (is_receiving_block() ? silence_us : timeout_us);
}

void SdoServer::reset() {
  if (is_write_open_) {
    is_write_open_ = false;
    device_.cancel_write(entry_);
  }
  state_ = State::idle;
  toggle_ = 0;
  held_ = 0;
  offset_ = 0;
  summed_ = 0;
  crc_ = {};
  failure_ = AbortCode::none;
}

// Access to the value.

AbortCode SdoServer::find(const CanFrame& frame) {
  const Address address = sdo::address(frame);
  entry_.address = address;
  return device_.find(address, entry_);
}

AbortCode SdoServer::begin_write(std::optional<std::uint32_t> size) {
  if (entry_.access == Access::by_pdo) {
    return AbortCode::unsupported_access;
  }
  if (entry_.access != Access::read_write && entry_.access != Access::write_only) {
    return AbortCode::read_only;
  }
  has_size_ = size.has_value();
  size_ = size.value_or(0);
  if (!is_long(entry_.type)) {
    return has_size_ && size_ != size_of(entry_.type) ? AbortCode::wrong_length : AbortCode::none;
  }
  if (has_size_ && size_ > entry_.maximum) {
    return AbortCode::too_long;
  }
  if (has_size_ && size_ < entry_.minimum) {
    return AbortCode::too_short;
  }
  const AbortCode code = device_.open_write(entry_, size);
  is_write_open_ = code == AbortCode::none;
  return code;
}

AbortCode SdoServer::add(std::span<const std::uint8_t> bytes) {
  const bool is_number = !is_long(entry_.type);
  const std::uint32_t longest = has_size_ ? size_ : (is_number ? size_of(entry_.type) : entry_.maximum);
  if (bytes.size() > longest - offset_) {
    return AbortCode::too_long;
  }
  crc_.add(bytes);
  AbortCode code = AbortCode::none;
  if (is_number) {
    std::copy(bytes.begin(), bytes.end(), number_.begin() + offset_);
  } else if (!bytes.empty()) {
    code = device_.write_part(entry_, offset_, bytes);
  }
  offset_ += static_cast<std::uint32_t>(bytes.size());
  return code;
}

AbortCode SdoServer::finish_write() {
  const bool is_number = !is_long(entry_.type);
  const std::uint32_t shortest = has_size_ ? size_ : (is_number ? size_of(entry_.type) : entry_.minimum);
  if (offset_ < shortest) {
    return AbortCode::too_short;
  }
  AbortCode code = AbortCode::none;
  if (is_number) {
    const std::uint32_t value = extend(entry_.type, read_little_endian(number_, 0, 4));
    code = check_range(entry_, value);
    code = code == AbortCode::none ? device_.write(entry_, value) : code;
  } else {
    code = device_.close_write(entry_, offset_);
  }
  if (code == AbortCode::none) {
    is_write_open_ = false;
    state_ = State::idle;
  }
  return code;
}

AbortCode SdoServer::begin_read() {
  if (entry_.access == Access::write_only) {
    return AbortCode::write_only;
  }
  if (is_long(entry_.type)) {
    return sdo_has_long_uploads ? device_.open_read(entry_, size_) : AbortCode::unsupported_access;
  }
  std::uint32_t value = 0;
  AbortCode code = AbortCode::none;
  if (const std::optional<std::uint32_t> fixed = fixed_value(entry_, node_)) {
    value = *fixed;
  } else {
    code = device_.read(entry_, value);
  }
  write_little_endian(number_, 0, 4, value);
  size_ = size_of(entry_.type);
  return code;
}

AbortCode SdoServer::read_part(std::uint32_t offset, std::span<std::uint8_t> part) {
  if (sdo_has_long_uploads && is_long(entry_.type)) {
    return part.empty() ? AbortCode::none : device_.read_part(entry_, offset, part);
  }
  std::copy_n(number_.begin() + offset, part.size(), part.begin());
  return AbortCode::none;
}

std::uint8_t SdoServer::bytes_at(std::uint32_t offset) const {
  return static_cast<std::uint8_t>(std::min<std::uint32_t>(segment_bytes, size_ - offset));
}

// Answers.

CanFrame SdoServer::make(std::uint8_t command) const {
  return {static_cast<std::uint16_t>(identifier::sdo_answer + node_), 8, {command}};
}

CanFrame SdoServer::make(std::uint8_t command, Address address) const {
  return sdo::make(static_cast<std::uint16_t>(identifier::sdo_answer + node_), command, address);
}

CanFrame SdoServer::refuse(Address address, AbortCode code) const {
  CanFrame frame = make(sdo::abort, address);
  write_little_endian(frame.data, 4, 4, static_cast<std::uint32_t>(code));
  return frame;
}

CanFrame SdoServer::abort(AbortCode code) {
  reset();
  return refuse(entry_.address, code);
}

/// Answers a frame that is not a request, or does not fit the transfer.
CanFrame SdoServer::unexpected(const CanFrame& frame) {
  if (is_active()) {
    return abort(AbortCode::unknown_command);
  }
  return refuse(sdo::address(frame), AbortCode::unknown_command);
}

}  // namespace proleg::canopen
