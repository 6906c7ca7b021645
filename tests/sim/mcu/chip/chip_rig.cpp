#include "tests/sim/mcu/chip/chip_rig.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <stdexcept>

namespace proleg::sim {

const FlashImage& image(const std::string& name) {
  static std::map<std::string, std::unique_ptr<FlashImage>> images;
  std::unique_ptr<FlashImage>& found = images[name];
  if (!found) {
    found = std::make_unique<FlashImage>(std::filesystem::path(PROLEG_STM32F405_BIN) / (name + ".elf"));
  }
  return *found;
}

std::optional<bool> TestBoard::pin(char port, unsigned number) {
  if (port == 'A' && number == 5) {
    return servo_pulls_up;  // else the pull-down of the servo's line wins
  }
  if (port == 'C' && number == 13) {
    return holds_recover ? std::optional(false) : std::nullopt;
  }
  const bool closed = port == 'B' && ((unsigned{low_pins_of_b} >> number) & 1U) != 0;
  return closed ? std::optional(false) : std::nullopt;
}

void TestBoard::serial_output(unsigned usart, std::uint8_t byte) {
  EXPECT_EQ(usart, 2U);
  console.push_back(static_cast<char>(byte));
  byte_times.push_back(clock());
}

HostEnd::HostEnd(Bus& bus) : controller_(bus.attach(*this)) { controller_.set_order(Controller::Order::request); }

void HostEnd::send(const CanFrame& frame) {
  queue_.push_back(frame);
  ++on_way_;
  fill();
}

void HostEnd::transmitted(BusTime /*time*/, const CanFrame& /*frame*/) {
  --on_way_;
  fill();
}

void HostEnd::error_seen(BusTime time, bool /*was_sending*/) { last_error = time; }

void HostEnd::fill() {
  while (!queue_.empty() && controller_.send(queue_.front())) {
    queue_.pop_front();
  }
}

ChipRig::ChipRig(const RigSettings& settings)
    : bus(settings.bit_rate),
      chip(bus, board, settings.chip),
      host(bus),
      image_(image(settings.image)),
      max_lead_(settings.max_lead) {
  board.clock = [this] { return bus.now(); };
  for (const ElfImage::Segment& segment : image_.elf().segments()) {
    chip.write(segment.load_address, segment.bytes);
  }
  if (settings.record) {
    chip.write(settings_address, firmware::encode(*settings.record, 1));
  }
  bus.set_frame_listener([this](const Transmission& sent) {
    log.push_back({sent.end, sent.frame, sent.sender == host.index()});
  });
}

void ChipRig::take_step(BusTime time) {
  const BusTime change = board.next_change ? board.next_change() : time;
  const BusTime next = std::max(bus.now(), std::min({time, change, bus.next_event(), chip.next_event()}));
  chip.catch_up_before(next);
  bus.advance_to(next);
  if (chip.next_event() <= next || next == time) {
    chip.advance_to(next, std::min(bus.earliest_delivery(), next + max_lead_));
  }
  while (auto event = chip.take_event()) {
    events.push_back(std::move(*event));
  }
}

void ChipRig::run_until(BusTime time) {
  while (bus.now() < time) {
    take_step(time);
  }
}

bool ChipRig::run_until_true(const std::function<bool()>& wanted, BusTime timeout) {
  const BusTime end = bus.now() + timeout;
  while (!wanted()) {
    if (bus.now() >= end) {
      return false;
    }
    take_step(end);
  }
  return true;
}

void ChipRig::boot() {
  power_on();
  EXPECT_TRUE(run_until_true([this] { return !frames(0x700 + node).empty(); }, 50 * ms));
  run_for(20 * ms);
}

CanFrame ChipRig::transfer(const CanFrame& request) {
  const BusTime start = bus.now();
  host.send(request);
  EXPECT_TRUE(run_until_true([&] { return !frames(0x580 + node, start).empty(); }, 100 * ms));
  const std::vector<LoggedFrame> answers = frames(0x580 + node, start);
  const CanFrame answer = answers.empty() ? CanFrame{} : answers[0].frame;
  EXPECT_NE(answer.data[0], 0x80) << std::hex << unsigned{request.data[2]} << ' ' << unsigned{request.data[1]} << ':'
                                  << unsigned{request.data[3]};
  return answer;
}

std::uint32_t ChipRig::read(std::uint16_t index, std::uint8_t sub) {
  const CanFrame answer = transfer(
      {0x600 + node, 8, {0x40, static_cast<std::uint8_t>(index), static_cast<std::uint8_t>(index >> 8U), sub}});
  std::uint32_t value = 0;
  for (unsigned i = 0; i < 4; ++i) {
    value |= std::uint32_t{answer.data[4 + i]} << 8U * i;
  }
  return value;
}

void ChipRig::write(std::uint16_t index, std::uint8_t sub, unsigned size, std::uint32_t value) {
  CanFrame request{0x600 + node,
                   8,
                   {static_cast<std::uint8_t>(0x23U | (4U - size) << 2U), static_cast<std::uint8_t>(index),
                    static_cast<std::uint8_t>(index >> 8U), sub}};
  for (unsigned i = 0; i < size; ++i) {
    request.data[4 + i] = static_cast<std::uint8_t>(value >> 8U * i);
  }
  transfer(request);
}

void ChipRig::start_robot(std::uint32_t servo_period_us) {
  boot();
  start_booted_robot(servo_period_us);
}

void ChipRig::start_booted_robot(std::uint32_t servo_period_us) {
  constexpr std::uint32_t sine = 2;
  write(0x2005, 3, 4, servo_period_us);
  write(0x6080, 0, 4, 10'000);  // tests let the servo jump
  write(0x2006, 1, 1, sine);
  write(0x2007, 1, 4, 1);
  write(0x2005, 6, 1, 1);
  host.send({0x000, 2, {0x01, 0x00}});
  run_for(ms);
  write(0x1005, 0, 4, 0x4000'0080);
  EXPECT_TRUE(run_until_true([this] { return !frames(0x080).empty(); }, 200 * ms));
}

void ChipRig::enable_servo(std::int32_t target) {
  write(0x6060, 0, 1, 8);
  write(0x607A, 0, 4, static_cast<std::uint32_t>(target));
  for (const std::uint32_t controlword : {6U, 7U, 15U}) {
    write(0x6040, 0, 2, controlword);
  }
}

std::vector<LoggedFrame> ChipRig::frames(std::uint16_t identifier, BusTime since) const {
  std::vector<LoggedFrame> found;
  const auto first = std::ranges::lower_bound(log, since, {}, &LoggedFrame::time);
  std::copy_if(first, log.end(), std::back_inserter(found),
               [&](const LoggedFrame& logged) { return logged.frame.identifier == identifier && logged.time > since; });
  return found;
}

std::vector<std::uint8_t> ChipRig::memory(std::uint32_t address, std::size_t size) const {
  std::vector<std::uint8_t> bytes(size);
  chip.read(address, bytes);
  return bytes;
}

std::uint32_t ChipRig::word(std::uint32_t address) const {
  const std::vector<std::uint8_t> bytes = memory(address, 4);
  return std::uint32_t{bytes[0]} | std::uint32_t{bytes[1]} << 8U | std::uint32_t{bytes[2]} << 16U |
         std::uint32_t{bytes[3]} << 24U;
}

std::uint32_t ChipRig::address_of(const std::string& function) const { return image_.elf().symbol(function).address; }

void ChipRig::break_program(std::initializer_list<std::uint16_t> instructions) {
  std::vector<std::uint8_t> code;
  for (const std::uint16_t instruction : instructions) {
    code.push_back(static_cast<std::uint8_t>(instruction));
    code.push_back(static_cast<std::uint8_t>(instruction >> 8U));
  }
  for (const char* handler : {"pend_sv_handler", "tim5_handler"}) {
    const std::uint32_t address = address_of(handler);
    broken_.emplace_back(address, memory(address, code.size()));
    chip.write(address, code);
  }
}

void ChipRig::mend_program() {
  while (!broken_.empty()) {  // they may overlap: the last one first
    chip.write(broken_.back().first, broken_.back().second);
    broken_.pop_back();
  }
}

}  // namespace proleg::sim
