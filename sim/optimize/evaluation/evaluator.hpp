#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "sim/optimize/evaluation/fitness_source.hpp"
#include "sim/optimize/evaluation/store.hpp"
#include "sim/optimize/evaluation/task.hpp"
#include "sim/optimize/evaluation/workers.hpp"

namespace proleg::optimize {

/// The state of a search: a run of an experiment.
struct SearchProgress {
  std::uint64_t evaluations = 0;   ///< evaluations that the optimiser asked for
  std::uint64_t simulated = 0;     ///< evaluations that were neither reused nor restored
  std::uint64_t reused = 0;        ///< evaluations whose outcome was known
  std::uint64_t restored = 0;      ///< evaluations whose trials all came from the store
  std::uint64_t wasted = 0;        ///< trials simulated ahead and never used
  double simulated_s = 0.0;        ///< simulated time of all trials made now, wasted ones too
  double workers_s = 0.0;          ///< time that workers needed for it
  double score_sum = 0.0;          ///< of the first objective
  std::uint64_t failed = 0;        ///< evaluations without a score of their own (has_own_score, first objective)
  std::string first_failure;       ///< why the first of them has none
  std::optional<Evaluation> best;  ///< by is_better(); the earliest of equals; none if no evaluation has a score
};

/// Evaluates what an optimiser asks for, in its order, while workers simulate ahead. Every result depends only on run,
/// number and candidate: not on the number of workers, on what was expected, or on whether it came from the store.
class Evaluator final : public FitnessSource {
 public:
  /// experiment, workers, store: must outlive this. store: null for none. observe: called for each evaluation, in
  /// order. stop: called often; when it returns true, fitness() throws SearchEnded.
  Evaluator(const Experiment& experiment, std::uint32_t run, Workers& workers, Store* store,
            std::function<void(const Evaluation&, const SearchProgress&)> observe, std::function<bool()> stop);
  ~Evaluator() override;
  Evaluator(const Evaluator&) = delete;
  Evaluator& operator=(const Evaluator&) = delete;

  void expect(std::span<const Candidate> next) override;
  [[nodiscard]] std::size_t lookahead() const override;  ///< twice the number of workers; in batches, eight times
  std::vector<double> fitness(const Candidate& candidate) override;
  void set_needed_score(std::optional<double> score) override;
  void mark_restart() override;

  [[nodiscard]] const SearchProgress& progress() const;
  [[nodiscard]] bool stopped() const;       ///< whether stop() returned true
  [[nodiscard]] bool budget_spent() const;  ///< whether experiment.evaluations are used up

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace proleg::optimize
