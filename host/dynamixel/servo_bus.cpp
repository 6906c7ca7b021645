#include "host/dynamixel/servo_bus.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "host/dynamixel/chain_settings.hpp"

namespace proleg::host {
namespace {

constexpr unsigned attempts = 3;
/// A second servo with the same id answers within the greatest Return Delay Time(9), 508 us, but the adapter may keep
/// its answer for 16 ms.
constexpr std::uint32_t second_answer_us = 17'000;

void append_half(std::vector<std::uint8_t>& bytes, unsigned value) {
  bytes.push_back(static_cast<std::uint8_t>(value));
  bytes.push_back(static_cast<std::uint8_t>(value >> 8U));
}

std::vector<std::uint8_t> parameters_of(TableItem item) {
  std::vector<std::uint8_t> parameters;
  append_half(parameters, item.address);
  append_half(parameters, item.size);
  return parameters;
}

/// Model number (u16), version of the firmware.
constexpr std::size_t ping_answer_size = 3;

unsigned model_of(const StatusPacket& answer) { return number_of(std::span(answer.parameters).first(2)); }

void append_number(std::vector<std::uint8_t>& bytes, std::uint32_t value, std::size_t size) {
  for (std::size_t i = 0; i < size; ++i) {
    bytes.push_back(static_cast<std::uint8_t>(value >> 8U * i));
  }
}

}  // namespace

std::uint32_t number_of(std::span<const std::uint8_t> bytes) {
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < bytes.size() && i < 4; ++i) {
    number |= std::uint32_t{bytes[i]} << 8U * i;
  }
  return number;
}

void ServoBus::discard_input() {
  line_.discard_input();
  parser_.reset();
}

void ServoBus::send(std::uint8_t id, Instruction instruction, std::span<const std::uint8_t> parameters) {
  take_late();
  line_.write(instruction_packet(id, instruction, parameters));
}

std::optional<StatusPacket> ServoBus::next_packet() {
  auto packet = parser_.next();
  if (packet && (packet->error & StatusPacket::alert) != 0) {
    alert_ = packet->id;
  }
  return packet;
}

std::optional<StatusPacket> ServoBus::receive(std::uint64_t deadline_us) {
  std::array<std::uint8_t, 512> bytes{};
  const std::uint64_t end_us = std::min(deadline_us, deadline_us_);
  for (bool is_first = true;; is_first = false) {
    if (auto packet = next_packet()) {
      return packet;
    }
    // After the deadline, what a delayed host has received by then still counts; a line that is never silent must end.
    const std::size_t count = is_first || now_us() < end_us ? line_.read(bytes, end_us) : 0;
    if (count == 0) {
      return std::nullopt;
    }
    parser_.add(std::span(bytes).first(count));
  }
}

void ServoBus::drain() {
  while (const auto packet = receive(now_us() + answer_timeout_us)) {
    count_useless(*packet);
    if (now_us() >= deadline_us_) {
      return;
    }
  }
}

void ServoBus::count_useless(const StatusPacket& packet) {
  UselessAnswers& useless = useless_[packet.id];
  if ((packet.error & StatusPacket::error_number) == 0) {
    ++useless.late;
  } else {
    ++useless.rejecting;
    useless.error = packet.error;
  }
}

/// Takes what has been received since the last request: late answers. The rest of one may still come.
void ServoBus::take_late() {
  constexpr unsigned max_reads = 8;
  std::array<std::uint8_t, 512> bytes{};
  for (unsigned i = 0; i < max_reads; ++i) {
    while (const auto packet = next_packet()) {
      count_useless(*packet);
    }
    const std::size_t count = line_.read(bytes, now_us());
    if (count == 0) {
      parser_.forget_longer_than(present_block.size);
      return;
    }
    parser_.add(std::span(bytes).first(count));
  }
  discard_input();
}

StatusPacket ServoBus::request(std::uint8_t id, Instruction instruction, std::span<const std::uint8_t> parameters,
                               std::size_t answer_size, unsigned* sent) {
  const std::uint32_t damaged_before = parser_.damaged();
  std::string strange;
  for (unsigned attempt = 0; attempt < attempts && now_us() < deadline_us_; ++attempt) {
    discard_input();
    send(id, instruction, parameters);
    if (sent != nullptr) {
      *sent = attempt + 1;
    }
    const std::size_t bytes = packet_overhead + parameters.size() + status_overhead + answer_size;
    const std::uint64_t deadline_us = now_us() + line_time_us(bytes, rate_) + answer_timeout_us;
    while (auto packet = receive(deadline_us)) {
      if (packet->id != id) {
        strange = "; servo " + std::to_string(packet->id) + " answered instead: two hosts on one line?";
        continue;
      }
      const auto number = static_cast<std::uint8_t>(packet->error & StatusPacket::error_number);
      if (number == StatusPacket::crc_error) {
        strange = "; it receives damaged requests: a bad cable, or a line without ground";
        continue;
      }
      if (number != 0) {
        throw ServoError(id, std::string("rejects a request with ") + describe_error_number(number));
      }
      if (packet->parameters.size() == answer_size) {
        if (attempt > 0) {
          drain();
        }
        return *std::move(packet);
      }
      strange = "; it answered with " + std::to_string(packet->parameters.size()) + " instead of " +
                std::to_string(answer_size) + " bytes";
    }
    if (parser_.is_incomplete()) {
      strange = "; its answer was cut short";
    }
  }
  if (parser_.damaged() != damaged_before) {
    strange = "; answers were damaged: two servos with one id, a bad cable, or a line without ground";
  }
  throw ServoError(id, no_answer + strange);
}

bool ServoBus::receives_from(std::uint8_t id, std::uint64_t deadline_us) {
  while (const auto packet = receive(deadline_us)) {
    if (packet->id == id) {
      return true;
    }
  }
  return false;
}

StatusPacket ServoBus::request_of_one(std::uint8_t id, Instruction instruction,
                                      std::span<const std::uint8_t> parameters, std::size_t answer_size) {
  const std::uint32_t answer_us = line_time_us(status_overhead + answer_size, rate_);
  constexpr unsigned max_rounds = 4;
  unsigned pairs = 0;
  for (unsigned round = 0; round < max_rounds; ++round) {
    unsigned sent = 0;
    const std::uint64_t start_us = now_us();
    StatusPacket answer = request(id, instruction, parameters, answer_size, &sent);
    const std::uint64_t wait_us = std::clamp<std::uint64_t>(2 * (now_us() - start_us), second_answer_us + answer_us,
                                                            answer_timeout_us + answer_us);
    const bool has_second = receives_from(id, now_us() + wait_us);
    if (sent == 1 && !has_second) {
      return answer;
    }
    // The second answer may be a late one, to the request before or to a repetition. It is not if it comes again.
    pairs += sent == 1 ? 1U : 0U;
    if (pairs == 2) {
      throw ServoError("two servos have the id " + std::to_string(id) +
                       ": one request got two answers; connect one of them alone, and change its ID(7)");
    }
    drain();
  }
  throw ServoError(id, no_answer);
}

unsigned ServoBus::ping(std::uint8_t id) { return model_of(request(id, Instruction::ping, {}, ping_answer_size)); }

unsigned ServoBus::ping_one(std::uint8_t id) {
  return model_of(request_of_one(id, Instruction::ping, {}, ping_answer_size));
}

std::vector<std::uint8_t> ServoBus::read(std::uint8_t id, TableItem item) {
  return request(id, Instruction::read, parameters_of(item), item.size).parameters;
}

std::uint32_t ServoBus::read_number_of_one(std::uint8_t id, TableItem item) {
  drain();
  return number_of(request_of_one(id, Instruction::read, parameters_of(item), item.size).parameters);
}

std::uint32_t ServoBus::read_number(std::uint8_t id, TableItem item) { return number_of(read(id, item)); }

void ServoBus::write(std::uint8_t id, TableItem item, std::uint32_t value) {
  std::vector<std::uint8_t> parameters;
  append_half(parameters, item.address);
  append_number(parameters, value, item.size);
  try {
    static_cast<void>(request(id, Instruction::write, parameters, 0));
  } catch (const ServoError& error) {
    throw ServoError(id, error.what_it_does() + " (writing " + std::to_string(value) + " to address " +
                             std::to_string(item.address) + ")");
  }
}

void ServoBus::write_unconfirmed(std::uint8_t id, TableItem item, std::uint32_t value) {
  std::vector<std::uint8_t> parameters;
  append_half(parameters, item.address);
  append_number(parameters, value, item.size);
  send(id, Instruction::write, parameters);
  const std::size_t bytes = packet_overhead + parameters.size() + status_overhead;
  static_cast<void>(receives_from(id, now_us() + line_time_us(bytes, rate_) + answer_timeout_us));
}

void ServoBus::sync_write(TableItem item, std::span<const std::uint8_t> ids, std::span<const std::uint32_t> values) {
  std::vector<std::uint8_t> parameters = parameters_of(item);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    parameters.push_back(ids[i]);
    append_number(parameters, values[i], item.size);
  }
  send(broadcast_id, Instruction::sync_write, parameters);
}

std::vector<std::optional<StatusPacket>> ServoBus::sync_read(TableItem item, std::span<const std::uint8_t> ids,
                                                             std::uint64_t deadline_us) {
  std::vector<std::uint8_t> parameters = parameters_of(item);
  parameters.insert(parameters.end(), ids.begin(), ids.end());
  send(broadcast_id, Instruction::sync_read, parameters);

  std::vector<std::optional<StatusPacket>> answers(ids.size());
  std::size_t missing = ids.size();
  while (missing > 0) {
    auto packet = receive(deadline_us);
    if (!packet) {
      break;
    }
    const auto at = static_cast<std::size_t>(std::ranges::find(ids, packet->id) - ids.begin());
    const bool is_answer = at < ids.size() && !answers[at] && packet->parameters.size() == item.size &&
                           (packet->error & StatusPacket::error_number) == 0;
    if (is_answer) {
      answers[at] = *std::move(packet);
      --missing;
    } else {
      count_useless(*packet);
    }
  }
  return answers;
}

std::vector<std::uint8_t> ServoBus::find_servos(std::uint32_t time_us) {
  send(broadcast_id, Instruction::ping, {});
  const std::uint64_t end_us = now_us() + time_us;
  std::vector<std::uint8_t> ids;
  while (const auto packet = receive(end_us)) {
    if (std::ranges::find(ids, packet->id) == ids.end()) {
      ids.push_back(packet->id);
    }
    if (now_us() >= end_us) {
      break;
    }
  }
  std::ranges::sort(ids);
  return ids;
}

std::optional<std::uint8_t> ServoBus::take_alert() { return std::exchange(alert_, std::nullopt); }

}  // namespace proleg::host
