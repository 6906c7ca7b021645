#include "shared/broadcast/transfer_frame.hpp"

namespace proleg::broadcast {
namespace {

constexpr std::size_t serial_at = 1;
constexpr std::size_t detail_at = 3;

CanFrame request(Code code, std::uint8_t length, std::uint8_t first = 0) {
  return {host_identifier, length, {static_cast<std::uint8_t>(code), first}};
}

CanFrame answer(Code code, std::uint32_t serial) {
  CanFrame frame{module_identifier, CanFrame::max_length, {static_cast<std::uint8_t>(code)}};
  write_little_endian(frame.data, serial_at, 2, serial);
  return frame;
}

CanFrame request_to(std::uint32_t serial, Code code) {
  CanFrame frame = request(code, 5);
  write_little_endian(frame.data, 1, 4, serial);
  return frame;
}

CanFrame request_to(std::uint32_t serial, Code code, std::uint8_t first) {
  CanFrame frame = request(code, 6, first);
  write_little_endian(frame.data, 2, 4, serial);
  return frame;
}

bool is_answer(const CanFrame& frame, Code code, std::uint32_t serial) {
  return frame.identifier == module_identifier && frame.length == CanFrame::max_length &&
         frame.data[0] == static_cast<std::uint8_t>(code) &&
         read_little_endian(frame.data, serial_at, 2) == (serial & 0xFFFFU);
}

}  // namespace

CanFrame symbol_frame(unsigned number, const Symbol& symbol) {
  CanFrame frame{host_identifier, CanFrame::max_length, {static_cast<std::uint8_t>(number)}};
  for (std::size_t i = 0; i < symbol_size; ++i) {
    frame.data[1 + i] = symbol[i];
  }
  return frame;
}

CanFrame select_frame(std::uint8_t session, std::uint32_t serial) { return request_to(serial, Code::select, session); }

CanFrame begin_frame(std::uint8_t session, std::uint32_t size) {
  CanFrame frame = request(Code::begin, 5, session);
  write_little_endian(frame.data, 2, 3, size);
  return frame;
}

CanFrame block_frame(std::uint8_t session, unsigned block, BlockKind kind) {
  CanFrame frame = request(Code::block, 4, session);
  frame.data[2] = static_cast<std::uint8_t>(block);
  frame.data[3] = static_cast<std::uint8_t>(kind);
  return frame;
}

CanFrame check_frame(std::uint8_t session, unsigned block, std::uint32_t checksum) {
  CanFrame frame = request(Code::check, 7, session);
  frame.data[2] = static_cast<std::uint8_t>(block);
  write_little_endian(frame.data, 3, 4, checksum);
  return frame;
}

CanFrame report_frame(std::uint32_t serial) { return request_to(serial, Code::report); }

CanFrame install_frame(std::uint8_t session) { return request(Code::install, 2, session); }

CanFrame status_frame(std::uint32_t serial) { return request_to(serial, Code::status); }

CanFrame leave_frame(std::uint8_t session) { return request(Code::leave, 2, session); }

CanFrame header_frame(std::uint32_t serial, std::uint8_t word) { return request_to(serial, Code::header, word); }

CanFrame enter_frame(std::uint32_t serial) { return request_to(serial, Code::enter); }

bool is_enter_request(const CanFrame& frame, std::uint32_t serial) {
  return frame == enter_frame(serial) || frame == enter_frame(every_serial);
}

CanFrame answer_frame(Code code, std::uint32_t serial, const StatusAnswer& status) {
  CanFrame frame = answer(code, serial);
  frame.data[detail_at] = static_cast<std::uint8_t>(status.state);
  frame.data[detail_at + 1] = status.error;
  frame.data[detail_at + 2] = status.session;
  frame.data[detail_at + 3] = status.condition.flags;
  frame.data[detail_at + 4] = status.condition.node;
  return frame;
}

CanFrame answer_frame(std::uint32_t serial, const ReportAnswer& report) {
  CanFrame frame = answer(Code::report, serial);
  frame.data[detail_at] = report.blocks;
  frame.data[detail_at + 1] = report.most;
  for (std::size_t i = 0; i < report.some.size(); ++i) {
    frame.data[detail_at + 2 + i] = report.some[i];
  }
  return frame;
}

CanFrame answer_frame(std::uint32_t serial, const HeaderWord& word) {
  CanFrame frame = answer(Code::header, serial);
  frame.data[detail_at] = word.number;
  write_little_endian(frame.data, detail_at + 1, 4, word.value);
  return frame;
}

std::optional<StatusAnswer> decode_status(const CanFrame& frame, Code code, std::uint32_t serial) {
  if (!is_answer(frame, code, serial) || frame.data[detail_at] > static_cast<std::uint8_t>(ReceiverState::failed)) {
    return std::nullopt;
  }
  return StatusAnswer{static_cast<ReceiverState>(frame.data[detail_at]),
                      frame.data[detail_at + 1],
                      frame.data[detail_at + 2],
                      {frame.data[detail_at + 3], frame.data[detail_at + 4]}};
}

std::optional<ReportAnswer> decode_report(const CanFrame& frame, std::uint32_t serial) {
  if (!is_answer(frame, Code::report, serial)) {
    return std::nullopt;
  }
  ReportAnswer report{frame.data[detail_at], frame.data[detail_at + 1], {}};
  for (std::size_t i = 0; i < report.some.size(); ++i) {
    report.some[i] = frame.data[detail_at + 2 + i];
  }
  return report;
}

std::optional<HeaderWord> decode_header_word(const CanFrame& frame, std::uint32_t serial) {
  if (!is_answer(frame, Code::header, serial)) {
    return std::nullopt;
  }
  return HeaderWord{frame.data[detail_at], read_little_endian(frame.data, detail_at + 1, 4)};
}

}  // namespace proleg::broadcast
