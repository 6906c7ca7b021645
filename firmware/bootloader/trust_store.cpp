#include "firmware/bootloader/trust_store.hpp"

#include <algorithm>

#include "shared/fixed/crc32.hpp"

namespace proleg::bootloader {
namespace {

constexpr std::uint32_t record_magic = 0x5945'4B50;  // "PKEY"
constexpr std::size_t key_at = 4;
constexpr std::size_t version_at = 36;
constexpr std::size_t crc_at = TrustStore::record_size - 4;

}  // namespace

image::Trust TrustStore::newest(std::span<const std::uint8_t> records) {
  image::Trust trust;
  // From the end on, and past erased records: one that a cut left with weak bits can look erased at one time and used
  // at another, and newer ones may be behind it.
  for (std::size_t at = records.size() / record_size * record_size; at != 0;) {
    at -= record_size;
    const auto record = records.subspan(at, record_size);
    if (read_little_endian(record, 0, 4) == record_magic &&
        read_little_endian(record, crc_at, 4) == crc32(record.first(crc_at))) {
      trust.key.emplace();
      std::ranges::copy(record.subspan(key_at, trust.key->size()), trust.key->begin());
      trust.minimum_version = image::layout::read_version(record, version_at);
      break;
    }
  }
  return trust;
}

broadcast::TrustSummary TrustStore::summary(std::span<const std::uint8_t> records) {
  const image::Trust trust = newest(records);
  if (!trust.key) {
    return {};
  }
  const image::Version& minimum = trust.minimum_version;
  return {image::key_id(*trust.key), minimum.major, minimum.minor, minimum.patch};
}

TrustStore::Record TrustStore::encode(const image::Trust& trust) {
  Record record{};
  write_little_endian(record, 0, 4, record_magic);
  std::ranges::copy(*trust.key, record.begin() + key_at);
  image::layout::write_version(record, version_at, trust.minimum_version);
  write_little_endian(record, crc_at, 4, crc32(std::span<const std::uint8_t>(record).first(crc_at)));
  return record;
}

bool TrustStore::append(const image::Trust& trust) {
  if (is_full()) {
    return false;
  }
  const auto at = static_cast<std::uint32_t>(used() * record_size);
  const Record record = encode(trust);
  return flash_.program(FlashSlot::trust, at, record) &&
         std::ranges::equal(record, flash_.contents(FlashSlot::trust).subspan(at, record_size));
}

/// Number of records up to the last that is not erased.
std::size_t TrustStore::used() const {
  const auto records = flash_.contents(FlashSlot::trust);
  std::size_t count = records.size() / record_size;
  const auto is_erased = [](std::uint8_t byte) { return byte == 0xFF; };
  while (count != 0 && std::ranges::all_of(records.subspan((count - 1) * record_size, record_size), is_erased)) {
    --count;
  }
  return count;
}

}  // namespace proleg::bootloader
