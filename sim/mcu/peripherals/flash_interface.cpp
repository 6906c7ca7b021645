#include "sim/mcu/peripherals/flash_interface.hpp"

#include <algorithm>
#include <array>
#include <random>
#include <string>
#include <vector>

#include "shared/fixed/little_endian.hpp"

namespace proleg::sim {
namespace {

constexpr std::uint32_t acr = 0x00;
constexpr std::uint32_t keyr = 0x04;
constexpr std::uint32_t optkeyr = 0x08;
constexpr std::uint32_t sr = 0x0C;
constexpr std::uint32_t cr = 0x10;
constexpr std::uint32_t optcr = 0x14;
constexpr RegisterName registers[] = {{acr, "ACR"}, {keyr, "KEYR"}, {optkeyr, "OPTKEYR"},
                                      {sr, "SR"},   {cr, "CR"},     {optcr, "OPTCR"}};

constexpr std::uint32_t acr_bits = 0x1F07;  // DCRST, ICRST, DCEN, ICEN, PRFTEN, LATENCY
constexpr std::uint32_t acr_prften = 1U << 8U;
constexpr std::uint32_t acr_dcen = 1U << 10U;
constexpr std::uint32_t acr_dcrst = 1U << 12U;

constexpr std::uint32_t sr_eop = 1U << 0U;
constexpr std::uint32_t sr_operr = 1U << 1U;
constexpr std::uint32_t sr_wrperr = 1U << 4U;
constexpr std::uint32_t sr_pgaerr = 1U << 5U;
constexpr std::uint32_t sr_pgperr = 1U << 6U;
constexpr std::uint32_t sr_pgserr = 1U << 7U;
constexpr std::uint32_t sr_busy = 1U << 16U;
constexpr std::uint32_t sr_flags = sr_eop | sr_operr | sr_wrperr | sr_pgaerr | sr_pgperr | sr_pgserr;

constexpr std::uint32_t cr_pg = 1U << 0U;
constexpr std::uint32_t cr_ser = 1U << 1U;
constexpr std::uint32_t cr_mer = 1U << 2U;
constexpr std::uint32_t cr_strt = 1U << 16U;
constexpr std::uint32_t cr_eopie = 1U << 24U;
constexpr std::uint32_t cr_errie = 1U << 25U;
constexpr std::uint32_t cr_lock = 1U << 31U;
constexpr std::uint32_t cr_kept = 0x0300'037F;  // ERRIE, EOPIE, PSIZE, SNB, MER, SER, PG

constexpr std::uint32_t optcr_reset = 0x0FFF'AAED;
constexpr std::uint32_t optcr_lock = 1U << 0U;
constexpr std::uint32_t optcr_start = 1U << 1U;
constexpr std::uint32_t optcr_brown_out = 3U << 2U;

constexpr std::uint32_t flash_bytes = 1024 * 1024;
constexpr unsigned x32 = 2;
constexpr unsigned x64 = 3;
constexpr std::uint32_t x32_from_mv = 2'700;  // RM0090, table 12
constexpr std::size_t bytes_of_word = 4;

constexpr LocalTime ms = 1000 * local_time_per_us;

/// Typical durations of erasing, by size and parallelism x8, x16, x32 (DS8626). The maximum is twice as long.
LocalTime erase_time(std::uint32_t bytes, unsigned parallelism) {
  constexpr LocalTime sector_16k[] = {400 * ms, 300 * ms, 250 * ms};
  constexpr LocalTime sector_64k[] = {1200 * ms, 700 * ms, 550 * ms};
  constexpr LocalTime sector_128k[] = {2000 * ms, 1300 * ms, 1000 * ms};
  constexpr LocalTime all[] = {16'000 * ms, 11'000 * ms, 8'000 * ms};
  switch (bytes) {
    case 16 * 1024:
      return sector_16k[parallelism];
    case 64 * 1024:
      return sector_64k[parallelism];
    case 128 * 1024:
      return sector_128k[parallelism];
    default:
      return all[parallelism];
  }
}

/// A voltage as text: "2.5 V", "1.72 V".
std::string volts_text(std::uint32_t mv) {
  std::string decimals = std::to_string(1'000 + mv % 1'000).substr(1);
  decimals.erase(std::max<std::size_t>(decimals.find_last_not_of('0') + 1, 1));
  return std::to_string(mv / 1'000) + "." + decimals + " V";
}

std::size_t sector_of(std::uint32_t address) {
  std::size_t sector = 0;
  while (address - flash_sectors[sector].start >= flash_sectors[sector].size) {
    ++sector;
  }
  return sector;
}

}  // namespace

FlashInterface::FlashInterface(ChipServices& chip, FlashMemory& memory, std::uint16_t protected_sectors)
    : RegisterBlock(chip, "FLASH", 0x4002'3C00, 0x400, registers),
      memory_(&memory),
      option_bytes_(optcr_reset & ~(std::uint32_t{protected_sectors} << 16U)),
      interrupt_(chip, interrupt_position) {
  reset();
}

void FlashInterface::set_brown_out_level(unsigned level) {
  option_bytes_ = (option_bytes_ & ~optcr_brown_out) | (level << 2U & optcr_brown_out);
  optcr_ = option_bytes_;
}

unsigned FlashInterface::brown_out_level() const { return field(option_bytes_, 2, 2); }

void FlashInterface::set_weak_word(std::uint32_t address, std::uint32_t bits) {
  clear_data_cache();
  weak_ = WeakWord{address, bits, std::nullopt};
}

void FlashInterface::clear_data_cache() {
  if (!weak_ || !weak_->cells) {
    return;
  }
  std::array<std::uint8_t, bytes_of_word> bytes{};
  write_little_endian(bytes, 0, bytes.size(), *weak_->cells);
  weak_->cells.reset();
  memory_->write(weak_->address, bytes);
}

void FlashInterface::reset() {
  clear_data_cache();
  acr_ = 0;
  sr_ = 0;
  cr_ = cr_lock;
  optcr_ = option_bytes_;
  lock_ = Lock::locked;
  option_lock_ = Lock::locked;
  operations_.clear();
  interrupt_.set(false);
}

std::optional<std::string> FlashInterface::speed_fault(LocalTime core_period) const {
  const FlashSpeed speed = flash_speed(supply_mv_);
  const std::string hclk =
      "HCLK of " + std::to_string(local_time_per_us / core_period) + " MHz at " + volts_text(supply_mv_);
  const std::string source = " (RM0090, table 10)";
  if (core_period * speed.max_mhz < local_time_per_us) {
    return hclk + ": at most " + std::to_string(speed.max_mhz) + " MHz" + source;
  }
  if (const unsigned needed = flash_wait_states(core_period, supply_mv_); wait_states() < needed) {
    return hclk + " needs " + std::to_string(needed) + " wait states, FLASH_ACR has " + std::to_string(wait_states()) +
           source;
  }
  if (!speed.may_prefetch && (acr_ & acr_prften) != 0) {
    return hclk + ": the prefetch must be off" + source;
  }
  return std::nullopt;
}

LocalTime FlashInterface::busy_until() const { return operations_.empty() ? 0 : operations_.back().end; }

LocalTime FlashInterface::next_event() const { return operations_.empty() ? never_on_chip : operations_.front().end; }

void FlashInterface::advance() { settle(); }

void FlashInterface::settle() {
  while (!operations_.empty() && operations_.front().end <= chip().now()) {
    finish(operations_.front());
    operations_.pop_front();
  }
  update_interrupt();
}

void FlashInterface::finish(const Operation& operation) {
  std::vector<std::uint8_t> bytes(operation.size, 0xFF);
  if (!operation.erase) {
    memory_->read(operation.address, bytes);
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      bytes[i] &= static_cast<std::uint8_t>(operation.value >> (8 * i));
    }
  }
  if (weak_ && weak_->address - operation.address < operation.size) {
    weak_->cells.reset();
    if (!operation.erase && operation.address == weak_->address && operation.size == bytes_of_word) {
      const std::uint32_t written = read_little_endian(bytes, 0, bytes_of_word);
      if ((acr_ & acr_dcen) != 0) {
        weak_->cells = written | weak_->bits;
      } else {
        write_little_endian(bytes, 0, bytes.size(), written | weak_->bits);
      }
    }
  }
  memory_->write(operation.address, bytes);
  if ((cr_ & cr_eopie) != 0) {
    sr_ |= sr_eop;
  }
}

void FlashInterface::cut(std::uint64_t seed) {
  settle();
  if (operations_.empty()) {
    return;
  }
  const Operation operation = operations_.front();
  operations_.clear();
  std::mt19937_64 random(seed);
  std::vector<std::uint8_t> bytes(operation.size);
  memory_->read(operation.address, bytes);
  constexpr std::size_t word = 4;
  for (std::size_t start = 0; start < bytes.size(); start += word) {
    // Some words are nearly done, some hardly begun.
    std::uint64_t done = random();
    switch (random() % 4) {
      case 0:
        done &= random();
        break;
      case 1:
        done |= random();
        break;
      default:
        break;
    }
    for (std::size_t i = start; i < std::min(start + word, bytes.size()); ++i) {
      const auto bits = static_cast<std::uint8_t>(done >> (8 * (i - start)));
      if (operation.erase) {
        bytes[i] |= bits;
      } else {
        bytes[i] &= static_cast<std::uint8_t>((operation.value >> (8 * i)) | bits);
      }
    }
  }
  memory_->write(operation.address, bytes);
}

void FlashInterface::update_interrupt() {
  interrupt_.set(((sr_ & sr_eop) != 0 && (cr_ & cr_eopie) != 0) || ((sr_ & sr_operr) != 0 && (cr_ & cr_errie) != 0));
}

void FlashInterface::fail(std::uint32_t flags) {
  sr_ |= flags;
  if ((cr_ & cr_errie) != 0) {
    sr_ |= sr_operr;
  }
  update_interrupt();
}

bool FlashInterface::program(std::uint32_t address, unsigned size, std::uint32_t value) {
  if (address - flash_start >= flash_bytes || flash_bytes - (address - flash_start) < size) {
    return false;
  }
  settle();
  constexpr std::uint32_t row = 16;
  const unsigned parallelism = field(cr_, 8, 2);
  std::uint32_t flags = 0;
  if ((cr_ & cr_pg) == 0) {
    flags |= sr_pgserr;
  }
  // The bus splits an unaligned store into smaller ones.
  if (size != 1U << parallelism || address % size != 0) {
    flags |= sr_pgperr;
  }
  if (address % row + size > row) {
    flags |= sr_pgaerr;
  }
  if (!bit(option_bytes_, 16 + static_cast<unsigned>(sector_of(address)))) {
    flags |= sr_wrperr;
  }
  if (flags != 0) {
    fail(flags);
    return true;
  }
  const LocalTime start = std::max(chip().now(), busy_until());
  begin({.address = address, .size = size, .erase = false, .value = value, .end = start + program_time});
  chip().reschedule();
  return true;
}

std::uint32_t FlashInterface::read(std::uint32_t offset) {
  settle();
  const bool busy = !operations_.empty();
  switch (offset) {
    case acr:
      return acr_;
    case keyr:
    case optkeyr:
      return 0;  // write only
    case sr:
      return sr_ | (busy ? sr_busy : 0);
    case cr:
      return cr_ | (busy && operations_.front().erase ? cr_strt : 0);
    case optcr:
      return optcr_;
    default:
      reject_read(offset);
  }
}

void FlashInterface::write(std::uint32_t offset, std::uint32_t value) {
  settle();
  switch (offset) {
    case acr:
      write_acr(value);
      break;
    case keyr:
      check_unlock(lock_, offset, value, 0x4567'0123, 0xCDEF'89AB);
      if (lock_ == Lock::open) {
        cr_ &= ~cr_lock;
      }
      break;
    case optkeyr:
      check_unlock(option_lock_, offset, value, 0x0819'2A3B, 0x4C5D'6E7F);
      if (option_lock_ == Lock::open) {
        optcr_ &= ~optcr_lock;
      }
      break;
    case sr:
      sr_ &= ~(value & sr_flags);
      update_interrupt();
      break;
    case cr:
      write_cr(value);
      break;
    case optcr:
      write_optcr(value);
      break;
    default:
      reject_write(offset, value);
  }
}

void FlashInterface::write_acr(std::uint32_t value) {
  const unsigned states = value & 0x7U;
  const unsigned needed = flash_wait_states(chip().clocks().core, supply_mv_);
  if (states < needed) {
    reject_write(acr, value,
                 std::to_string(states) + " wait states, HCLK needs " + std::to_string(needed) + " (RM0090, table 10)");
  }
  acr_ = value & acr_bits;
  if ((value & acr_dcen) == 0 || (value & acr_dcrst) != 0) {
    clear_data_cache();
  }
}

void FlashInterface::check_unlock(Lock& lock, std::uint32_t offset, std::uint32_t value, std::uint32_t first,
                                  std::uint32_t second) {
  if (lock == Lock::open) {
    reject_write(offset, value, "it is not locked; the manual does not say what a key does then");
  }
  if (lock == Lock::locked && value == first) {
    lock = Lock::first_key_given;
  } else if (lock == Lock::first_key_given && value == second) {
    lock = Lock::open;
  } else {
    lock = Lock::until_reset;
    reject_write(offset, value, "not the key that comes next: a bus fault, and locked until reset (RM0090, 3.6.1)");
  }
}

void FlashInterface::write_cr(std::uint32_t value) {
  if (!operations_.empty()) {
    reject_write(cr, value, "written while BSY is set, which stalls the bus until the operation ends");
  }
  if ((cr_ & cr_lock) != 0) {
    if (((value ^ cr_) & (cr_kept | cr_strt)) != 0) {
      reject_write(cr, value, "it is locked");
    }
    return;
  }
  if (field(value, 8, 2) == x64) {
    reject_write(cr, value, "PSIZE x64 needs an external supply of 8 to 9 V, which the board does not have");
  }
  if (field(value, 8, 2) == x32 && (value & (cr_pg | cr_strt)) != 0 && supply_mv_ < x32_from_mv) {
    reject_write(
        cr, value,
        "PSIZE x32 at " + volts_text(supply_mv_) + ": at least " + volts_text(x32_from_mv) + " (RM0090, 3.6.2)");
  }
  cr_ = value & cr_kept;
  if ((value & cr_strt) != 0) {
    start_erase(value);
  }
  if ((value & cr_lock) != 0) {
    cr_ |= cr_lock;
    lock_ = Lock::locked;
  }
  update_interrupt();
}

void FlashInterface::start_erase(std::uint32_t value) {
  const unsigned sector = field(value, 3, 4);
  const unsigned parallelism = field(value, 8, 2);
  const std::uint32_t not_protected = field(option_bytes_, 16, 12);
  std::uint32_t address = flash_start;
  std::uint32_t size = flash_bytes;
  bool writable = not_protected == 0xFFF;
  // SER and MER together are a mass erase (RM0090, 3.6.3).
  if ((value & cr_mer) == 0) {
    if ((value & cr_ser) == 0) {
      reject_write(cr, value, "STRT without SER or MER: unpredictable (RM0090, 3.6.3)");
    }
    if (sector >= flash_sectors.size()) {
      reject_write(cr, value, "SNB = " + std::to_string(sector) + ": the last sector is 11");
    }
    address = flash_sectors[sector].start;
    size = flash_sectors[sector].size;
    writable = bit(not_protected, sector);
  }
  if (!writable) {
    fail(sr_wrperr);
    return;
  }
  begin({.address = address,
         .size = size,
         .erase = true,
         .value = 0,
         .end = chip().now() + erase_time(size, parallelism)});
}

void FlashInterface::begin(const Operation& operation) {
  operations_.push_back(operation);
  if (watch_) {
    watch_(operation.address, operation.erase);
  }
}

void FlashInterface::write_optcr(std::uint32_t value) {
  if ((optcr_ & optcr_lock) != 0) {
    if (((value ^ optcr_) & ~optcr_lock) != 0) {
      reject_write(optcr, value, "it is locked");
    }
    return;
  }
  if ((value & optcr_start) != 0) {
    reject_write(optcr, value, "programming option bytes is not modelled");
  }
  optcr_ = value & 0x0FFF'FFEDU;
  if ((value & optcr_lock) != 0) {
    option_lock_ = Lock::locked;
  }
}

}  // namespace proleg::sim
