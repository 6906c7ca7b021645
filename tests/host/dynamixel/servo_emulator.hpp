#pragma once

// Servos that speak Dynamixel Protocol 2.0, for tests. Written from the e-manual, and without code of the plug-in: its
// own CRC, byte stuffing and parser are what the plug-in is compared with.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace proleg::test {

using Bytes = std::vector<std::uint8_t>;

/// CRC bit by bit: polynomial 0x8005, start 0, most significant bit first.
[[nodiscard]] std::uint16_t reference_crc(std::span<const std::uint8_t> bytes);

/// Header, id, length, body with byte stuffing, CRC. body: from the instruction on.
[[nodiscard]] Bytes reference_packet(std::uint8_t id, std::span<const std::uint8_t> body);

/// A servo of the X series. What is public may be changed by a test at any time.
class EmulatedServo {
 public:
  explicit EmulatedServo(std::uint8_t id);

  std::uint8_t id;
  std::array<std::uint8_t, 256> table{};

  // Faults of its answers. The counters say how many of the next answers are affected.
  bool is_missing = false;
  unsigned silent = 0;
  unsigned only_answer = 0;  ///< the only request that it answers, counted from 1; 0: it answers all
  unsigned requests = 0;     ///< so far
  unsigned corrupt = 0;
  unsigned truncated = 0;
  unsigned with_wrong_id = 0;
  unsigned with_noise = 0;  ///< in front of them
  unsigned crc_errors = 0;  ///< it says that the request was damaged
  unsigned until_late = 0;  ///< counts answers: at 1, the answer is late
  std::uint32_t late_us = 50'000;
  std::uint32_t delay_us = 500;
  std::uint32_t split_us = 0;       ///< delay behind the first three bytes of each answer
  bool is_blocked = false;          ///< it does not move to its goals
  std::int32_t steps_per_goal = 0;  ///< that it moves towards a goal when it gets one; 0: it moves there

  /// A goal that the servo accepted, and whether it moves there.
  struct Goal {
    std::uint64_t time_us;
    std::int32_t position;
    bool has_power;
  };
  std::vector<Goal> goals;
  unsigned eeprom_writes = 0;

  [[nodiscard]] std::uint32_t number(unsigned address, unsigned size) const;
  void set_number(unsigned address, unsigned size, std::uint32_t value);
  [[nodiscard]] bool has_power() const { return table[64] != 0; }
  [[nodiscard]] std::int32_t position() const { return static_cast<std::int32_t>(number(132, 4)); }
  [[nodiscard]] bool was_stopped_by_watchdog() const { return table[98] == 255; }
  /// Hardware Error Status(70); the servo switches itself off.
  void fail(std::uint8_t status);
  /// The supply was away for a moment: the RAM has the values of the start.
  void restart();

  /// Returns the error number.
  std::uint8_t write(unsigned address, std::span<const std::uint8_t> data, std::uint64_t now_us);
  void check_watchdog(std::uint64_t now_us, std::uint64_t last_instruction_us);

 private:
  std::uint8_t write_goal(std::int32_t goal, std::uint64_t now_us);
};

/// A chain of servos on one line.
class ServoEmulator {
 public:
  struct Answer {
    std::uint32_t delay_us;  ///< from the end of the request, and of the answer before
    Bytes bytes;
  };

  /// Ids 1 to `count`.
  explicit ServoEmulator(unsigned count);

  std::vector<EmulatedServo> servos;
  bool echoes = false;  ///< the adapter returns what the host sends
  unsigned bad_instructions = 0;

  EmulatedServo& servo(std::uint8_t id) { return servos.at(id - 1U); }

  /// Bytes from the host, the last one received at this time. Returns the answers in order.
  std::vector<Answer> receive(std::span<const std::uint8_t> bytes, std::uint64_t now_us);
  /// Time passes without bytes.
  void advance(std::uint64_t now_us);

 private:
  void execute(std::uint8_t id, const Bytes& body, std::uint64_t now_us, std::vector<Answer>& answers);
  void sync_read(const Bytes& body, std::vector<Answer>& answers);
  void sync_write(const Bytes& body, std::uint64_t now_us);
  /// False if the servo gives none.
  bool answer(EmulatedServo& servo, std::uint8_t error, std::span<const std::uint8_t> data,
              std::vector<Answer>& answers);

  Bytes received_;
  std::uint64_t last_instruction_us_ = 0;
};

}  // namespace proleg::test
