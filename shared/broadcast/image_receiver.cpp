#include "shared/broadcast/image_receiver.hpp"

#include <algorithm>

#include "shared/fixed/crc32.hpp"

namespace proleg::broadcast {

std::optional<CanFrame> ImageReceiver::receive(Microseconds now, const CanFrame& frame) {
  if (frame.identifier != host_identifier) {
    return std::nullopt;
  }
  if (frame.length == CanFrame::max_length) {
    receive_symbol(frame);
    return std::nullopt;
  }
  return receive_request(now, frame);
}

void ImageReceiver::receive_symbol(const CanFrame& frame) {
  if (status_.state != ReceiverState::receiving || !has_block_ || (expects_checksums_ && !checksum_)) {
    return;
  }
  const unsigned number = frame.data[0];
  if (number < next_symbol_) {
    has_block_ = false;  // the frame that began the next block was lost
    return;
  }
  next_symbol_ = number + 1;
  Symbol symbol{};
  std::copy(frame.data.begin() + 1, frame.data.end(), symbol.begin());
  const std::span<std::uint8_t> bytes = bytes_of(block_);
  SymbolSet& received = received_[block_];
  if (kind_ == BlockKind::repairs) {
    const unsigned missing = missing_in(block_);
    if (missing != 0 && decoder_.add(number, symbol)) {
      count_received(missing);
    }
  } else if (number < symbols_of(bytes.size()) && !received.contains(number)) {
    put_symbol(bytes, number, symbol);
    received.insert(number);
    count_received(1);
  }
}

std::optional<CanFrame> ImageReceiver::receive_request(Microseconds now, const CanFrame& frame) {
  const unsigned kind = unsigned{frame.data[0]} << 4U | frame.length;
  const auto has = [kind](Code code, unsigned length) { return kind == (static_cast<unsigned>(code) << 4U | length); };
  const auto word = [&frame](std::size_t at, std::size_t size) { return read_little_endian(frame.data, at, size); };
  // Requests to one module end with its serial number.
  constexpr unsigned serial_size = 4;
  if (frame.length > serial_size && word(frame.length - serial_size, serial_size) == serial_) {
    if (has(Code::select, 6)) {
      select(now, frame.data[1]);
      return answer(Code::select);
    }
    if (has(Code::status, 5)) {
      return answer(Code::status);
    }
    if (has(Code::header, 6)) {
      return answer_frame(serial_, header_word(frame.data[1]));
    }
    if (has(Code::enter, 5)) {
      enters_ = true;
      return answer(Code::enter);
    }
    if (has(Code::report, 5)) {
      return answer_frame(serial_, report());
    }
  }
  if (status_.state == ReceiverState::idle || frame.data[1] != status_.session) {
    return std::nullopt;
  }
  if (has(Code::begin, 5)) {
    begin(word(2, 3));
  } else if (has(Code::block, 4)) {
    enter_block(frame.data[2], frame.data[3]);
  } else if (has(Code::check, 7)) {
    take_checksum(frame.data[2], word(3, 4));
  } else if (has(Code::install, 2)) {
    installs_ = installs_ || status_.state == ReceiverState::complete;
  } else if (has(Code::leave, 2)) {
    leaves_ = true;
  } else {
    return std::nullopt;
  }
  last_request_ = now;
  return std::nullopt;
}

CanFrame ImageReceiver::answer(Code code) {
  status_.condition = owner_.condition();
  return answer_frame(code, serial_, status_);
}

HeaderWord ImageReceiver::header_word(std::uint8_t number) const {
  if (number >= TrustSummary::first_word) {
    return {number, owner_.trust().word(number)};
  }
  constexpr std::size_t size = 4;
  const std::span<const std::uint8_t> header = owner_.image_header();
  const std::size_t begin = number * size;
  return {number, begin + size <= header.size() ? read_little_endian(header, begin, size) : 0};
}

/// Begins a session, unless the request is a repeated one. Another host sees in the answer that the module has a
/// session with a different host.
void ImageReceiver::select(Microseconds now, std::uint8_t session) {
  const bool is_repetition = status_.state >= ReceiverState::installed && status_.session == session &&
                             now - last_request_ < session_timeout_us;
  if (!is_in_use(now) && !is_repetition) {
    status_ = {ReceiverState::selected, 0, session, {}};
    last_request_ = now;
    has_block_ = false;
  }
}

void ImageReceiver::begin(std::uint32_t size) {
  if (status_.state != ReceiverState::selected) {
    return;
  }
  if (size == 0 || size > buffer_.size() || blocks_of(size) > max_blocks) {
    set_state(ReceiverState::refused, refused_size);
    return;
  }
  image_ = buffer_.first(size);
  restart_collection();
  expects_checksums_ = false;
  installs_ = false;
  status_.state = ReceiverState::receiving;
}

void ImageReceiver::restart_collection() {
  received_.fill({});
  missing_ = symbols_of(image_.size());
  has_block_ = false;
}

/// Takes a request that begins a block. The host repeats it, because it may be lost.
void ImageReceiver::enter_block(unsigned block, std::uint8_t kind) {
  if (status_.state != ReceiverState::receiving || block >= blocks_of(image_.size()) ||
      kind > static_cast<std::uint8_t>(BlockKind::repairs)) {
    return;
  }
  const bool is_repetition = has_block_ && block == block_ && kind == static_cast<std::uint8_t>(kind_);
  if (!is_repetition) {
    checksum_.reset();
    if (kind == static_cast<std::uint8_t>(BlockKind::repairs)) {
      decoder_.start(bytes_of(block), received_[block], block);
    }
  }
  has_block_ = true;
  block_ = block;
  kind_ = static_cast<BlockKind>(kind);
  next_symbol_ = 0;
}

/// Takes the checksum of a block. It comes after the frame that begins the block; if it is for another block, that
/// frame was lost.
void ImageReceiver::take_checksum(unsigned block, std::uint32_t checksum) {
  if (status_.state != ReceiverState::receiving) {
    return;
  }
  if (!expects_checksums_ && missing_ != symbols_of(image_.size())) {
    restart_collection();  // the symbols that came before are not known any more
  }
  expects_checksums_ = true;
  has_block_ = has_block_ && block == block_;
  if (has_block_) {
    checksum_ = checksum;
  }
}

std::span<std::uint8_t> ImageReceiver::bytes_of(unsigned block) const { return block_of(image_, block); }

unsigned ImageReceiver::missing_in(unsigned block) const {
  const unsigned symbols = symbols_of(bytes_of(block).size());
  return symbols - received_[block].count();
}

ReportAnswer ImageReceiver::report() const {
  ReportAnswer answer;
  if (status_.state != ReceiverState::receiving) {
    answer.blocks = status_.state < ReceiverState::receiving ? no_image : std::uint8_t{0};
    return answer;
  }
  std::size_t listed = 0;
  for (const bool can_be_repaired : {false, true}) {
    for (unsigned block = 0; block < blocks_of(image_.size()); ++block) {
      const unsigned missing = missing_in(block);
      if (missing == 0 || (missing <= BlockDecoder::max_missing) != can_be_repaired) {
        continue;
      }
      ++answer.blocks;
      if (can_be_repaired) {
        answer.most = std::max(answer.most, static_cast<std::uint8_t>(missing));
      }
      if (listed < answer.some.size()) {
        answer.some[listed++] = static_cast<std::uint8_t>(block | (can_be_repaired ? 0U : needs_symbols));
      }
    }
  }
  return answer;
}

/// Counts symbols of the present block that were received.
void ImageReceiver::count_received(unsigned symbols) {
  missing_ -= symbols;
  if (missing_in(block_) == 0 && checksum_ && crc32(bytes_of(block_)) != *checksum_) {
    // The frames from the middle of one block to the middle of another were lost, so this block contains symbols of the
    // other.
    received_[block_] = {};
    missing_ += missing_in(block_);
    has_block_ = false;
  }
  if (missing_ == 0) {
    status_.state = ReceiverState::complete;
  }
}

bool ImageReceiver::take_leave_request() {
  const bool leaves = leaves_;
  leaves_ = false;
  return leaves;
}

bool ImageReceiver::take_enter_request() {
  const bool enters = enters_;
  enters_ = false;
  return enters;
}

void ImageReceiver::reset() {
  status_ = {};
  installs_ = false;
  leaves_ = false;
  enters_ = false;
}

void ImageReceiver::resume(std::uint8_t session, std::uint32_t size) {
  status_ = {ReceiverState::complete, 0, session, {}};
  image_ = buffer_.first(size < buffer_.size() ? size : buffer_.size());
  installs_ = true;
}

void ImageReceiver::set_state(ReceiverState state, std::uint8_t error) {
  status_.state = state;
  status_.error = error;
  installs_ = false;
}

}  // namespace proleg::broadcast
