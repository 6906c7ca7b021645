#pragma once

// A gateway module with a host on its serial line, and other modules on the bus, without a robot.

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sim/bus/bus.hpp"
#include "sim/hardware_loop/hardware_options.hpp"
#include "sim/hardware_loop/native_module.hpp"
#include "sim/serial/serial_line.hpp"

namespace proleg::sim {

/// A host that sends what the test gives it, and keeps what it receives.
class ScriptedHost : public SerialHost {
 public:
  virtual ~ScriptedHost() = default;
  void received(BusTime time, std::uint8_t byte) override {
    text.push_back(static_cast<char>(byte));
    last_end = time;
    ++characters;
  }
  [[nodiscard]] BusTime next_event() const override { return sender.next_event(); }
  [[nodiscard]] std::optional<SerialCharacter> take(BusTime now) override { return sender.take(now); }
  [[nodiscard]] BusTime bit_time() const override { return sender.bit_time(); }

  /// What came since the last call.
  [[nodiscard]] std::string take_text() { return std::exchange(text, {}); }

  SerialSender sender{1'000'000};
  std::string text;
  BusTime last_end = 0;  ///< of the last character
  std::uint64_t characters = 0;
};

/// The lines in a text, each with its end (CR or BEL).
inline std::vector<std::string> lines_of(std::string_view text) {
  std::vector<std::string> lines(1);
  for (const char character : text) {
    lines.back().push_back(character);
    if (character == '\r' || character == '\a') {
      lines.emplace_back();
    }
  }
  lines.pop_back();  // one that is not complete
  return lines;
}

/// "t5838430010..." as slcan writes a frame.
inline std::string line_of(const CanFrame& frame) {
  constexpr const char* digits = "0123456789ABCDEF";
  std::string line = "t";
  for (unsigned shift = 12; shift > 0; shift -= 4) {
    line.push_back(digits[frame.identifier >> (shift - 4) & 15U]);
  }
  line.push_back(digits[frame.length]);
  for (const std::uint8_t byte : frame.bytes()) {
    line.push_back(digits[byte >> 4U]);
    line.push_back(digits[byte & 15U]);
  }
  return line + "\r";
}

class GatewayBench {
 public:
  static constexpr BusTime us = 1'000;
  static constexpr BusTime ms = 1'000 * us;
  static constexpr std::uint8_t gateway_node = 4;
  static constexpr std::uint8_t other_node = 9;

  using MakeModule = std::function<std::unique_ptr<JointModule>(const ModuleParts& parts)>;

  static std::unique_ptr<JointModule> make_native(const ModuleParts& parts) {
    return std::make_unique<NativeModule>(parts.bus, parts.identity, parts.crystal, parts.sensors, parts.take_readings,
                                          parts.is_gateway);
  }

  /// make: makes the gateway; the other module is native.
  explicit GatewayBench(const MakeModule& make = make_native, bool is_gateway = true) {
    bus.set_frame_listener([this](const Transmission& sent) { log.push_back(sent); });
    add(make, gateway_node, is_gateway);
    add(make_native, other_node, false);
    gateway().set_serial_watch([this](BusTime time, std::uint8_t byte) { host.received(time, byte); });
  }

  [[nodiscard]] JointModule& gateway() { return *modules[0]; }

  void power_on() {
    for (const auto& module : modules) {
      module->power_on(bus.now());
    }
    run_for(40 * ms);
  }
  /// With an open channel; what was received so far is forgotten.
  void open() {
    power_on();
    write("\r\r\rC\rS8\rO\r");
    run_for(10 * ms);
    static_cast<void>(host.take_text());
  }
  void write(std::string_view characters) { host.sender.send(bus.now(), characters); }
  /// What the host receives after it has sent this.
  std::string ask(std::string_view characters, BusTime time = 5 * ms) {
    static_cast<void>(host.take_text());
    write(characters);
    run_for(time);
    return host.take_text();
  }
  void run_for(BusTime time) {
    const BusTime end = bus.now() + time;
    while (bus.now() < end) {
      step(end);
    }
  }

  Bus bus;
  ScriptedHost host;
  std::vector<std::unique_ptr<JointModule>> modules;
  std::vector<Transmission> log;

 private:
  void add(const MakeModule& make, std::uint8_t node, bool is_gateway) {
    const auto readings = [] { return ServoReadings{}; };
    ModuleParts parts{bus,
                      static_cast<unsigned>(modules.size()),
                      {},
                      Crystal(node * 10'000 - 50'000),
                      [] { return std::uint8_t{0}; },
                      readings,
                      readings,
                      is_gateway};
    parts.identity.node = node;
    parts.identity.unique_id = {0x1234'5678U * node, node, 0xFEDC'BA98U};
    modules.push_back(make(parts));
  }
  void step(BusTime end) {
    BusTime next = std::min({end, bus.next_event(), host.next_event()});
    for (const auto& module : modules) {
      next = std::min(next, module->next_event());
    }
    next = std::max(next, bus.now());
    bus.advance_to(next);
    while (const auto character = host.take(next)) {
      gateway().begin_serial_input(next, *character, host.bit_time());
    }
    for (const auto& module : modules) {
      if (module->next_event() <= next) {
        module->advance_to(next, std::min({bus.earliest_delivery(), next + us, host.next_event()}));
      }
    }
  }
};

/// No node acknowledges; then the bus is stuck, and good again.
inline void expect_lines_of_bus_states(GatewayBench& bench) {
  bench.open();
  bench.bus.controller(1).switch_off();  // no node acknowledges
  bench.write("t60984000100000000000\r");
  bench.run_for(200 * GatewayBench::ms);
  const auto lines = lines_of(bench.host.take_text());
  EXPECT_EQ(lines.front(), "z\r");
  EXPECT_TRUE(std::ranges::any_of(lines, [](const std::string& line) { return line.starts_with("sp"); }));
  EXPECT_TRUE(std::ranges::any_of(lines, [](const std::string& line) { return line == "e1a\r"; }));
  bench.bus.controller(1).switch_on();
  bench.run_for(50 * GatewayBench::ms);
  static_cast<void>(bench.host.take_text());

  bench.write("t60984000100000000000\r");
  bench.run_for(300 * GatewayBench::us);
  bench.bus.hold_dominant(true);
  bench.run_for(5 * GatewayBench::ms);
  const std::string off = bench.host.take_text();
  bench.bus.hold_dominant(false);
  bench.run_for(200 * GatewayBench::ms);
  const std::string on = bench.host.take_text();
  EXPECT_NE(off.find("sb"), std::string::npos) << off;
  EXPECT_NE(on.find("sa000000\r"), std::string::npos) << on;
  EXPECT_NE(bench.ask("t60984000100000000000\r").find("t58984300100092010200\r"), std::string::npos);
}

/// While characters go in both directions.
inline void expect_restart_closes_channel(GatewayBench& bench) {
  bench.open();
  for (unsigned i = 0; i < 100; ++i) {
    bench.write("t6E081122334455667788\r");
  }
  bench.run_for(5 * GatewayBench::ms);
  bench.gateway().power_on(bench.bus.now());
  bench.run_for(50 * GatewayBench::ms);
  static_cast<void>(bench.host.take_text());
  bench.run_for(50 * GatewayBench::ms);
  EXPECT_EQ(bench.host.take_text(), "");
  EXPECT_EQ(bench.ask("\r\rt60484000100000000000\r").back(), '\a');
  EXPECT_EQ(bench.ask("O\r"), "\r");
  EXPECT_EQ(bench.ask("t60484000100000000000\r"), "z\rt58484300100092010200\r");
}

/// A host's conversation with a gateway: everything that slcan has, with wrong lines and a line that fails. Each answer
/// comes before the next line is sent, so that the text depends on no microsecond.
inline std::string hold_conversation(GatewayBench& bench) {
  constexpr BusTime ms = GatewayBench::ms;
  bench.power_on();
  static_cast<void>(bench.host.take_text());
  const std::string too_long(2'000, 'A');
  const std::initializer_list<std::string_view> lines{"t60484000100000000000\r",  // closed
                                                      "\r\r\r",
                                                      "C\r",
                                                      "V\r",
                                                      "N\r",
                                                      "F\r",
                                                      "S8\r",
                                                      "S6\r",
                                                      "O\r",
                                                      "O\r",
                                                      "t60484018100400000000\r",  // own serial number
                                                      "t60984018100400000000\r",  // that of the other module
                                                      "t60484008100000000000\r",  // device name, in segments
                                                      "t60486000000000000000\r",
                                                      "t60487000000000000000\r",
                                                      "t60482B1710006400000\r",   // a digit is missing
                                                      "t60482B17100064000000\r",  // heartbeat of the gateway: 100 ms
                                                      "t0002020\r",
                                                      "t0002\r",
                                                      "T000000010\r",
                                                      "r7048\r",
                                                      "hello\r",
                                                      "t80001\r",
                                                      "\x01\xFF\x80garbage\a\r",
                                                      too_long,
                                                      "\r",
                                                      "t60482B17100000000000\r",  // no heartbeat
                                                      "Z1\r",
                                                      "Z0\r",
                                                      "t7E5804000000000000\r",
                                                      "t0002810A\r",
                                                      "t00028104\r",
                                                      "t60484018100400000000\r",
                                                      "F\r"};
  std::string text;
  for (const std::string_view line : lines) {
    bench.write(line);
    bench.run_for(40 * ms);
    text += bench.host.take_text();
  }
  // A break, and a character at another baud rate.
  bench.host.sender.send(bench.bus.now(), SerialCharacter{0, false});
  bench.run_for(ms);
  bench.gateway().begin_serial_input(bench.bus.now(), {'t'}, 8'681);
  bench.run_for(10 * ms);
  for (const std::string_view line : {"\r", "t60484018100400000000\r", "L\r", "C\r", "t00028109\r", "L\r",
                                      "t00028109\r", "C\r", "O\r", "t00028109\r"}) {
    bench.write(line);
    bench.run_for(40 * ms);
    text += bench.host.take_text();
  }
  return text;
}

}  // namespace proleg::sim
