#pragma once

// The memory protection unit MPU (ARMv7-M Architecture Reference Manual, DDI 0403, B3.5), as far as a program needs it
// to forbid accesses below its stack: regions without access in ChipMemory::reserved_start. All others are rejected.

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "sim/mcu/cpu/cpu_surroundings.hpp"

namespace proleg::sim {

class MemoryProtection {
 public:
  static constexpr std::uint32_t type = 0x0000'0800;  ///< MPU_TYPE: 8 regions

  [[nodiscard]] std::uint32_t control() const { return control_; }
  [[nodiscard]] std::uint32_t number() const { return number_; }
  [[nodiscard]] std::uint32_t base() const { return regions_.at(number_).base | number_; }
  [[nodiscard]] std::uint32_t attributes() const { return regions_.at(number_).attributes; }

  void write_control(std::uint32_t value) { control_ = value & 7U; }
  void write_number(std::uint32_t value) { number_ = value % region_count; }
  void write_base(std::uint32_t value) {
    if ((value & base_valid) != 0) {
      number_ = value % region_count;
    }
    regions_.at(number_).base = value & ~31U;
  }
  void write_attributes(std::uint32_t value) { regions_.at(number_).attributes = value; }

  /// What of the present settings is not modelled.
  [[nodiscard]] std::optional<std::string> obstacle() const {
    if ((control_ & enable) == 0) {
      return std::nullopt;
    }
    if ((control_ & background) == 0) {
      return "MPU_CTRL without PRIVDEFENA is not modelled";
    }
    for (const Region& region : regions_) {
      const bool is_reserved = region.base >= ChipMemory::reserved_start &&
                               region.base + region.bytes() <= ChipMemory::reserved_start + ChipMemory::reserved_size;
      if (region.is_enabled() && (!is_reserved || (region.attributes & access_and_subregions) != 0)) {
        return "only regions of the MPU without access, just below the RAM, are modelled";
      }
    }
    return std::nullopt;
  }

  /// Whether accesses to the address are forbidden.
  [[nodiscard]] bool forbids(std::uint32_t address) const {
    bool is_in_region = false;
    for (const Region& region : regions_) {
      is_in_region =
          is_in_region || (region.is_enabled() && address >= region.base && address - region.base < region.bytes());
    }
    return (control_ & enable) != 0 && is_in_region;
  }

 private:
  static constexpr std::uint32_t region_count = 8;
  static constexpr std::uint32_t enable = 1U << 0U;
  static constexpr std::uint32_t background = 1U << 2U;  ///< PRIVDEFENA
  static constexpr std::uint32_t base_valid = 1U << 4U;
  static constexpr std::uint32_t access_and_subregions = 7U << 24U | 0xFFU << 8U;  ///< AP, SRD

  struct Region {
    std::uint32_t base = 0;
    std::uint32_t attributes = 0;

    [[nodiscard]] bool is_enabled() const { return (attributes & 1U) != 0; }
    [[nodiscard]] std::uint64_t bytes() const { return std::uint64_t{2} << (attributes >> 1U & 31U); }
  };

  std::uint32_t control_ = 0;
  std::uint32_t number_ = 0;
  std::array<Region, region_count> regions_{};
};

}  // namespace proleg::sim
