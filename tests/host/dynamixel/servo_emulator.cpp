#include "tests/host/dynamixel/servo_emulator.hpp"

#include <algorithm>
#include <utility>

namespace proleg::test {
namespace {

constexpr std::uint8_t range_error = 4;
constexpr std::uint8_t length_error = 5;
constexpr std::uint8_t access_error = 7;
constexpr std::uint8_t alert = 0x80;
constexpr unsigned ram_begin = 64;

/// Uses up one of the affected answers.
bool take(unsigned& count) {
  if (count == 0) {
    return false;
  }
  --count;
  return true;
}

}  // namespace

std::uint16_t reference_crc(std::span<const std::uint8_t> bytes) {
  std::uint32_t crc = 0;
  for (const std::uint8_t byte : bytes) {
    for (int bit = 7; bit >= 0; --bit) {
      const bool carry = ((crc >> 15U) & 1U) != ((byte >> static_cast<unsigned>(bit)) & 1U);
      crc = (crc << 1U) & 0xFFFFU;
      if (carry) {
        crc ^= 0x8005U;
      }
    }
  }
  return static_cast<std::uint16_t>(crc);
}

Bytes reference_packet(std::uint8_t id, std::span<const std::uint8_t> body) {
  Bytes stuffed;
  unsigned matched = 0;  // of FF FF FD
  for (const std::uint8_t byte : body) {
    stuffed.push_back(byte);
    if (byte == 0xFF) {
      matched = std::min(matched + 1, 2U);
    } else {
      if (byte == 0xFD && matched == 2) {
        stuffed.push_back(0xFD);
      }
      matched = 0;
    }
  }
  const std::size_t length = stuffed.size() + 2;
  Bytes packet(7 + stuffed.size());
  const Bytes start{
      0xFF, 0xFF, 0xFD, 0x00, id, static_cast<std::uint8_t>(length), static_cast<std::uint8_t>(length >> 8U)};
  std::ranges::copy(stuffed, std::ranges::copy(start, packet.begin()).out);
  const std::uint16_t crc = reference_crc(packet);
  packet.push_back(static_cast<std::uint8_t>(crc));
  packet.push_back(static_cast<std::uint8_t>(crc >> 8U));
  return packet;
}

EmulatedServo::EmulatedServo(std::uint8_t own_id) : id(own_id) {
  set_number(0, 2, 1200);  // XL330-M288
  set_number(6, 1, 52);
  set_number(7, 1, id);
  set_number(9, 1, 250);
  set_number(11, 1, 3);
  set_number(48, 4, 4095);
  set_number(52, 4, 0);
  set_number(68, 1, 2);
  set_number(116, 4, 2048);
  set_number(132, 4, 2048);
  set_number(146, 1, 31);
}

std::uint32_t EmulatedServo::number(unsigned address, unsigned size) const {
  std::uint32_t value = 0;
  for (unsigned i = 0; i < size; ++i) {
    value |= std::uint32_t{table[address + i]} << 8U * i;
  }
  return value;
}

void EmulatedServo::set_number(unsigned address, unsigned size, std::uint32_t value) {
  for (unsigned i = 0; i < size; ++i) {
    table[address + i] = static_cast<std::uint8_t>(value >> 8U * i);
  }
}

void EmulatedServo::fail(std::uint8_t status) {
  table[70] = status;
  table[64] = 0;
}

void EmulatedServo::restart() {
  const std::uint32_t position = number(132, 4);
  std::fill(table.begin() + ram_begin, table.end(), std::uint8_t{0});
  set_number(68, 1, 2);
  set_number(116, 4, position);
  set_number(132, 4, position);
  set_number(146, 1, 31);
}

std::uint8_t EmulatedServo::write_goal(std::int32_t goal, std::uint64_t now_us) {
  const bool is_allowed = goal >= static_cast<std::int32_t>(number(52, 4)) &&
                          goal <= static_cast<std::int32_t>(number(48, 4)) && !was_stopped_by_watchdog();
  if (!is_allowed) {
    return range_error;
  }
  set_number(116, 4, static_cast<std::uint32_t>(goal));
  goals.push_back({now_us, goal, has_power()});
  if (has_power() && !is_blocked) {
    const std::int32_t way = goal - position();
    const std::int32_t step = steps_per_goal == 0 ? way : std::clamp(way, -steps_per_goal, steps_per_goal);
    set_number(132, 4, static_cast<std::uint32_t>(position() + step));
  }
  return 0;
}

std::uint8_t EmulatedServo::write(unsigned address, std::span<const std::uint8_t> data, std::uint64_t now_us) {
  if (address + data.size() > table.size() || (address < ram_begin && has_power())) {
    return access_error;
  }
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < data.size(); ++i) {
    value |= std::uint32_t{data[i]} << 8U * i;
  }
  if (address == 116) {
    return data.size() == 4 ? write_goal(static_cast<std::int32_t>(value), now_us) : length_error;
  }
  if (address == 98 && value > 127) {
    return range_error;
  }
  eeprom_writes += address < ram_begin ? 1U : 0U;
  std::ranges::copy(data, table.begin() + address);
  return 0;
}

void EmulatedServo::check_watchdog(std::uint64_t now_us, std::uint64_t last_instruction_us) {
  const bool is_active = has_power() && table[98] >= 1 && table[98] <= 127;
  if (is_active && now_us > last_instruction_us + std::uint64_t{table[98]} * 20'000) {
    table[98] = 255;
  }
}

ServoEmulator::ServoEmulator(unsigned count) {
  for (unsigned id = 1; id <= count; ++id) {
    servos.emplace_back(static_cast<std::uint8_t>(id));
  }
}

void ServoEmulator::advance(std::uint64_t now_us) {
  for (EmulatedServo& servo : servos) {
    servo.check_watchdog(now_us, last_instruction_us_);
  }
}

std::vector<ServoEmulator::Answer> ServoEmulator::receive(std::span<const std::uint8_t> bytes, std::uint64_t now_us) {
  advance(now_us);
  std::vector<Answer> answers;
  if (echoes) {
    answers.push_back({0, Bytes(bytes.begin(), bytes.end())});
  }
  received_.insert(received_.end(), bytes.begin(), bytes.end());
  const Bytes header{0xFF, 0xFF, 0xFD, 0x00};
  for (;;) {
    const auto begin = std::search(received_.begin(), received_.end(), header.begin(), header.end());
    received_.erase(received_.begin(), begin);
    if (received_.size() < 7) {
      return answers;
    }
    const std::size_t length = received_[5] + 256U * received_[6];
    if (received_.size() < 7 + length) {
      return answers;
    }
    const Bytes packet(received_.begin(), received_.begin() + static_cast<std::ptrdiff_t>(7 + length));
    received_.erase(received_.begin(), received_.begin() + static_cast<std::ptrdiff_t>(packet.size()));
    const std::span<const std::uint8_t> all(packet);
    if (length < 3 ||
        reference_crc(all.first(packet.size() - 2)) != packet[packet.size() - 2] + 256U * packet[packet.size() - 1]) {
      ++bad_instructions;
      continue;
    }
    Bytes body;
    unsigned matched = 0;
    for (std::size_t i = 7; i + 2 < packet.size(); ++i) {
      if (matched == 3) {
        matched = 0;
        bad_instructions += packet[i] == 0xFD ? 0U : 1U;
        continue;
      }
      body.push_back(packet[i]);
      matched = packet[i] == 0xFF ? std::min(matched + 1, 2U) : (packet[i] == 0xFD && matched == 2 ? 3U : 0U);
    }
    last_instruction_us_ = now_us;
    execute(packet[4], body, now_us, answers);
  }
}

bool ServoEmulator::answer(EmulatedServo& servo, std::uint8_t error, std::span<const std::uint8_t> data,
                           std::vector<Answer>& answers) {
  ++servo.requests;
  if (servo.is_missing || take(servo.silent) || (servo.only_answer != 0 && servo.requests != servo.only_answer)) {
    return false;
  }
  const bool is_crc_error = take(servo.crc_errors);
  const unsigned number = is_crc_error ? 3U : error;
  Bytes body{0x55, static_cast<std::uint8_t>(number | (servo.table[70] != 0 ? alert : 0))};
  if (!is_crc_error) {
    body.insert(body.end(), data.begin(), data.end());
  }
  Bytes packet = reference_packet(take(servo.with_wrong_id) ? 99 : servo.id, body);
  if (take(servo.corrupt)) {
    packet[packet.size() - 3] ^= 0x10;
  }
  if (take(servo.truncated)) {
    packet.resize(packet.size() - 4);
  }
  if (take(servo.with_noise)) {
    packet.insert(packet.begin(), {0x00, 0xFF, 0xFF, 0xFD, 0x00, 0x01, 0xFF});
  }
  const bool is_late = take(servo.until_late) && servo.until_late == 0;
  answers.push_back({servo.delay_us + (is_late ? servo.late_us : 0U), packet});
  if (servo.split_us != 0) {
    Bytes& first = answers.back().bytes;
    answers.push_back({servo.split_us, Bytes(first.begin() + 3, first.end())});
    answers[answers.size() - 2].bytes.resize(3);
  }
  return true;
}

void ServoEmulator::execute(std::uint8_t id, const Bytes& body, std::uint64_t now_us, std::vector<Answer>& answers) {
  const std::uint8_t instruction = body[0];
  if (instruction == 0x82) {
    sync_read(body, answers);
    return;
  }
  if (instruction == 0x83) {
    sync_write(body, now_us);
    return;
  }
  for (EmulatedServo& servo : servos) {
    if (servo.is_missing || (id != servo.id && id != 0xFE)) {
      continue;
    }
    if (instruction == 0x01) {
      answer(servo, 0, Bytes{servo.table[0], servo.table[1], servo.table[6]}, answers);
    } else if (instruction == 0x02 && body.size() == 5) {
      const unsigned address = body[1] + 256U * body[2];
      const unsigned size = body[3] + 256U * body[4];
      answer(servo, 0, std::span<const std::uint8_t>(servo.table).subspan(address, size), answers);
    } else if (instruction == 0x03 && body.size() > 3) {
      const std::span<const std::uint8_t> data(body);
      const std::uint8_t error = servo.write(body[1] + 256U * body[2], data.subspan(3), now_us);
      if (servo.table[68] == 2) {
        answer(servo, error, {}, answers);
      }
    } else {
      answer(servo, 2, {}, answers);
    }
  }
}

void ServoEmulator::sync_read(const Bytes& body, std::vector<Answer>& answers) {
  const unsigned address = body[1] + 256U * body[2];
  const unsigned size = body[3] + 256U * body[4];
  for (std::size_t i = 5; i < body.size(); ++i) {
    const auto servo = std::ranges::find(servos, body[i], &EmulatedServo::id);
    // A servo answers after the one in front of it, so nothing comes behind a missing one.
    if (servo == servos.end() ||
        !answer(*servo, 0, std::span<const std::uint8_t>(servo->table).subspan(address, size), answers)) {
      return;
    }
  }
}

void ServoEmulator::sync_write(const Bytes& body, std::uint64_t now_us) {
  const unsigned address = body[1] + 256U * body[2];
  const unsigned size = body[3] + 256U * body[4];
  const std::span<const std::uint8_t> bytes(body);
  for (std::size_t i = 5; i + size < body.size(); i += 1 + size) {
    const auto servo = std::ranges::find(servos, body[i], &EmulatedServo::id);
    if (servo != servos.end() && !servo->is_missing) {
      servo->write(address, bytes.subspan(i + 1, size), now_us);
    }
  }
}

}  // namespace proleg::test
