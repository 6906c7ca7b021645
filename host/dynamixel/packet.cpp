#include "host/dynamixel/packet.hpp"

#include <algorithm>
#include <array>

namespace proleg::host {
namespace {

constexpr std::array<std::uint8_t, 4> header{0xFF, 0xFF, 0xFD, 0x00};
constexpr std::size_t length_at = 5;
constexpr std::size_t instruction_at = 7;
constexpr std::size_t crc_size = 2;
constexpr std::size_t min_status_length = 1 + 1 + crc_size;  // instruction, error byte

constexpr unsigned half(std::uint8_t low, std::uint8_t high) { return unsigned{low} | unsigned{high} << 8U; }

/// Whether the bytes end with the start of a header.
bool ends_with_header(std::span<const std::uint8_t> bytes) {
  const std::size_t size = bytes.size();
  return size >= 3 && bytes[size - 3] == 0xFF && bytes[size - 2] == 0xFF && bytes[size - 1] == 0xFD;
}

/// The bytes without those that byte stuffing has inserted; nothing if an inserted byte is missing.
std::optional<std::vector<std::uint8_t>> without_stuffing(std::span<const std::uint8_t> stuffed) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(stuffed.size());
  for (std::size_t i = 0; i < stuffed.size(); ++i) {
    bytes.push_back(stuffed[i]);
    if (ends_with_header(stuffed.first(i + 1))) {
      ++i;
      if (i == stuffed.size() || stuffed[i] != 0xFD) {
        return std::nullopt;
      }
    }
  }
  return bytes;
}

constexpr std::array<std::uint16_t, 256> make_crc_table() {
  std::array<std::uint16_t, 256> table{};
  for (unsigned value = 0; value < table.size(); ++value) {
    unsigned crc = value << 8U;
    for (unsigned bit = 0; bit < 8; ++bit) {
      crc = (crc & 0x8000U) != 0 ? (crc << 1U) ^ 0x8005U : crc << 1U;
    }
    table[value] = static_cast<std::uint16_t>(crc);
  }
  return table;
}

constexpr std::array<std::uint16_t, 256> crc_table = make_crc_table();

}  // namespace

std::uint16_t packet_crc(std::span<const std::uint8_t> bytes) {
  unsigned crc = 0;
  for (const std::uint8_t byte : bytes) {
    crc = ((crc << 8U) ^ crc_table[((crc >> 8U) ^ byte) & 0xFFU]) & 0xFFFFU;
  }
  return static_cast<std::uint16_t>(crc);
}

std::vector<std::uint8_t> instruction_packet(std::uint8_t id, Instruction instruction,
                                             std::span<const std::uint8_t> parameters) {
  std::vector<std::uint8_t> packet(header.begin(), header.end());
  packet.reserve(packet_overhead + parameters.size());
  packet.insert(packet.end(), {id, 0, 0, static_cast<std::uint8_t>(instruction)});
  for (const std::uint8_t parameter : parameters) {
    packet.push_back(parameter);
    if (ends_with_header(std::span<const std::uint8_t>(packet).subspan(instruction_at))) {
      packet.push_back(0xFD);
    }
  }
  const std::size_t length = packet.size() - instruction_at + crc_size;
  packet[length_at] = static_cast<std::uint8_t>(length);
  packet[length_at + 1] = static_cast<std::uint8_t>(length >> 8U);
  const std::uint16_t crc = packet_crc(packet);
  packet.push_back(static_cast<std::uint8_t>(crc));
  packet.push_back(static_cast<std::uint8_t>(crc >> 8U));
  return packet;
}

const char* describe_error_number(std::uint8_t error) {
  switch (error & StatusPacket::error_number) {
    case 0:
      return "no error";
    case 1:
      return "Result Fail";
    case 2:
      return "Instruction Error";
    case 3:
      return "CRC Error";
    case 4:
      return "Data Range Error";
    case 5:
      return "Data Length Error";
    case 6:
      return "Data Limit Error";
    case 7:
      return "Access Error";
    default:
      return "an unknown error";
  }
}

void StatusParser::add(std::span<const std::uint8_t> bytes) {
  buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
}

void StatusParser::forget_longer_than(std::size_t parameters) {
  const bool has_length = buffer_.size() > length_at + 1;
  if (has_length && half(buffer_[length_at], buffer_[length_at + 1]) + instruction_at > parameters + status_overhead) {
    reset();
  }
}

/// Removes bytes before the next header. Returns whether the buffer begins with a whole header.
bool StatusParser::find_header() {
  const auto found = std::search(buffer_.begin(), buffer_.end(), header.begin(), header.end());
  if (found != buffer_.end()) {
    buffer_.erase(buffer_.begin(), found);
    return true;
  }
  // The last bytes may be the start of a header.
  std::size_t kept = std::min(buffer_.size(), header.size() - 1);
  while (kept > 0 && !std::equal(buffer_.end() - static_cast<std::ptrdiff_t>(kept), buffer_.end(), header.begin())) {
    --kept;
  }
  buffer_.erase(buffer_.begin(), buffer_.end() - static_cast<std::ptrdiff_t>(kept));
  return false;
}

/// Skips only the header of a damaged packet, because the packet may have been cut short and contain others.
void StatusParser::skip_damaged() {
  ++damaged_;
  buffer_.erase(buffer_.begin(), buffer_.begin() + header.size());
}

std::optional<StatusPacket> StatusParser::next() {
  while (find_header() && buffer_.size() > length_at + 1) {
    const std::size_t length = half(buffer_[length_at], buffer_[length_at + 1]);
    if (length < crc_size + 1 || length > max_length) {
      skip_damaged();
      continue;
    }
    const std::size_t size = instruction_at + length;
    if (buffer_.size() < size) {
      return std::nullopt;
    }
    const std::span<const std::uint8_t> packet(buffer_.data(), size);
    const auto body = without_stuffing(packet.subspan(instruction_at, length - crc_size));
    const bool is_intact =
        body && packet_crc(packet.first(size - crc_size)) == half(packet[size - crc_size], packet[size - 1]);
    if (!is_intact) {
      skip_damaged();
      continue;
    }
    const std::uint8_t id = packet[length_at - 1];
    buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(size));
    if (length >= min_status_length && body->front() == static_cast<std::uint8_t>(Instruction::status)) {
      return StatusPacket{id, (*body)[1], {body->begin() + 2, body->end()}};
    }
  }
  return std::nullopt;
}

}  // namespace proleg::host
