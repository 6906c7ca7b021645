#include "sim/optimize/adaptation/damage_scores.hpp"

#include <optional>
#include <utility>

#include "shared/computer/text/text.hpp"
#include "sim/optimize/report/scores.hpp"

namespace proleg::optimize {
namespace {

constexpr std::string_view scores_head = "# inputs: ";
constexpr std::string_view explanation = "# a damage, and the score of each gait of the atlas with it";

}  // namespace

std::string text_of(const DamageScores& scores, const std::string& inputs) {
  std::string text = std::string(scores_head) + inputs + '\n' + std::string(explanation) + '\n';
  for (const auto& [damage, of_gaits] : scores) {
    text += damage + '\t';
    for (const double score : of_gaits) {
      text += (text.back() == '\t' ? "" : " ") + exact_text(score);
    }
    text += '\n';
  }
  return text;
}

DamageScores read_damage_scores(std::string_view text, const std::string& inputs, std::size_t gaits) {
  TextLines lines(text);
  const std::optional<std::string_view> first = lines.next();
  if (!first || *first != std::string(scores_head) + inputs || lines.next() != explanation || !text.ends_with('\n')) {
    return {};
  }
  DamageScores scores;
  while (const std::optional<std::string_view> line = lines.next()) {
    const std::size_t tab = line->find('\t');
    if (tab == std::string_view::npos) {
      return {};
    }
    std::vector<double> of_gaits;
    for (const std::string_view word : words(line->substr(tab + 1))) {
      const std::optional<double> score = parse_score(word);
      if (!score) {
        return {};
      }
      of_gaits.push_back(*score);
    }
    if (of_gaits.size() != gaits) {
      return {};
    }
    scores.insert_or_assign(std::string(line->substr(0, tab)), std::move(of_gaits));
  }
  return scores;
}

}  // namespace proleg::optimize
