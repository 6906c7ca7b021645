// A module with ports that do nothing, and calls of all functions that a board calls: the linker keeps the program of a
// module without the drivers.

#include "firmware/module/module.hpp"
#include "shared/kernel/fingerprint.hpp"

namespace {

using proleg::CanFrame;
using proleg::firmware::Module;

struct NoPorts final : proleg::CanPort, proleg::firmware::ServoPort, proleg::firmware::ContactPort {
  bool send(const CanFrame& /*frame*/) override { return true; }
  void pulse(std::int32_t /*width*/, std::uint32_t /*period_us*/) override {}
  void off() override {}
  std::uint8_t read_contacts() override { return 0; }
};

struct NoSensors final : proleg::firmware::SensorPort {
  proleg::ServoReadings take_readings() override { return {}; }
};

struct NoFlash final : proleg::firmware::FlashPort {
  bool erase(unsigned /*sector*/) override { return false; }
  bool program(unsigned /*sector*/, std::uint32_t /*offset*/, std::span<const std::uint8_t> /*bytes*/) override {
    return false;
  }
  [[nodiscard]] std::span<const std::uint8_t> contents(unsigned /*sector*/) const override { return {}; }
};

struct NoLine final : proleg::firmware::LinePort {
  void connect(bool /*is_gateway*/) override {}
  std::size_t read_line(std::span<char> /*characters*/) override { return 0; }
  bool take_damage() override { return false; }
  std::span<char> line_room() override { return {}; }
  void send_line(std::size_t /*count*/) override {}
};

struct NoProgram final : proleg::firmware::ProgramPort {
  std::span<std::uint8_t> buffer() override { return {}; }
  [[nodiscard]] std::span<const std::uint8_t> header() const override { return {}; }
  [[nodiscard]] bool has_bootloader() const override { return true; }
  [[nodiscard]] bool is_confirmed() const override { return true; }
  void confirm() override {}
  void note_good_start() override {}
  void install(const proleg::firmware::Installation& /*what*/) override {}
  void enter_bootloader() override {}
};

NoPorts ports;
NoSensors sensors;
NoFlash flash;
NoLine line;
NoProgram program;

}  // namespace

/// The test reads the size of this object from the symbol table.
Module the_module({1, 1, {1, 2, 3}, proleg::core_fingerprint}, {ports, ports, ports, sensors, flash, &line, &program});

extern "C" {

[[gnu::used]] void module_power_on(proleg::Microseconds now) { the_module.power_on(now); }
[[gnu::used]] void module_receive(proleg::Microseconds now, const CanFrame* frame) { the_module.receive(now, *frame); }
[[gnu::used]] void module_transmitted(proleg::Microseconds now, const CanFrame* frame) {
  the_module.transmitted(now, *frame);
}
[[gnu::used]] void module_bus_off(proleg::Microseconds now) { the_module.bus_off(now); }
[[gnu::used]] void module_bus_back(proleg::Microseconds now) { the_module.bus_back(now); }
[[gnu::used]] proleg::Microseconds module_poll(proleg::Microseconds now) {
  the_module.poll(now);
  return the_module.next_deadline();
}

[[gnu::used]] bool module_serve_line(proleg::Microseconds now) { return the_module.serve_line(now); }

}  // extern "C"
