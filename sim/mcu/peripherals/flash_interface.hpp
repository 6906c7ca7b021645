#pragma once

// The flash memory interface FLASH (RM0090, section 3): unlocking, erasing, programming. The caller stores the
// contents. Durations are those of the datasheet (DS8626, table "Flash memory programming").

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "sim/mcu/peripherals/register_block.hpp"

namespace proleg::sim {

/// The cells of the flash, at addresses from flash_start on.
class FlashMemory {
 public:
  virtual void read(std::uint32_t address, std::span<std::uint8_t> bytes) = 0;
  virtual void write(std::uint32_t address, std::span<const std::uint8_t> bytes) = 0;

 protected:
  ~FlashMemory() = default;
};

/// Sectors of the 1 MB device (RM0090, table 5).
struct FlashSector {
  std::uint32_t start;
  std::uint32_t size;  ///< bytes
};
inline constexpr std::uint32_t flash_start = 0x0800'0000;
inline constexpr std::array<FlashSector, 12> flash_sectors = [] {
  constexpr std::uint32_t kib = 1024;
  std::array<FlashSector, 12> sectors{};
  std::uint32_t start = flash_start;
  for (std::size_t i = 0; i < sectors.size(); ++i) {
    const std::uint32_t size = i < 4 ? 16 * kib : i == 4 ? 64 * kib : 128 * kib;
    sectors[i] = {start, size};
    start += size;
  }
  return sectors;
}();

/// How fast the flash is from a supply voltage on (RM0090, table 10; below 1.8 V it is not specified).
struct FlashSpeed {
  std::uint32_t from_mv;
  std::uint32_t mhz_per_state;  ///< HCLK for each wait state, and without one
  std::uint32_t max_mhz;        ///< highest HCLK
  bool may_prefetch;
};
inline constexpr std::uint32_t rated_supply_mv = 3'300;
[[nodiscard]] constexpr FlashSpeed flash_speed(std::uint32_t supply_mv) {
  constexpr FlashSpeed speeds[] = {{2'700, 30, 168, true}, {2'400, 24, 168, true}, {2'100, 22, 168, true}};
  for (const FlashSpeed& speed : speeds) {
    if (supply_mv >= speed.from_mv) {
      return speed;
    }
  }
  return {1'800, 20, 160, false};
}

/// Wait states that HCLK needs.
[[nodiscard]] constexpr unsigned flash_wait_states(LocalTime core_period, std::uint32_t supply_mv = rated_supply_mv) {
  const LocalTime mhz_per_state = flash_speed(supply_mv).mhz_per_state;
  // f <= mhz_per_state * (states + 1), with f = 1008 MHz / period.
  return static_cast<unsigned>((local_time_per_us + mhz_per_state * core_period - 1) / (mhz_per_state * core_period)) -
         1;
}

class FlashInterface final : public RegisterBlock {
 public:
  static constexpr unsigned interrupt_position = 4;
  /// Time to program a word. An access during an operation waits; contents change when the operation ends.
  static constexpr LocalTime program_time = 16 * local_time_per_us;  ///< typical; 100 us at most

  /// protected_sectors: if bit n is 1, sector n cannot be erased or programmed (option bytes nWRP, which a programmer
  /// set).
  FlashInterface(ChipServices& chip, FlashMemory& memory, std::uint16_t protected_sectors = 0);

  /// Sets the option bytes BOR_LEV, as a programmer does: 0: level 3, the highest, 1: level 2, 2: level 1, 3: off.
  void set_brown_out_level(unsigned level);
  [[nodiscard]] unsigned brown_out_level() const;

  [[nodiscard]] std::uint32_t read(std::uint32_t offset) override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  /// Resets the registers and drops an operation that is under way: call cut() first.
  void reset() override;
  [[nodiscard]] LocalTime next_event() const override;
  void advance() override;
  [[nodiscard]] bool is_idle() const override { return true; }  // its own oscillator times the operations

  /// Stores a value of the program to flash; size: 1, 2, 4. Returns false if the address is not in flash. FLASH_SR
  /// reports what the hardware rejects; the store itself ends without a fault (RM0090, 3.6.4). A store during an
  /// operation is done after it, as if the bus had stalled the program.
  [[nodiscard]] bool program(std::uint32_t address, unsigned size, std::uint32_t value);

  /// End of the operations under way: until then a read, a fetch or another store of flash stalls the bus (single
  /// bank). The flash is not busy if this time is not in the future.
  [[nodiscard]] LocalTime busy_until() const;

  /// Called when the program has begun an operation at an address. erase: it erases the sector there; else it programs.
  using Watch = std::function<void(std::uint32_t address, bool erase)>;
  void set_watch(Watch watch) { watch_ = std::move(watch); }

  /// Power fails, or a reset comes (RM0090, 3.6.3: contents are not guaranteed): the operation under way stays half
  /// done. An erase leaves some bits of each word 1; programming leaves 0 some of the bits that must become 0. The same
  /// seed leaves the same bits. Changes nothing if no operation is under way.
  void cut(std::uint64_t seed);

  /// Makes a word weak: these bits of its cells cannot be programmed to 0 any more. address: a multiple of 4. The
  /// program reads what it has written as long as the data cache is on and was not cleared, since programming changes
  /// the cache, too (RM0090, 3.6.4): as if the word were always in it.
  void set_weak_word(std::uint32_t address, std::uint32_t bits);

  void set_supply(std::uint32_t mv) { supply_mv_ = mv; }
  /// Why the flash cannot follow this HCLK at the present voltage, with the wait states and the prefetch that the
  /// program has set: "HCLK of 168 MHz at 2.5 V needs 6 wait states, FLASH_ACR has 5 (RM0090, table 10)". A chip would
  /// execute wrong instructions.
  [[nodiscard]] std::optional<std::string> speed_fault(LocalTime core_period) const;

  /// Wait states that the program has set (FLASH_ACR.LATENCY).
  [[nodiscard]] unsigned wait_states() const { return acr_ & 0x7U; }

 private:
  enum class Lock : std::uint8_t { locked, first_key_given, open, until_reset };
  struct Operation {
    std::uint32_t address;
    std::uint32_t size;  ///< bytes
    bool erase;          ///< else the bits of `value` that are 0 are cleared
    std::uint32_t value;
    LocalTime end;
  };

  void begin(const Operation& operation);
  void settle();
  void finish(const Operation& operation);
  /// The data cache has no word any more: the program reads the cells.
  void clear_data_cache();
  void fail(std::uint32_t flags);
  void start_erase(std::uint32_t value);
  void write_acr(std::uint32_t value);
  void write_cr(std::uint32_t value);
  void check_unlock(Lock& lock, std::uint32_t offset, std::uint32_t value, std::uint32_t first, std::uint32_t second);
  void write_optcr(std::uint32_t value);
  void update_interrupt();

  struct WeakWord {
    std::uint32_t address;
    std::uint32_t bits;
    std::optional<std::uint32_t> cells;  ///< what they contain if the data cache has something else
  };

  FlashMemory* memory_;
  std::uint32_t supply_mv_ = rated_supply_mv;
  std::uint32_t option_bytes_;  ///< as OPTCR shows them after reset
  InterruptLine interrupt_;
  std::optional<WeakWord> weak_;
  std::uint32_t acr_ = 0;
  std::uint32_t sr_ = 0;
  std::uint32_t cr_ = 0;
  std::uint32_t optcr_ = 0;
  Lock lock_ = Lock::locked;
  Lock option_lock_ = Lock::locked;
  std::deque<Operation> operations_;  ///< one after the other
  Watch watch_;
};

}  // namespace proleg::sim
