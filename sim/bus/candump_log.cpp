#include "sim/bus/candump_log.hpp"

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <ostream>
#include <string_view>
#include <utility>

namespace proleg::sim {
namespace {

constexpr std::size_t min_write_bytes = 1U << 16U;

[[noreturn]] void fail(const std::string& name, int error) {
  throw CandumpLogError(name + ": cannot be written: " + (error == 0 ? "the stream refuses" : std::strerror(error)));
}

void append_hex(std::string& text, unsigned value, unsigned digits) {
  constexpr std::string_view hex = "0123456789ABCDEF";
  while (digits-- > 0) {
    text += hex[(value >> (4 * digits)) & 0xFU];
  }
}

void append_decimal(std::string& text, std::uint64_t value, std::size_t digits) {
  const std::string number = std::to_string(value);
  text.append(digits > number.size() ? digits - number.size() : 0, '0').append(number);
}

}  // namespace

CandumpLog::CandumpLog(const std::filesystem::path& path, std::string interface)
    : stream_(&file_), name_(path.string()), interface_(std::move(interface)) {
  errno = 0;
  file_.open(path, std::ios::binary | std::ios::trunc);
  if (!file_) {
    fail(name_, errno);
  }
}

CandumpLog::CandumpLog(std::ostream& stream, std::string name, std::string interface)
    : stream_(&stream), name_(std::move(name)), interface_(std::move(interface)) {}

CandumpLog::~CandumpLog() {
  try {
    finish();
  } catch (const std::exception&) {
    static_cast<void>(0);  // finish() reports errors; a destructor cannot.
  }
}

void CandumpLog::write(BusTime time, const CanFrame& frame) {
  constexpr BusTime microsecond = 1'000;
  constexpr BusTime second = 1'000'000'000;
  buffer_ += '(';
  append_decimal(buffer_, time / second, 10);
  buffer_ += '.';
  append_decimal(buffer_, time % second / microsecond, 6);
  buffer_.append(") ").append(interface_) += ' ';
  append_hex(buffer_, frame.identifier, 3);
  buffer_ += '#';
  for (const std::uint8_t byte : frame.bytes()) {
    append_hex(buffer_, byte, 2);
  }
  buffer_ += '\n';
  if (buffer_.size() >= min_write_bytes) {
    flush();
  }
}

void CandumpLog::finish() {
  flush();
  errno = 0;
  if (!stream_->flush()) {
    fail(name_, errno);
  }
}

void CandumpLog::flush() {
  errno = 0;
  stream_->write(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
  buffer_.clear();
  if (!*stream_) {
    fail(name_, errno);
  }
}

}  // namespace proleg::sim
