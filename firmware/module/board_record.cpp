#include "firmware/module/board_record.hpp"

#include "shared/fixed/crc32.hpp"
#include "shared/fixed/little_endian.hpp"

namespace proleg::firmware {
namespace {

constexpr std::uint8_t schema_version = 1;
constexpr std::uint8_t flag_feedback = 1;
constexpr std::size_t version_at = 4;
constexpr std::size_t node_at = 5;
constexpr std::size_t flags_at = 6;
constexpr std::size_t minus_90_at = 8;
constexpr std::size_t plus_90_at = 10;
constexpr std::size_t crc_at = 28;
constexpr std::uint8_t erased = 0xFF;

using Bytes = std::span<const std::uint8_t>;

std::optional<BoardRecord> decode(Bytes bytes) {
  if (read_little_endian(bytes, crc_at, 4) != crc32(bytes.first(crc_at)) || bytes[version_at] != schema_version) {
    return std::nullopt;
  }
  BoardRecord record;
  record.node = bytes[node_at];
  record.has_feedback = (bytes[flags_at] & flag_feedback) != 0;
  record.feedback_at_minus_90 = static_cast<std::uint16_t>(read_little_endian(bytes, minus_90_at, 2));
  record.feedback_at_plus_90 = static_cast<std::uint16_t>(read_little_endian(bytes, plus_90_at, 2));
  return record.valid() ? std::optional(record) : std::nullopt;
}

bool is_erased(Bytes bytes) {
  for (const std::uint8_t byte : bytes) {
    if (byte != erased) {
      return false;
    }
  }
  return true;
}

struct NewestRecord {
  std::optional<BoardRecord> record;
  std::uint32_t sequence = 0;
  unsigned sector = 0;
};

NewestRecord find_newest(const std::array<Bytes, 2>& sectors) {
  NewestRecord found;
  for (unsigned sector = 0; sector < sectors.size(); ++sector) {
    for (Bytes rest = sectors[sector]; rest.size() >= BoardRecord::size; rest = rest.subspan(BoardRecord::size)) {
      const Bytes bytes = rest.first(BoardRecord::size);
      const std::uint32_t sequence = read_little_endian(bytes, 0, 4);
      if (sequence <= found.sequence || is_erased(bytes)) {
        continue;
      }
      if (const std::optional<BoardRecord> record = decode(bytes)) {
        found = {record, sequence, sector};
      }
    }
  }
  return found;
}

/// Where the next record of a sector goes: after everything that was written there. Its end if it is full.
std::size_t free_offset(Bytes sector) {
  std::size_t offset = sector.size() / BoardRecord::size * BoardRecord::size;
  while (offset > 0 && is_erased(sector.subspan(offset - BoardRecord::size, BoardRecord::size))) {
    offset -= BoardRecord::size;
  }
  return offset;
}

bool equal(Bytes a, Bytes b) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i] != b[i]) {
      return false;
    }
  }
  return true;
}

}  // namespace

bool BoardRecord::valid() const {
  return node >= 1 && node <= max_node && feedback_at_minus_90 <= max_reading && feedback_at_plus_90 <= max_reading &&
         (!has_feedback || feedback_at_minus_90 != feedback_at_plus_90);
}

std::array<std::uint8_t, BoardRecord::size> encode(const BoardRecord& record, std::uint32_t sequence) {
  std::array<std::uint8_t, BoardRecord::size> bytes{};
  write_little_endian(bytes, 0, 4, sequence);
  bytes[version_at] = schema_version;
  bytes[node_at] = record.node;
  bytes[flags_at] = record.has_feedback ? flag_feedback : std::uint8_t{0};
  write_little_endian(bytes, minus_90_at, 2, record.feedback_at_minus_90);
  write_little_endian(bytes, plus_90_at, 2, record.feedback_at_plus_90);
  write_little_endian(bytes, crc_at, 4, crc32(Bytes(bytes).first(crc_at)));
  return bytes;
}

std::optional<BoardRecord> newest(Bytes sector_1, Bytes sector_2) { return find_newest({sector_1, sector_2}).record; }

AppendResult append(FlashPort& flash, const BoardRecord& record) {
  if (!record.valid()) {
    return AppendResult::invalid_record;
  }
  const NewestRecord before = find_newest({flash.contents(0), flash.contents(1)});
  unsigned sector = before.sector;
  std::size_t offset = free_offset(flash.contents(sector));
  if (offset + BoardRecord::size > flash.contents(sector).size()) {
    // Erase it even if it reads as erased: an erase that was cut off can leave bits that read as 1 for a while.
    sector ^= 1U;
    offset = 0;
    if (!flash.erase(sector)) {
      return AppendResult::erase_failed;
    }
  }
  const std::array<std::uint8_t, BoardRecord::size> bytes = encode(record, before.sequence + 1U);
  if (!flash.program(sector, static_cast<std::uint32_t>(offset), bytes) ||
      !equal(bytes, flash.contents(sector).subspan(offset, BoardRecord::size))) {
    return AppendResult::program_failed;
  }
  return AppendResult::ok;
}

}  // namespace proleg::firmware
