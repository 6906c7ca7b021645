#pragma once

// The hashes in the tree that every build of the core must reproduce.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/identity/player.hpp"

namespace proleg::identity {

/// Number of cases of each algorithm: in the whole proof, and where a build is slow. The table has the hashes of both.
inline constexpr std::uint32_t all_cases = 1000;
inline constexpr std::uint32_t quick_cases = 50;
/// Where each case takes a tenth of a second and more, as on an emulated CPU: compared with the native player.
inline constexpr std::uint32_t few_cases = 5;

/// SHA-256, in hexadecimal, of the values of all cases in order, each as little-endian int32_t.
struct Golden {
  std::string algorithm;
  std::uint32_t cases;
  std::uint32_t ticks;
  std::string setpoints;
  std::string servo_commands;

  friend bool operator==(const Golden&, const Golden&) = default;
};

/// The table that ships with the tests.
[[nodiscard]] std::filesystem::path golden_file();
/// Throws PlayerError that names file, line and expectation.
[[nodiscard]] std::vector<Golden> read_golden(const std::filesystem::path& file);
/// Also writes the fingerprint that follows from the rows into the core.
void write_golden(const std::filesystem::path& file, const std::vector<Golden>& rows);

/// What core_fingerprint must be (shared/kernel/fingerprint.hpp).
[[nodiscard]] std::uint32_t fingerprint_of(const std::vector<Golden>& rows);

/// Ids of the algorithms in the table: those of the registry and the sensing probe.
[[nodiscard]] std::vector<unsigned> algorithm_ids();

/// Plays the first `cases` cases.
[[nodiscard]] Golden hash_cases(Player& player, const ActuationModule& algorithm, std::uint32_t cases);

/// Names the first case, tick and joint in which two players differ; says so if there is none.
[[nodiscard]] std::string first_difference(Player& found, Player& expected, const ActuationModule& algorithm,
                                           std::uint32_t cases);

}  // namespace proleg::identity
