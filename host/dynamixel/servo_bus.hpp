#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "host/dynamixel/control_table.hpp"
#include "host/dynamixel/line.hpp"
#include "host/dynamixel/packet.hpp"

namespace proleg::host {

/// The longest time in us that a servo and an adapter need for an answer: an adapter without its low latency setting
/// keeps bytes for 16 ms; servos answer within 0.5 ms.
inline constexpr std::uint32_t answer_timeout_us = 40'000;

/// A servo does not answer, or answers with an error. what(): one line.
class ServoError : public std::runtime_error {
 public:
  explicit ServoError(const std::string& text) : std::runtime_error(text) {}
  ServoError(std::uint8_t id, const std::string& what_it_does)
      : std::runtime_error("servo " + std::to_string(id) + " " + what_it_does), what_it_does_(what_it_does) {}
  /// The fault without the name of the servo, such as "does not answer"; empty if the error is not that of one
  /// request.
  [[nodiscard]] const std::string& what_it_does() const { return what_it_does_; }

 private:
  std::string what_it_does_;
};

/// Requests to servos and their answers: one request at a time, each with a timeout.
class ServoBus {
 public:
  /// ServoError::what_it_does() of a servo from which nothing was received.
  static constexpr const char* no_answer = "does not answer";

  /// line: must outlive the bus. rate: the baud rate, from which the duration of a request is computed.
  ServoBus(Line& line, unsigned rate) : line_(line), rate_(rate) {}

  /// Sets the time at which a request of this bus fails with ServoError if it has not ended.
  void set_deadline(std::uint64_t deadline_us) { deadline_us_ = deadline_us; }
  [[nodiscard]] std::uint64_t now_us() { return line_.now_us(); }

  // Requests to one servo. They are repeated twice if there is no intact answer. They throw ServoError.
  /// Sends a ping. Returns the model number.
  unsigned ping(std::uint8_t id);
  /// The same, and waits for a second answer, which another servo with this id gives.
  unsigned ping_one(std::uint8_t id);
  /// Reads the bytes of an item.
  std::vector<std::uint8_t> read(std::uint8_t id, TableItem item);
  /// Reads an item of 1, 2 or 4 bytes.
  std::uint32_t read_number(std::uint8_t id, TableItem item);
  /// The same when no late answer can be received any more, and waits for a second answer: for a value because of which
  /// something is written.
  std::uint32_t read_number_of_one(std::uint8_t id, TableItem item);
  /// Writes an item, and requires that the servo accepts it.
  void write(std::uint8_t id, TableItem item, std::uint32_t value);
  /// Writes an item once and ignores whether it is answered.
  void write_unconfirmed(std::uint8_t id, TableItem item, std::uint32_t value);

  // Requests to several servos.
  /// Writes an item of each servo in one packet, which no servo answers.
  void sync_write(TableItem item, std::span<const std::uint8_t> ids, std::span<const std::uint32_t> values);
  /// Reads an item of each servo. The servos answer in the order of the ids. Returns their answers in the same order,
  /// nothing for those that gave no intact answer until the deadline. Answers to an earlier read of an item of another
  /// size are late answers.
  std::vector<std::optional<StatusPacket>> sync_read(TableItem item, std::span<const std::uint8_t> ids,
                                                     std::uint64_t deadline_us);
  /// The ids of all servos that answer a broadcast ping within the time.
  std::vector<std::uint8_t> find_servos(std::uint32_t time_us);

  /// Waits until no late answer is received any more: it must not count as the answer to the next request.
  void drain();
  /// Forgets bytes that were received and not read.
  void discard_input();

  /// Answers of a servo so far that were of no use.
  struct UselessAnswers {
    std::uint32_t late = 0;       ///< they came when the next request had been sent
    std::uint32_t rejecting = 0;  ///< they had an error number
    std::uint8_t error = 0;       ///< the last one's
  };
  [[nodiscard]] const UselessAnswers& useless_answers(std::uint8_t id) const { return useless_[id]; }
  /// Number of damaged answers of all servos so far.
  [[nodiscard]] std::uint32_t damaged_answers() const { return parser_.damaged(); }

  /// Whether a servo reported a hardware error (alert bit) since the last call, and which.
  [[nodiscard]] std::optional<std::uint8_t> take_alert();

 private:
  void send(std::uint8_t id, Instruction instruction, std::span<const std::uint8_t> parameters);
  std::optional<StatusPacket> next_packet();
  std::optional<StatusPacket> receive(std::uint64_t deadline_us);
  void count_useless(const StatusPacket& packet);
  void take_late();
  /// Sends a request, with repetitions. answer_size: the number of parameters that the answer must have. sent: receives
  /// how often it was sent.
  StatusPacket request(std::uint8_t id, Instruction instruction, std::span<const std::uint8_t> parameters,
                       std::size_t answer_size, unsigned* sent = nullptr);
  /// The same, and throws if two servos answer.
  StatusPacket request_of_one(std::uint8_t id, Instruction instruction, std::span<const std::uint8_t> parameters,
                              std::size_t answer_size);
  bool receives_from(std::uint8_t id, std::uint64_t deadline_us);

  Line& line_;
  unsigned rate_;
  std::uint64_t deadline_us_ = UINT64_MAX;
  StatusParser parser_;
  std::array<UselessAnswers, 256> useless_{};  ///< by id
  std::optional<std::uint8_t> alert_;
};

/// The number in 1 to 4 little-endian bytes.
[[nodiscard]] std::uint32_t number_of(std::span<const std::uint8_t> bytes);
/// The same of a number with a sign, in 4 bytes.
[[nodiscard]] inline std::int32_t signed_number_of(std::span<const std::uint8_t> bytes) {
  return static_cast<std::int32_t>(number_of(bytes));
}

}  // namespace proleg::host
