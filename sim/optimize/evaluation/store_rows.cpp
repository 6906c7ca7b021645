#include "sim/optimize/evaluation/store_rows.hpp"

#include <array>
#include <charconv>
#include <limits>
#include <span>
#include <string>
#include <string_view>

#include "shared/computer/text/text.hpp"

namespace proleg::optimize {
namespace {

std::string text_of(const Candidate& candidate) {
  std::string text;
  std::array<char, 16> digits{};
  for (const std::uint32_t index : candidate) {
    text.append(text.empty() ? "" : " ");
    text.append(digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), index).ptr);
  }
  return text;
}

Candidate candidate_of(const std::string& text) {
  Candidate candidate;
  for (const std::string_view word : words(text)) {
    candidate.push_back(parse_whole<std::uint32_t>(word).value_or(0));
  }
  return candidate;
}

/// Binds values, or reads columns, one after the other.
class Row {
 public:
  explicit Row(Statement& statement) : statement_(statement) {}

  template <typename Value>
  void bind(const Value& value) {
    statement_.bind(++position_, value);
  }
  void bind(bool value) { statement_.bind(++position_, std::int64_t{value}); }
  void bind(std::span<const double> values) {
    for (const double value : values) {
      bind(value);
    }
  }

  void read(double& value) {
    const int column = position_++;
    value = statement_.is_null(column) ? std::numeric_limits<double>::quiet_NaN() : statement_.real(column);
  }
  void read(std::span<double> values) {
    for (double& value : values) {
      read(value);
    }
  }
  std::int64_t integer() { return statement_.integer(position_++); }
  std::string text() { return statement_.text(position_++); }
  void skip(std::size_t columns) { position_ += static_cast<int>(columns); }

 private:
  Statement& statement_;
  int position_ = 0;
};

}  // namespace

void save_trial_row(Statement& statement, const Task& task, std::uint64_t seed, const TrialResult& result,
                    std::uint32_t worker) {
  const std::string candidate = text_of(task.candidate);
  const std::string seed_text = std::to_string(seed);
  statement.reset();
  Row row(statement);
  row.bind(task.run);
  row.bind(task.number);
  row.bind(task.trial);
  row.bind(std::string_view(seed_text));
  row.bind(std::string_view(candidate));
  row.bind(task.hopeless_below.value_or(std::numeric_limits<double>::quiet_NaN()));
  row.bind(std::span<const double>(result.measures.all()));
  row.bind(result.wall_s);
  row.bind(result.simulated_s);
  row.bind(worker);
  row.bind(result.given_up);
  row.bind(std::string_view(result.failure));
  statement.step();
  statement.reset();
}

std::optional<TrialResult> read_trial(Statement& statement, const Task& task) {
  Row row(statement);
  row.skip(4);
  double hopeless_below = 0.0;
  const bool same_candidate = candidate_of(row.text()) == task.candidate;
  row.read(hopeless_below);
  // The store holds NaN, which equals no number, for "no limit".
  const bool same_limit =
      task.hopeless_below ? hopeless_below == *task.hopeless_below : hopeless_below != hopeless_below;
  if (!same_candidate || !same_limit) {
    return std::nullopt;
  }
  TrialResult result;
  row.read(result.measures.all());
  row.read(result.wall_s);
  row.read(result.simulated_s);
  row.skip(1);
  result.given_up = row.integer() != 0;
  result.failure = row.text();
  return result;
}

void save_evaluation_row(Statement& statement, const Experiment& experiment, const StoreColumns& columns,
                         const Evaluation& evaluation) {
  const std::string candidate = text_of(evaluation.candidate);
  const std::string seed =
      std::to_string(seed_of(experiment, {evaluation.run, evaluation.number, 0, evaluation.candidate, {}}));
  statement.reset();
  Row row(statement);
  row.bind(evaluation.run);
  row.bind(evaluation.number);
  row.bind(std::span<const double>(evaluation.scores));
  for (std::size_t i = 0; i < columns.values.size(); ++i) {
    row.bind(experiment.space.value(evaluation.candidate, i));
  }
  row.bind(std::span<const double>(evaluation.measures.all()));
  row.bind(std::string_view(seed));
  row.bind(evaluation.wall_s);
  row.bind(evaluation.simulated_s);
  row.bind(evaluation.given_up);
  row.bind(evaluation.reused);
  row.bind(std::string_view(evaluation.failure));
  row.bind(std::string_view(candidate));
  statement.step();
  statement.reset();
}

Evaluation read_evaluation(Statement& statement, const Experiment& experiment, const StoreColumns& columns) {
  Evaluation evaluation;
  Row row(statement);
  evaluation.run = static_cast<std::uint32_t>(row.integer());
  evaluation.number = static_cast<std::uint64_t>(row.integer());
  evaluation.scores.resize(experiment.objectives.size());
  row.read(evaluation.scores);
  row.skip(columns.values.size());
  row.read(evaluation.measures.all());
  row.skip(1);
  row.read(evaluation.wall_s);
  row.read(evaluation.simulated_s);
  evaluation.given_up = row.integer() != 0;
  evaluation.reused = row.integer() != 0;
  evaluation.restored = !evaluation.reused;
  evaluation.failure = row.text();
  evaluation.candidate = candidate_of(row.text());
  return evaluation;
}

}  // namespace proleg::optimize
