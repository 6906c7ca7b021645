#include "tests/sim/mcu/chip/driver_tests.hpp"

#include <algorithm>
#include <span>
#include <vector>

namespace proleg::sim {
namespace {

RigSettings settings() {
  RigSettings settings;
  settings.image = "driver_tests";
  settings.record.reset();
  settings.max_lead = 20 * us;  // the bus is silent
  return settings;
}

}  // namespace

DriverTests::DriverTests()
    : rig_(settings()), result_address_(image("driver_tests").elf().symbol("driver_test_result").address) {}

DriverTests::Result DriverTests::result() const {
  const auto word = [this](unsigned i) { return rig_.word(result_address_ + 4 * i); };
  return {word(0), word(1), word(2), word(3), word(4), word(5), word(6)};
}

unsigned DriverTests::newest_node() const {
  const std::vector<std::uint8_t> log = rig_.memory(ChipRig::settings_address, ChipRig::settings_size);
  const std::span<const std::uint8_t> all(log);
  const auto record = firmware::newest(all.first(sector_size), all.subspan(sector_size));
  return record ? record->node : 0U;
}

void DriverTests::nearly_fill_log() {
  std::vector<std::uint8_t> log(ChipRig::settings_size, 0xFF);
  const auto put = [&log](std::uint32_t address, unsigned node, std::uint32_t sequence) {
    const auto bytes = firmware::encode({static_cast<std::uint8_t>(node), false, 0, 0}, sequence);
    std::ranges::copy(bytes, log.begin() + (address - ChipRig::settings_address));
  };
  std::uint32_t sequence = oldest_sequence;
  confirmed_ = 1;
  put(second_sector, confirmed_, sequence);
  for (std::uint32_t place = ChipRig::settings_address; place < last_place; place += firmware::BoardRecord::size) {
    confirmed_ = node_after(confirmed_);
    put(place, confirmed_, ++sequence);
  }
  rig_.chip.write(ChipRig::settings_address, log);
}

DriverTests::Cut DriverTests::cut_power_after(BusTime time) {
  rig_.run_for(time);
  const Result before = result();
  Cut cut{before.phase == appending, false, false};
  if (cut.was_appending) {
    EXPECT_EQ(before.found, confirmed_);
    EXPECT_EQ(before.failed, 0U) << before.last_failure;
    for (unsigned i = 0; i < before.appended; ++i) {
      confirmed_ = node_after(confirmed_);
    }
    cut.had_erased = before.max_append_us > 200'000;
  }
  rig_.power_on();
  const unsigned found = newest_node();
  EXPECT_TRUE(found == confirmed_ || found == node_after(confirmed_))
      << "found " << found << ", expected " << confirmed_ << " or the next";
  cut.has_new_record = found != confirmed_;
  confirmed_ = found;
  return cut;
}

}  // namespace proleg::sim
