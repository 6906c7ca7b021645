// Exercises the drivers that the module's program rarely uses: writes more to the console than it has room for, then
// appends board records without end. Its power may fail at any time: it continues from the record that it finds. Its
// results are in driver_test_result.

#include "firmware/stm32f405/clock.hpp"
#include "firmware/stm32f405/hardware.hpp"
#include "firmware/stm32f405/pins.hpp"
#include "firmware/stm32f405/reset.hpp"
#include "firmware/stm32f405/vector_table.hpp"

namespace {

using namespace proleg;
using namespace proleg::stm32f405;

enum class Phase : std::uint32_t { none, started, no_clocks, flooded, appending };

struct Result {
  Phase phase = Phase::none;
  std::uint32_t found = 0;     ///< node of the newest record at the start; 0: none
  std::uint32_t appended = 0;  ///< number of records since the start, each with the next node (126 is followed by 1)
  std::uint32_t failed = 0;    ///< number of records that were not written, or did not read back as the newest
  std::uint32_t last_failure = 0;  ///< the last firmware::AppendResult that was not ok
  std::uint32_t max_append_us = 0;
  std::uint32_t deadlines = 0;  ///< number of interrupts of TIM5, one a millisecond except during an append
};

constexpr unsigned flood_lines = 100;

}  // namespace

extern "C" {

/// The results. The test reads them at any time.
[[gnu::used]] constinit volatile Result driver_test_result;

}  // extern "C"

namespace {

void add_one(volatile std::uint32_t& count) { count = count + 1; }

std::optional<firmware::BoardRecord> newest_record() {
  return firmware::newest(hardware.board_records.contents(0), hardware.board_records.contents(1));
}

/// Far more than the console's memory holds; what it takes arrives whole and in order, and nothing waits.
void flood_console() {
  for (unsigned line = 0; line < flood_lines; ++line) {
    hardware.console.write("line ");
    hardware.console.write_decimal(line);
    hardware.console.write(" of a text that is too long for its way\r\n");
  }
  driver_test_result.phase = Phase::flooded;
}

void append_next(unsigned node) {
  firmware::BoardRecord record;
  record.node = static_cast<std::uint8_t>(node);
  const std::uint32_t start = MicrosecondClock::stamp();
  const firmware::AppendResult result = append(hardware.board_records, record);
  const std::uint32_t duration = MicrosecondClock::stamp() - start;
  if (duration > driver_test_result.max_append_us) {
    driver_test_result.max_append_us = duration;
  }
  if (result == firmware::AppendResult::ok && newest_record() == record) {
    add_one(driver_test_result.appended);
  } else {
    add_one(driver_test_result.failed);
    driver_test_result.last_failure = static_cast<std::uint32_t>(result);
  }
}

}  // namespace

extern "C" {

void run_program() {
  make_hardware();
  static_cast<void>(start_watchdog(200));
  driver_test_result.phase = Phase::started;
  start_pins();
  if (start_clocks() != ClockResult::ok) {
    driver_test_result.phase = Phase::no_clocks;
    for (;;) {
    }
  }
  hardware.clock.start();
  hardware.console.start(board::apb1, board::console_baud);
  enable_interrupts();
  request_pend_sv();
  flood_console();
  const std::optional<firmware::BoardRecord> record = newest_record();
  unsigned node = record ? record->node : 0U;
  driver_test_result.found = node;
  driver_test_result.phase = Phase::appending;
  for (;;) {
    node = node % firmware::BoardRecord::max_node + 1U;
    append_next(node);
    feed_watchdog();
  }
}

void pend_sv_handler() {
  constexpr Microseconds millisecond_us = 1'000;
  add_one(driver_test_result.deadlines);
  if (!MicrosecondClock::wake_at(hardware.clock.now() + millisecond_us)) {
    request_pend_sv();
  }
}

}  // extern "C"
