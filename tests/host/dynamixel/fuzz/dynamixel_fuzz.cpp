// Answers of servos that are not what they should be. The parser reports only packets that are in its input. A chain
// with emulated servos whose answers are changed by the input throws one-line errors, keeps its deadlines, and never
// commands an angle outside of the limits of a joint.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>

#include "host/dynamixel/servo_chain.hpp"
#include "tests/host/dynamixel/chain_rig.hpp"
#include "tests/support/fuzz_input.hpp"

namespace {

using namespace proleg;
using test::Bytes;
using test::FuzzInput;
using test::require;

void parse(std::span<const std::uint8_t> bytes) {
  host::StatusParser parser;
  for (std::size_t at = 0; at < bytes.size(); at += 7) {
    parser.add(bytes.subspan(at, std::min<std::size_t>(7, bytes.size() - at)));
    while (const auto packet = parser.next()) {
      Bytes body{0x55, packet->error};
      body.insert(body.end(), packet->parameters.begin(), packet->parameters.end());
      const Bytes expected = test::reference_packet(packet->id, body);
      const auto found = std::search(bytes.begin(), bytes.end(), expected.begin(), expected.end());
      require(found != bytes.end(), "a packet that is reported is in the input");
    }
  }
}

/// Changes what the servos answer.
class ChangingLine final : public host::Line {
 public:
  ChangingLine(test::EmulatedLine& line, FuzzInput& input) : line_(line), input_(input) {}

  [[nodiscard]] std::uint64_t now_us() override { return line_.now_us(); }
  void write(std::span<const std::uint8_t> bytes) override { line_.write(bytes); }
  void discard_input() override { line_.discard_input(); }
  std::size_t read(std::span<std::uint8_t> into, std::uint64_t deadline_us) override {
    std::size_t count = line_.read(into, deadline_us);
    const std::uint8_t choice = input_.byte();
    if (count > 0 && choice > 200) {
      into[choice % count] = input_.byte();
    }
    if (count > 0 && choice > 230) {
      count = 1 + choice % count;
    }
    return count;
  }

 private:
  test::EmulatedLine& line_;
  FuzzInput& input_;
};

template <typename Action>
void run(test::ServoEmulator& servos, std::uint64_t& now_us, std::uint64_t timeout_us, const Action& action) {
  // A request to all servos that must not fail (power off) may add the answers of one round.
  constexpr std::uint64_t tolerance_us = 400'000;
  const std::uint64_t deadline_us = now_us + timeout_us;
  try {
    action(deadline_us);
  } catch (const host::ServoError& error) {
    require(std::string(error.what()).find('\n') == std::string::npos, "an error is one line");
  }
  require(now_us <= deadline_us + tolerance_us, "a call ends at its deadline");
  for (const test::EmulatedServo& servo : servos.servos) {
    for (const auto& goal : servo.goals) {
      require(goal.position >= 0 && goal.position < 4096, "a goal is a position of the servo");
    }
  }
}

void drive(FuzzInput input) {
  test::ServoEmulator servos(3);
  std::uint64_t now_us = 0;
  test::EmulatedLine line(servos, now_us, 1'000'000);
  ChangingLine changing(line, input);
  host::ServoChain chain(changing, test::chain_settings(3), [](const std::string&) {});
  run(servos, now_us, 3'000'000, [&](std::uint64_t deadline_us) { chain.connect(deadline_us); });
  if (!chain.is_connected()) {
    return;
  }
  run(servos, now_us, 1'000'000, [&](std::uint64_t deadline_us) { chain.switch_on(deadline_us); });
  const std::vector<double> angles{90.0, -90.0, 300.0};
  for (int tick = 0; tick < 20; ++tick) {
    run(servos, now_us, 1'000'000, [&](std::uint64_t deadline_us) { chain.send_goals(angles, deadline_us); });
  }
  run(servos, now_us, 1'000'000, [&](std::uint64_t deadline_us) { chain.switch_off(deadline_us); });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  parse({data, size});
  drive(FuzzInput({data, size}));
  return 0;
}
