#include "tools/proleg/ui/proof_output.hpp"

#include <nlohmann/json.hpp>
#include <optional>

#include "shared/computer/text/text.hpp"

namespace proleg::tools {
namespace {

using nlohmann::json;

constexpr std::string_view line_begin = "proleg verify: ";

/// The step in "3 of 15: building with g++".
std::optional<ProofStep> step_in(std::string_view line) {
  constexpr std::string_view of = " of ";
  constexpr std::string_view colon = ": ";
  const std::size_t first = line.find(of);
  const std::size_t second = line.find(colon);
  if (first == std::string_view::npos || second == std::string_view::npos || second < first) {
    return std::nullopt;
  }
  const auto done = parse_whole<std::uint32_t>(line.substr(0, first));
  const auto steps = parse_whole<std::uint32_t>(line.substr(first + of.size(), second - first - of.size()));
  if (!done || !steps) {
    return std::nullopt;
  }
  return ProofStep{*done, *steps, one_line(line.substr(second + colon.size()))};
}

}  // namespace

ProofStep proof_step(std::string_view errors) {
  ProofStep last;
  TextLines lines(errors);
  while (const std::optional<std::string_view> line = lines.next()) {
    if (line->starts_with(line_begin)) {
      last = step_in(line->substr(line_begin.size())).value_or(std::move(last));
    }
  }
  return last;
}

json proof_object(std::string_view output) {
  json object = json::parse(output, nullptr, false);
  return object.is_object() && object.contains("verified") && object["verified"].is_boolean() ? object : json();
}

std::string proof_error(const json& proof, std::string_view errors, int status) {
  if (proof.is_object()) {
    return proof["verified"] == true ? "" : "what differs, or exceeds a limit, is in the table";
  }
  std::string last;
  TextLines lines(errors);
  while (const std::optional<std::string_view> line = lines.next()) {
    if (line->starts_with(line_begin) && !step_in(line->substr(line_begin.size()))) {
      last = one_line(line->substr(line_begin.size()));
    }
  }
  return last.empty() ? "proleg verify has ended without a result, with exit status " + std::to_string(status) : last;
}

}  // namespace proleg::tools
