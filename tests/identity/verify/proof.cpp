#include "tests/identity/verify/proof.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdio>
#include <string_view>

#include "shared/computer/text/text.hpp"
#include "tools/proleg/common/json_output.hpp"
#include "tools/proleg/common/program_run.hpp"

namespace proleg::verify {
namespace {

using tools::Json;

constexpr std::array<std::string_view, 5> result_names{"reference", "equal", "differs", "failed", "not run"};

std::string table_line(std::string_view build, std::string_view kernels, std::string_view setpoints,
                       std::string_view servo, std::string_view result) {
  std::string line;
  const auto column = [&line](std::string_view text, std::size_t width) {
    line.append(text).append(width - std::min(width, text.size()), ' ').append(" ");
  };
  column(build, 14);
  column(kernels, 8);
  column(setpoints, 14);
  column(servo, 14);
  return line.append(result);
}

std::string result_text(const ProofRow& row) {
  switch (row.result) {
    case ProofRow::Result::reference:
      return "reference";
    case ProofRow::Result::equal:
      return "equal";
    case ProofRow::Result::differs:
      return "DIFFERS: " + row.text;
    case ProofRow::Result::failed:
      return "FAILS: " + row.text;
    case ProofRow::Result::not_run:
      break;
  }
  return "not run: no " + row.text;
}

Json text_or_nothing(const std::string& text) { return text.empty() ? Json() : Json(text); }

Json row_json(const ProofRow& row, const Proof& proof) {
  const bool was_played = !row.setpoint_hash.empty();
  return Json{{"build", row.build},
              {"kernels", row.kernels},
              {"result", result_names.at(static_cast<std::size_t>(row.result))},
              {"ticks", was_played ? std::uint64_t{proof.cases} * proof.ticks : 0},
              {"setpoint_hash", text_or_nothing(row.setpoint_hash)},
              {"servo_hash", text_or_nothing(row.servo_hash)},
              {"text", text_or_nothing(row.text)}};
}

Json list_json(const std::vector<std::string>& texts) {
  Json list = Json::empty_array();
  for (const std::string& text : texts) {
    list.append(text);
  }
  return list;
}

Json cost_json(const TickInstructions& cost) {
  const bool is_known = cost.error.empty();
  return Json{{"worst", is_known ? Json(cost.worst) : Json()},
              {"mean", is_known ? Json(cost.mean) : Json()},
              {"limit", cost.limit},
              {"fits", fits(cost)},
              {"error", text_or_nothing(cost.error)}};
}

Json stack_json(const StackBound& stack) {
  return Json{{"bytes", stack.bytes > 0 ? Json(stack.bytes) : Json()},
              {"function", text_or_nothing(stack.function)},
              {"limit", stack.limit},
              {"fits", fits(stack)}};
}

}  // namespace

bool fits(const TickInstructions& cost) { return cost.error.empty() && cost.worst <= cost.limit; }

bool fits(const StackBound& stack) { return stack.bytes > 0 && stack.bytes <= stack.limit; }

std::vector<std::string> missing_programs(const Proof& proof) {
  std::vector<std::string> programs;
  for (const ProofRow& row : proof.rows) {
    if (row.result == ProofRow::Result::not_run && std::ranges::find(programs, row.text) == programs.end()) {
      programs.push_back(row.text);
    }
  }
  return programs;
}

bool is_sound(const Proof& proof) {
  const auto is_good = [&proof](const ProofRow& row) {
    return row.result == ProofRow::Result::reference || row.result == ProofRow::Result::equal ||
           (row.result == ProofRow::Result::not_run && proof.leaves_out_missing);
  };
  return !proof.rows.empty() && std::ranges::all_of(proof.rows, is_good) &&
         (!proof.test || proof.test->error.empty()) && (!proof.forbidden || proof.forbidden->empty()) &&
         (!proof.cost || fits(*proof.cost)) && (!proof.stack || fits(*proof.stack));
}

std::string heading_text(const Proof& proof) {
  return proof.algorithm + ": id " + std::to_string(proof.id) + ", sources " + hexadecimal(proof.sources, 8) + ", " +
         std::to_string(proof.cases) + " cases of " + std::to_string(proof.ticks) + " ticks\n\n" +
         table_line("build", "kernels", "set-points", "servo", "result");
}

std::string row_text(const ProofRow& row) {
  constexpr std::size_t shown_digits = 12;
  return table_line(row.build, row.kernels == 1 ? "one" : "five", row.setpoint_hash.substr(0, shown_digits),
                    row.servo_hash.substr(0, shown_digits), result_text(row));
}

std::vector<std::string> result_lines(const Proof& proof) {
  std::vector<std::string> lines;
  if (proof.test) {
    const TestResult& test = *proof.test;
    lines.push_back(test.error.empty() ? "test       passed: " + test.name
                                       : "test       fails: " + test.name + ": " + test.error);
  }
  if (const auto missing = missing_programs(proof); !missing.empty() && !proof.leaves_out_missing) {
    lines.push_back("missing    compilers are not installed: " + tools::installing_command(missing) +
                    "; --leave-out-missing accepts that");
  }
  if (proof.forbidden) {
    for (const std::string& each : *proof.forbidden) {
      lines.push_back("code       FORBIDDEN: " + proof.algorithm + ".cpp " + each);
    }
    if (proof.forbidden->empty()) {
      lines.emplace_back("code       uses neither floating point nor heap nor variables of its own");
    }
  }
  if (proof.cost && !proof.cost->error.empty()) {
    lines.push_back("cost       FAILS: " + proof.cost->error);
  } else if (proof.cost) {
    lines.push_back(std::string("cost       ") + (fits(*proof.cost) ? "" : "TOO HIGH: ") +
                    std::to_string(proof.cost->worst) + " instructions a tick at worst, " +
                    std::to_string(static_cast<std::uint64_t>(proof.cost->mean)) +
                    " on average, with default parameters; limit " + std::to_string(proof.cost->limit));
  }
  if (proof.stack) {
    lines.push_back(std::string("stack      ") + (fits(*proof.stack) ? "" : "TOO MUCH: ") +
                    std::to_string(proof.stack->bytes) + " bytes at most, in " + proof.stack->function + "; limit " +
                    std::to_string(proof.stack->limit));
  }
  if (proof.flash_bytes) {
    lines.push_back("room       " + std::to_string(*proof.flash_bytes) + " bytes of a module's flash");
  }
  lines.emplace_back(is_sound(proof) ? "verified: the same bits everywhere" : "NOT verified");
  return lines;
}

std::string proof_json(const Proof& proof) {
  Json rows = Json::empty_array();
  for (const ProofRow& row : proof.rows) {
    rows.append(row_json(row, proof));
  }
  Json test;
  if (proof.test) {
    test = Json{{"name", proof.test->name},
                {"passed", proof.test->error.empty()},
                {"error", text_or_nothing(proof.test->error)}};
  }
  return Json{{"algorithm", proof.algorithm},
              {"id", proof.id},
              {"sources", hexadecimal(proof.sources, 8)},
              {"cases", proof.cases},
              {"ticks", proof.ticks},
              {"verified", is_sound(proof)},
              {"builds", rows},
              {"missing", list_json(missing_programs(proof))},
              {"test", test},
              {"forbidden", proof.forbidden ? list_json(*proof.forbidden) : Json()},
              {"instructions", proof.cost ? cost_json(*proof.cost) : Json()},
              {"stack", proof.stack ? stack_json(*proof.stack) : Json()},
              {"flash_bytes", proof.flash_bytes}}
      .text();
}

}  // namespace proleg::verify
