#include "firmware/stm32f405/flash.hpp"

#include <cstring>

#include "firmware/stm32f405/flash_layout.hpp"
#include "firmware/stm32f405/registers/core.hpp"
#include "firmware/stm32f405/registers/flash.hpp"
#include "firmware/stm32f405/registers/supply.hpp"
#include "firmware/stm32f405/registers/timer.hpp"
#include "firmware/stm32f405/reset.hpp"
#include "firmware/stm32f405/supply.hpp"
#include "shared/canopen/declared_objects.hpp"

namespace proleg::stm32f405 {
namespace {

using namespace flash_interface;

/// Starts an operation and waits for its end or the timeout. Programs `word` at `address`, or erases if that is 0.
/// Returns the status register. It may call no function and read only registers and the stack, because everything else
/// is in flash. If the supply falls below the threshold of its detector, it resets the chip. After the timeout this
/// write to CR, and the next instruction in flash, stall the CPU until the operation ends (RM0090, section 3.6.1): it
/// is reported late, or the watchdog resets the chip.
[[gnu::section(".ram_code"), gnu::noinline, gnu::noclone]] std::uint32_t operate(std::uint32_t control,
                                                                                 std::uintptr_t address,
                                                                                 std::uint32_t word,
                                                                                 std::uint32_t timeout_us) {
  std::uint32_t primask = 0;
  asm volatile("mrs %0, primask\n\tcpsid i" : "=r"(primask) : : "memory");
  const std::uint32_t start = tim5.cnt().read();
  cr.write(control);
  if (address != 0) {
    Register(address).write(word);
  } else {
    cr.write(control | cr_strt);
  }
  asm volatile("dsb" : : : "memory");  // BSY is set from here on
  std::uint32_t status = sr.read();
  while ((status & sr_bsy) != 0 && tim5.cnt().read() - start < timeout_us) {
    feed_watchdog();
    if ((pwr::csr.read() & pwr::csr_pvdo) != 0) {
      scb::aircr.write(scb::aircr_sysresetreq);  // before code in flash runs without supply
    }
    status = sr.read();
  }
  cr.write(cr_lock);
  asm volatile("msr primask, %0" : : "r"(primask) : "memory");
  return status;
}

bool run(std::uint32_t control, std::uintptr_t address, std::uint32_t word, std::uint32_t timeout_us) {
  if (!wait_until_clear(sr, sr_bsy, 1)) {
    return false;  // an operation that exceeded its timeout is still running
  }
  if (cr.has(cr_lock)) {  // wrong keys lock the register until the next reset
    keyr.write(keyr_key1);
    keyr.write(keyr_key2);
  }
  sr.write(sr_errors | sr_eop);
  return (operate(control, address, word, timeout_us) & (sr_bsy | sr_errors)) == 0;
}

/// Clears the data cache, so that what is read next are the cells. It may hold the data before an erase (RM0090,
/// section 3.5.2). Programming changes what it holds, too (section 3.6.4): a weak cell would be read as if it had taken
/// its value.
void clear_data_cache() {
  acr.clear(acr_dcen);
  acr.set(acr_dcrst);
  acr.clear(acr_dcrst);
  acr.set(acr_dcen);
}

/// Time after which an erase of 16 KiB has failed: twice the maximum of the data sheet.
constexpr std::uint32_t erase_timeout_us = 1'000'000;
// A client of the module still waits when a flash operation that does not end is reported.
static_assert(erase_timeout_us + firmware::BoardRecord::size / 4 * program_timeout_us < canopen::storing_time_us);

constexpr std::uint32_t address_of(unsigned sector) {
  return flash_layout::board_records + sector * BoardRecordFlash::sector_size;
}

}  // namespace

bool erase_sector(unsigned sector, std::uint32_t timeout_us) {
  if (!is_flash_supplied()) {
    return false;
  }
  const bool done = run(cr_ser | sector << cr_snb_position | cr_psize_32, 0, 0, timeout_us);
  clear_data_cache();
  return done;
}

bool program_words(std::uint32_t address, std::span<const std::uint8_t> bytes) {
  if (!is_flash_supplied()) {
    return false;
  }
  for (std::size_t i = 0; i < bytes.size(); i += 4) {
    std::uint32_t word = 0;
    std::memcpy(&word, &bytes[i], sizeof(word));
    if (!run(cr_pg | cr_psize_32, address + i, word, program_timeout_us)) {
      return false;
    }
  }
  clear_data_cache();
  return true;
}

bool BoardRecordFlash::erase(unsigned sector) {
  return sector < sector_count && erase_sector(flash_layout::first_sector_of_records + sector, erase_timeout_us);
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
