#include "firmware/stm32f405/flash.hpp"

#include "firmware/stm32f405/flash_layout.hpp"
#include "firmware/stm32f405/flash_operations.hpp"
#include "shared/canopen/declared_objects.hpp"

namespace proleg::stm32f405 {
namespace {

constexpr unsigned first_sector = 1;

/// Time after which an erase has failed: twice the maximum of the data sheet.
constexpr std::uint32_t erase_timeout_us = 1'000'000;
// A client of the module still waits when a flash operation that does not end is reported.
static_assert(erase_timeout_us + firmware::BoardRecord::size / 4 * program_timeout_us < canopen::storing_time_us);

constexpr std::uint32_t address_of(unsigned sector) {
  return flash_layout::board_records + sector * BoardRecordFlash::sector_size;
}

}  // namespace

bool BoardRecordFlash::erase(unsigned sector) {
  return sector < sector_count && erase_sector(first_sector + sector, erase_timeout_us);
}

bool BoardRecordFlash::program(unsigned sector, std::uint32_t offset, std::span<const std::uint8_t> bytes) {
  if (sector >= sector_count || offset > sector_size || bytes.size() > sector_size - offset || offset % 4 != 0 ||
      bytes.size() % 4 != 0) {
    return false;
  }
  return program_words(address_of(sector) + offset, bytes);
}

std::span<const std::uint8_t> BoardRecordFlash::contents(unsigned sector) const {
  return {reinterpret_cast<const std::uint8_t*>(static_cast<std::uintptr_t>(address_of(sector))), sector_size};
}

}  // namespace proleg::stm32f405
