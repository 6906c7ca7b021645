#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <iterator>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "sim/mcu/debug/debug_target.hpp"

namespace proleg::sim {

/// Memory and registers without a CPU. An instruction is two bytes long and does nothing; when it runs, it comes to the
/// next breakpoint behind it, or else to the first one.
class FakeTarget final : public DebugTarget {
 public:
  static constexpr std::uint32_t flash = 0x0800'0000;
  static constexpr std::uint32_t ram = 0x2000'0000;
  static constexpr std::size_t size = 0x1'0000;

  [[nodiscard]] std::uint32_t core_register(unsigned number) const override { return registers.at(number); }
  void set_core_register(unsigned number, std::uint32_t value) override { registers.at(number) = value; }

  [[nodiscard]] bool read_memory(std::uint32_t address, std::span<std::uint8_t> bytes) const override {
    ++reads;
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      const auto [block, offset] = place(address + i);
      if (block == memory.end()) {
        return false;
      }
      bytes[i] = block->second[offset];
    }
    return true;
  }

  [[nodiscard]] bool write_memory(std::uint32_t address, std::span<const std::uint8_t> bytes) override {
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      const auto [block, offset] = place(address + i);
      if (block == memory.end()) {
        return false;
      }
      memory.at(block->first)[offset] = bytes[i];
    }
    return true;
  }

  void set_breakpoints(std::span<const std::uint32_t> addresses) override {
    EXPECT_TRUE(std::is_sorted(addresses.begin(), addresses.end()));
    EXPECT_EQ(std::adjacent_find(addresses.begin(), addresses.end()), addresses.end());
    breakpoints.assign(addresses.begin(), addresses.end());
    ++breakpoint_calls;
  }

  void step() { registers[program_counter] += 2; }

  /// True if a breakpoint was reached.
  bool run_slice() {
    if (breakpoints.empty()) {
      step();
      return false;
    }
    const auto next = std::upper_bound(breakpoints.begin(), breakpoints.end(), registers[program_counter]);
    registers[program_counter] = next == breakpoints.end() ? breakpoints.front() : *next;
    return true;
  }

  using Memory = std::map<std::uint32_t, std::vector<std::uint8_t>>;

  std::array<std::uint32_t, register_count> registers{};
  Memory memory{{flash, std::vector<std::uint8_t>(size, 0xFF)}, {ram, std::vector<std::uint8_t>(size, 0)}};
  std::vector<std::uint32_t> breakpoints;
  int breakpoint_calls = 0;
  mutable int reads = 0;

 private:
  [[nodiscard]] std::pair<Memory::const_iterator, std::size_t> place(std::uint64_t address) const {
    for (auto block = memory.begin(); block != memory.end(); ++block) {
      if (address >= block->first && address - block->first < block->second.size()) {
        return {block, address - block->first};
      }
    }
    return {memory.end(), 0};
  }
};

}  // namespace proleg::sim
