#pragma once

// The image driver_tests in a chip: it floods the console, then appends board records to the log in the chip's flash,
// without end.

#include <gtest/gtest.h>

#include <cstdint>

#include "tests/sim/mcu/chip/chip_rig.hpp"

namespace proleg::sim {

class DriverTests : public testing::Test {
 protected:
  static constexpr std::uint32_t appending = 4;  ///< Phase of driver_tests.cpp
  static constexpr std::uint32_t sector_size = ChipRig::settings_size / 2;
  static constexpr std::uint32_t second_sector = ChipRig::settings_address + sector_size;
  /// The only free place of the log after nearly_fill_log().
  static constexpr std::uint32_t last_place = second_sector - firmware::BoardRecord::size;

  static constexpr std::uint32_t oldest_sequence = 1;

  /// driver_test_result, as driver_tests.cpp declares it.
  struct Result {
    std::uint32_t phase, found, appended, failed, last_failure, max_append_us, deadlines;
  };
  /// What a program did until its power failed, and what is in flash then.
  struct Cut {
    bool was_appending;
    bool has_new_record;  ///< the record that was being written is the newest
    bool had_erased;
  };

  DriverTests();

  [[nodiscard]] Result result() const;
  /// Node of the newest record in flash; 0: there is none.
  [[nodiscard]] unsigned newest_node() const;
  /// Node of the record that the program appends to one of this node.
  [[nodiscard]] static unsigned node_after(unsigned node) { return node % firmware::BoardRecord::max_node + 1; }

  /// Fills the first sector of the log except for one record. The second sector holds the oldest record: it is erased
  /// when the first sector is full.
  void nearly_fill_log();
  /// Lets the program run for a time, cuts its power and switches it on again. Expects that the program has found the
  /// record of the cut before, and that the newest record is the last one that was complete, or the one after it.
  Cut cut_power_after(BusTime time);

  ChipRig rig_;
  std::uint32_t result_address_;
  unsigned confirmed_ = 0;  ///< node of the newest record at the last start
};

}  // namespace proleg::sim
