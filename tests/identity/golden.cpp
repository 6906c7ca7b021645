#include "tests/identity/golden.hpp"

#include <sodium.h>

#include <array>
#include <fstream>
#include <iomanip>
#include <span>
#include <sstream>

#include "shared/fixed/crc32.hpp"
#include "shared/gait/registry.hpp"
#include "tests/identity/sensing_probe.hpp"
#include "tests/support/files.hpp"

namespace proleg::identity {
namespace {

constexpr std::string_view heading = "algorithm\tcases\tticks\tsetpoints_sha256\tservo_commands_sha256";

class Sha256 {
 public:
  Sha256() { crypto_hash_sha256_init(&state_); }

  void add(std::span<const std::int32_t> values) {
    std::vector<std::uint8_t> bytes;
    bytes.reserve(values.size() * 4);
    for (const std::int32_t value : values) {
      const auto bits = static_cast<std::uint32_t>(value);
      for (unsigned shift = 0; shift < 32; shift += 8) {
        bytes.push_back(static_cast<std::uint8_t>(bits >> shift));
      }
    }
    crypto_hash_sha256_update(&state_, bytes.data(), bytes.size());
  }

  [[nodiscard]] std::string hexadecimal() {
    std::array<unsigned char, crypto_hash_sha256_BYTES> hash{};
    crypto_hash_sha256_final(&state_, hash.data());
    std::array<char, 2 * crypto_hash_sha256_BYTES + 1> text{};
    return sodium_bin2hex(text.data(), text.size(), hash.data(), hash.size());
  }

 private:
  crypto_hash_sha256_state state_;
};

std::string first_difference_in(std::string_view what, std::span<const std::int32_t> found,
                                std::span<const std::int32_t> expected) {
  for (std::size_t i = 0; i < expected.size(); ++i) {
    if (found[i] != expected[i]) {
      return "tick " + std::to_string(i / joint_count + 1) + ", joint " + std::to_string(i % joint_count) + ": " +
             std::string(what) + " " + std::to_string(found[i]) + " instead of " + std::to_string(expected[i]);
    }
  }
  return {};
}

std::string text_of(const std::vector<Golden>& rows) {
  std::ostringstream text;
  for (const Golden& row : rows) {
    text << row.algorithm << '\t' << row.cases << '\t' << row.ticks << '\t' << row.setpoints << '\t'
         << row.servo_commands << '\n';
  }
  return text.str();
}

void write_file(const std::filesystem::path& file, const std::string& text) {
  std::ofstream stream(file);
  stream << text;
  if (!stream.flush()) {
    throw PlayerError(file.string() + ": cannot write");
  }
}

}  // namespace

std::filesystem::path golden_file() { return std::filesystem::path(source_path("/tests/identity/golden.tsv")); }

std::vector<Golden> read_golden(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string line;
  if (!std::getline(stream, line) || line != heading) {
    throw PlayerError(file.string() + ":1: found \"" + line + "\", expected the heading; identity --write-golden");
  }
  std::vector<Golden> rows;
  while (std::getline(stream, line)) {
    std::istringstream fields(line);
    Golden row{};
    std::string rest;
    if (!(fields >> row.algorithm >> row.cases >> row.ticks >> row.setpoints >> row.servo_commands) ||
        (fields >> rest)) {
      throw PlayerError(file.string() + ":" + std::to_string(rows.size() + 2) + ": found \"" + line +
                        "\", expected five fields");
    }
    rows.push_back(row);
  }
  return rows;
}

void write_golden(const std::filesystem::path& file, const std::vector<Golden>& rows) {
  write_file(file, std::string(heading) + '\n' + text_of(rows));

  const std::filesystem::path header = std::filesystem::path(source_path("/shared/kernel/fingerprint.hpp"));
  std::ostringstream old;
  old << std::ifstream(header).rdbuf();
  std::string text = old.str();
  const std::string_view name = "core_fingerprint = ";
  const std::size_t from = text.find(name);
  const std::size_t to = text.find(';', from);
  if (from == std::string::npos || to == std::string::npos) {
    throw PlayerError(header.string() + ": found no \"" + std::string(name) + "...;\"");
  }
  std::ostringstream constant;
  constant << name << "0x" << std::hex << std::uppercase << std::setw(8) << std::setfill('0') << fingerprint_of(rows);
  write_file(header, text.replace(from, to - from, constant.str()));
}

std::uint32_t fingerprint_of(const std::vector<Golden>& rows) {
  const std::string text = text_of(rows);
  return crc32(std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
}

std::vector<unsigned> algorithm_ids() {
  std::vector<unsigned> ids;
  for (std::size_t i = 0; i < algorithm_count(); ++i) {
    ids.push_back(algorithm_at(i).declaration().id);
  }
  ids.push_back(sensing_probe().declaration().id);
  ids.push_back(reading_probe().declaration().id);
  return ids;
}

Golden hash_cases(Player& player, const ActuationModule& algorithm, std::uint32_t cases) {
  Sha256 setpoints;
  Sha256 servo_commands;
  for (std::uint32_t number = 0; number < cases; ++number) {
    const Trace& trace = player.play(algorithm, number);
    setpoints.add(trace.setpoints);
    servo_commands.add(trace.servo_commands);
  }
  return {std::string(algorithm.declaration().name), cases, tick_count, setpoints.hexadecimal(),
          servo_commands.hexadecimal()};
}

std::string first_difference(Player& found, Player& expected, const ActuationModule& algorithm, std::uint32_t cases) {
  for (std::uint32_t number = 0; number < cases; ++number) {
    const Trace& a = found.play(algorithm, number);
    const Trace& b = expected.play(algorithm, number);
    std::string difference = first_difference_in("set-point", a.setpoints, b.setpoints);
    if (difference.empty()) {
      difference = first_difference_in("servo command", a.servo_commands, b.servo_commands);
    }
    if (!difference.empty()) {
      return "case " + std::to_string(number) + ", " + difference;
    }
  }
  return "no difference in " + std::to_string(cases) + " cases";
}

}  // namespace proleg::identity
