#pragma once

// What `proleg verify` has found out about an algorithm, as text and as JSON.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace proleg::verify {

/// The cases as one build has played them.
struct ProofRow {
  enum class Result : std::uint8_t { reference, equal, differs, failed, not_run };

  std::string build;     ///< "library", "g++ -O2", "Cortex-M4"
  unsigned kernels = 0;  ///< 1 for one kernel of all joints, 5 for one of each joint
  Result result = Result::not_run;
  std::string setpoint_hash;  ///< SHA-256, in hexadecimal; empty if the cases were not played to their end
  std::string servo_hash;
  std::string text;  ///< the first difference, why it failed, or the program that is missing
};

struct TestResult {
  std::string name;
  std::string error;  ///< empty: it has passed
};

/// Of a tick on Cortex-M4, in instructions, with default parameters.
struct TickInstructions {
  std::uint64_t worst = 0;
  double mean = 0;
  std::uint64_t limit = 0;
  std::string error;  ///< why it was not measured; empty: it was
};

/// Bound of the stack of the kernel with all algorithms.
struct StackBound {
  unsigned bytes = 0;  ///< 0: not known
  std::string function;
  unsigned limit = 0;
};

struct Proof {
  std::string algorithm;
  unsigned id = 0;
  std::uint32_t sources = 0;  ///< first 32 bits of the SHA-256 of the source and headers
  std::uint32_t cases = 0;
  std::uint32_t ticks = 0;  ///< of a case
  bool leaves_out_missing = false;

  // What was not looked at has no value.
  std::vector<ProofRow> rows;
  std::optional<TestResult> test;
  std::optional<std::vector<std::string>> forbidden;  ///< what the object file for Cortex-M4 uses although it may not
  std::optional<TickInstructions> cost;
  std::optional<StackBound> stack;
  std::optional<std::uint32_t> flash_bytes;  ///< code and constants of the algorithm's source for Cortex-M4
};

[[nodiscard]] bool fits(const TickInstructions& cost);
[[nodiscard]] bool fits(const StackBound& stack);
/// Programs that are not installed, each once.
[[nodiscard]] std::vector<std::string> missing_programs(const Proof& proof);
/// The verdict: all rows are equal, and nothing exceeds its limit. What was not looked at counts as good; a row that
/// was not run does not, unless leaves_out_missing.
[[nodiscard]] bool is_sound(const Proof& proof);

/// The table, without ends of lines.
[[nodiscard]] std::string heading_text(const Proof& proof);  ///< three lines: name, an empty one, titles
[[nodiscard]] std::string row_text(const ProofRow& row);
/// What follows the table, up to the verdict.
[[nodiscard]] std::vector<std::string> result_lines(const Proof& proof);

/// One object (docs/user-algorithms.md).
[[nodiscard]] std::string proof_json(const Proof& proof);

}  // namespace proleg::verify
