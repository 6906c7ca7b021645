#pragma once

// A crawling robot with a gateway, and what its line must never change.

#include <random>
#include <set>

#include "gateway_bench.hpp"
#include "shipped.hpp"
#include "sim/hardware_loop/hardware_loop.hpp"
#include "sim/loop/simulation.hpp"

namespace proleg::sim {

using MakeJointModule = std::function<std::unique_ptr<JointModule>(const ModuleParts&)>;

inline constexpr unsigned gateway_joint = HardwareLoop::sync_producer;

/// A host that opens the channel when the robot is set up and moves. (A master on the bus sends more while it sets the
/// robot up than the line can carry.)
struct OpeningHost : ScriptedHost {
  static constexpr BusTime opens_at = 300'000'000;
  OpeningHost() { sender.send(opens_at, "\rC\rS8\rO\r"); }
  void received(BusTime time, std::uint8_t byte) override {
    if (time > opens_at) {  // before, a chip prints that it has started
      ScriptedHost::received(time, byte);
    }
  }
};

/// The same, and it then sends without end, as fast as the line allows.
class FloodingHost final : public OpeningHost {
 public:
  FloodingHost(std::uint32_t seed, std::function<std::string(std::mt19937&)> make_line)
      : random_(seed), make_line_(std::move(make_line)) {}
  [[nodiscard]] std::optional<SerialCharacter> take(BusTime now) override {
    if (sender.pending() < 2) {
      sender.send(now, make_line_(random_));
    }
    return sender.take(now);
  }

 private:
  std::mt19937 random_;
  std::function<std::string(std::mt19937&)> make_line_;
};

struct GatewayRun {
  std::uint64_t differences = 0;
  std::string setpoints;
  std::string servo_commands;
  std::vector<Transmission> frames;  ///< on the bus
  std::size_t failures = 0;
  std::vector<std::string> problems;
};

inline GatewayRun run_with_host(ScriptedHost& host, const MakeJointModule& make, std::uint32_t ticks,
                                std::vector<InjectedFrame> injected = {}) {
  const Scenario scenario = shipped("travelling_wave/coupled");
  GatewayRun result;
  HardwareOptions options;
  options.make_module = make;
  options.gateway = {gateway_joint, &host};
  options.injected = std::move(injected);
  options.on_frame = [&result](const Transmission& sent) { result.frames.push_back(sent); };
  HardwareLoop loop(scenario, std::move(options));
  while (loop.tick() < ticks) {
    loop.advance();
  }
  result.differences = loop.differences();
  result.setpoints = loop.setpoint_hash().hex();
  result.servo_commands = loop.servo_hash().hex();
  result.failures = loop.failures().size();
  for (const ModuleProblem& problem : loop.problems()) {
    result.problems.push_back(problem.text);
  }
  return result;
}

/// The gait without any bus.
inline void expect_gait_as_simulated(const GatewayRun& run, std::uint32_t ticks) {
  const Scenario scenario = shipped("travelling_wave/coupled");
  Simulation simulation(scenario);
  while (simulation.tick() < ticks) {
    simulation.advance();
  }
  EXPECT_EQ(run.differences, 0U);
  EXPECT_EQ(run.setpoints, simulation.setpoint_hash().hex());
  EXPECT_EQ(run.servo_commands, simulation.servo_hash().hex());
  EXPECT_EQ(run.failures, 0U);
  EXPECT_TRUE(run.problems.empty()) << run.problems.front();
}

/// Lines that are frames, whole and in order; others are answers.
inline std::vector<std::string> frame_lines(const std::string& text) {
  std::vector<std::string> lines;
  for (const std::string& line : lines_of(text)) {
    if (line.starts_with("t")) {
      lines.push_back(line);
    }
  }
  return lines;
}

inline void expect_every_frame_on_the_line(const MakeJointModule& make, std::uint32_t ticks) {
  OpeningHost host;
  const GatewayRun run = run_with_host(host, make, ticks);
  expect_gait_as_simulated(run, ticks);
  const std::vector<std::string> lines = frame_lines(host.text);
  ASSERT_FALSE(lines.empty());
  std::vector<std::string> on_bus;
  for (const Transmission& sent : run.frames) {
    on_bus.push_back(line_of(sent.frame));
  }
  const auto first = std::search(on_bus.begin(), on_bus.end(), lines.begin(),
                                 lines.begin() + std::min<std::ptrdiff_t>(50, std::ssize(lines)));
  ASSERT_NE(first, on_bus.end());
  constexpr BusTime opened = OpeningHost::opens_at + 1'000'000;
  ASSERT_NE(first, on_bus.begin());
  EXPECT_LE(run.frames[static_cast<std::size_t>(first - on_bus.begin()) - 1].end, opened) << "none before is missing";
  const auto missing = on_bus.end() - first - std::ssize(lines);
  EXPECT_GE(missing, 0);
  EXPECT_LT(missing, 50) << "the last ones, which are still to be sent";
  EXPECT_TRUE(std::equal(lines.begin(), lines.end(), first));
  std::cout << lines.size() << " frames, " << host.characters << " characters in "
            << static_cast<double>(host.last_end) * 1e-9 << " s\n";
}

/// Of identifiers that no module uses, and NMT without contents: they win the bus against everything.
inline std::string harmless_line(std::mt19937& random) {
  const auto below = [&random](unsigned end) { return static_cast<unsigned>(random() % end); };
  const unsigned kind = below(4);
  if (kind == 0) {
    return "t0000\r";
  }
  const std::array<unsigned, 3> identifiers{1 + below(0x7F), 0x480 + below(0x80), 0x6E0 + below(16)};
  const unsigned identifier = identifiers.at(kind - 1);
  CanFrame frame{static_cast<std::uint16_t>(identifier), static_cast<std::uint8_t>(below(9)), {}};
  for (unsigned i = 0; i < frame.length; ++i) {
    frame.data[i] = static_cast<std::uint8_t>(random());
  }

  return line_of(frame);
}

inline void expect_flood_changes_nothing(const MakeJointModule& make, std::uint32_t ticks) {
  constexpr std::uint32_t seed = 14;
  SCOPED_TRACE("seed " + std::to_string(seed));
  // From the bus: more than the line can carry.
  std::vector<InjectedFrame> injected;
  for (std::uint32_t tick = 40; tick < ticks; ++tick) {
    for (unsigned i = 0; i < 25; ++i) {
      injected.push_back({tick, {static_cast<std::uint16_t>(0x7F0 + i % 8), 8, {1, 2, 3, 4, 5, 6, 7, 8}}});
    }
  }
  FloodingHost host(seed, harmless_line);
  const GatewayRun run = run_with_host(host, make, ticks, std::move(injected));
  expect_gait_as_simulated(run, ticks);
  std::size_t from_line = 0;
  BusTime last_of_line = 0;
  BusTime last_sync = 0;
  for (const Transmission& sent : run.frames) {
    const unsigned identifier = sent.frame.identifier;
    if (sent.frame.identifier == 0x080) {
      if (last_sync != 0) {
        // One frame that is on the wire, and one of the host with a lower identifier; at either end.
        EXPECT_NEAR(static_cast<double>(sent.start - last_sync), 10e6, 2 * 135e3);
      }
      last_sync = sent.start;
    } else if (sent.start > OpeningHost::opens_at &&
               (identifier < 0x80 || (identifier >= 0x480 && identifier < 0x500) || identifier >> 4U == 0x6E)) {
      ++from_line;
      if (last_of_line != 0) {
        EXPECT_GE(sent.start, last_of_line + 295'000) << "the gap that the gateway leaves";
      }
      last_of_line = sent.end;
    }
  }
  EXPECT_GT(from_line, ticks * 15) << "the line has its share";
  for (const std::string& line : lines_of(host.text)) {
    EXPECT_TRUE(line == "z\r" || line == "\a" || line == "\r" || (line.starts_with("t") && line.size() % 2 == 0))
        << "a line that is not whole: " << line;
  }
  std::cout << from_line << " frames of the line on the bus, " << host.characters << " characters to the host\n";
}

inline void expect_noise_changes_nothing(const MakeJointModule& make, std::uint32_t ticks) {
  constexpr std::uint32_t seed = 15;
  SCOPED_TRACE("seed " + std::to_string(seed));
  FloodingHost host(seed, [](std::mt19937& random) {
    std::string text(1 + random() % 60, ' ');
    for (char& character : text) {
      character = static_cast<char>(random());
    }
    return text;
  });
  const GatewayRun run = run_with_host(host, make, ticks);
  expect_gait_as_simulated(run, ticks);
}

}  // namespace proleg::sim
