#include "sim/optimize/evaluation/evaluator.hpp"

#include <algorithm>
#include <deque>
#include <unordered_map>
#include <utility>

#include "sim/loop/simulation_batch.hpp"
#include "sim/optimize/evaluation/task.hpp"
#include "sim/optimize/evaluation/task_pipeline.hpp"

namespace proleg::optimize {
namespace {

/// Time between two questions of fitness() whether to stop.
constexpr std::chrono::milliseconds stop_check_interval{100};

/// A worker takes at most this number of a batch's candidates ahead, twice: each that is not asked for delays the
/// others. Of 2, 4 and 8, a great deluge needs the least processor time with 4.
constexpr std::size_t max_uncertain = 4;

bool can_reuse_outcomes(const Experiment& experiment) {
  return experiment.reuse && !differs_between_evaluations(experiment);
}

}  // namespace

class Evaluator::Implementation {
 public:
  Implementation(const Experiment& experiment, std::uint32_t run, Workers& workers, Store* store,
                 std::function<void(const Evaluation&, const SearchProgress&)> observe, std::function<bool()> stop)
      : experiment_(experiment),
        run_(run),
        workers_(workers),
        store_(store),
        observe_(std::move(observe)),
        stop_(std::move(stop)),
        reuse_(can_reuse_outcomes(experiment)),
        stored_count_(store != nullptr ? store->evaluation_count(run) : 0),
        pipeline_(experiment, workers, store,
                  reuse_ ? TaskPipeline::ResultScope::all_numbers : TaskPipeline::ResultScope::one_number) {}

  void expect(std::span<const Candidate> next) {
    if (experiment_.on_robot) {
      return;  // it makes no trial that is not asked for
    }
    expected_.assign(next.begin(), next.end());
    request_trials(false);
    pipeline_.run(std::chrono::milliseconds(0));
    update_counts();
  }

  [[nodiscard]] std::size_t lookahead() const {
    const std::size_t ahead = std::min({sim::batch_size(experiment_.scenario), max_uncertain, workers_.most_at_once()});
    return 2 * ahead * workers_.count();
  }

  std::vector<double> fitness(const Candidate& candidate) {
    if (budget_spent()) {
      throw SearchEnded{};
    }
    Evaluation evaluation = evaluate(candidate);
    evaluation.after_restart = std::exchange(restarts_, false);
    ++number_;
    record(evaluation);
    if (store_ != nullptr) {
      store_->save(evaluation);
    }
    if (observe_) {
      observe_(evaluation, progress_);
    }
    return std::move(evaluation.scores);
  }

  void set_needed_score(std::optional<double> score) {
    hopeless_below_.reset();
    if (experiment_.racing.on() && score && *score > 0.0) {
      hopeless_below_ = *score * experiment_.racing.keep;
    }
  }

  void mark_restart() { restarts_ = true; }

  [[nodiscard]] const SearchProgress& progress() const { return progress_; }
  [[nodiscard]] bool stopped() const { return stopped_; }
  [[nodiscard]] bool budget_spent() const { return experiment_.evaluations > 0 && number_ >= experiment_.evaluations; }

 private:
  [[nodiscard]] Task task(std::uint64_t number, const Candidate& candidate, std::uint32_t trial) const {
    return {run_, number, trial, candidate, hopeless_below_};
  }

  /// Outcomes that may be reused are kept under this key.
  [[nodiscard]] Task outcome_key(const Candidate& candidate) const { return task(0, candidate, 0); }

  /// Requests the trials of the expected candidates, without those that are not needed. first_is_certain: whether
  /// fitness() was called for the first one.
  void request_trials(bool first_is_certain) {
    std::vector<Task> tasks;
    for (std::size_t i = 0; i < expected_.size(); ++i) {
      const std::uint64_t number = number_ + i;
      if (experiment_.evaluations > 0 && number >= experiment_.evaluations) {
        break;
      }
      const bool useful = number >= stored_count_ || (first_is_certain && number == number_);
      if (useful && !outcomes_.contains(outcome_key(expected_[i]))) {
        for (std::uint32_t trial = 0; trial < experiment_.trials.count; ++trial) {
          tasks.push_back(task(number, expected_[i], trial));
        }
      }
    }
    requested_limit_ = hopeless_below_;
    pipeline_.set_wanted(tasks);
  }

  Evaluation evaluate(const Candidate& candidate) {
    if (expected_.empty()) {
      expected_.push_back(candidate);
      request_trials(true);
    } else if (expected_.front() != candidate || requested_limit_ != hopeless_below_ || number_ < stored_count_) {
      expected_.front() = candidate;
      request_trials(true);
    }
    const auto known = outcomes_.find(outcome_key(candidate));
    Evaluation evaluation = known != outcomes_.end() ? reuse(known->second) : simulate(candidate);
    expected_.pop_front();
    return evaluation;
  }

  Evaluation reuse(Evaluation outcome) {
    // Workers continue meanwhile.
    throw_if_stopped();
    pipeline_.run(std::chrono::milliseconds(0));
    outcome.number = number_;
    outcome.reused = true;
    outcome.restored = false;
    outcome.wall_s = 0.0;
    outcome.simulated_s = 0.0;
    return outcome;
  }

  Evaluation simulate(const Candidate& candidate) {
    std::vector<Task> tasks;
    for (std::uint32_t trial = 0; trial < experiment_.trials.count; ++trial) {
      tasks.push_back(task(number_, candidate, trial));
    }
    const auto all_finished = [&] {
      return std::ranges::all_of(tasks, [&](const Task& its) { return pipeline_.has_result(its); });
    };
    throw_if_stopped();
    pipeline_.run(std::chrono::milliseconds(0));
    while (!all_finished()) {
      throw_if_stopped();
      pipeline_.run(stop_check_interval);
    }
    std::vector<TrialResult> trials;
    bool restored = true;
    for (const Task& its : tasks) {
      TaskPipeline::ClaimedResult claimed = pipeline_.claim_result(its);
      restored = restored && claimed.restored;
      trials.push_back(std::move(claimed.result));
    }
    Evaluation evaluation = rate(experiment_, run_, number_, candidate, trials);
    evaluation.restored = restored;
    if (reuse_) {
      outcomes_.emplace(outcome_key(candidate), evaluation);
    }
    return evaluation;
  }

  void throw_if_stopped() {
    if (stop_ && stop_()) {
      stopped_ = true;
      throw SearchEnded{};
    }
  }

  void record(const Evaluation& evaluation) {
    progress_.evaluations += 1;
    (evaluation.reused ? progress_.reused : evaluation.restored ? progress_.restored : progress_.simulated) += 1;
    progress_.score_sum += evaluation.scores.front();
    if (!has_own_score(experiment_, evaluation, 0)) {
      if (progress_.failed++ == 0) {
        progress_.first_failure = why_without_score(experiment_, evaluation);
      }
    } else if (is_better(experiment_, evaluation, progress_.best ? &*progress_.best : nullptr)) {
      progress_.best = evaluation;
    }
    update_counts();
  }

  void update_counts() {
    progress_.wasted = pipeline_.counts().wasted;
    progress_.simulated_s = pipeline_.counts().simulated_s;
    progress_.workers_s = pipeline_.counts().workers_s;
  }

  const Experiment& experiment_;
  std::uint32_t run_;
  Workers& workers_;
  Store* store_;
  std::function<void(const Evaluation&, const SearchProgress&)> observe_;
  std::function<bool()> stop_;
  bool reuse_;
  /// Evaluations that the store had when this run was resumed. Until there, an expected candidate is simulated only
  /// when it is asked for: a wrong one would be wasted and would replace a result in the store.
  std::uint64_t stored_count_;
  TaskPipeline pipeline_;
  std::uint64_t number_ = 0;        ///< of the next evaluation
  std::deque<Candidate> expected_;  ///< from number_ on
  std::optional<double> hopeless_below_;
  std::optional<double> requested_limit_;                    ///< hopeless_below_ at the last request_trials()
  std::unordered_map<Task, Evaluation, TaskHash> outcomes_;  ///< by outcome_key, if outcomes may be reused
  SearchProgress progress_;
  bool restarts_ = false;  ///< with the next evaluation
  bool stopped_ = false;
};

Evaluator::Evaluator(const Experiment& experiment, std::uint32_t run, Workers& workers, Store* store,
                     std::function<void(const Evaluation&, const SearchProgress&)> observe, std::function<bool()> stop)
    : implementation_(
          std::make_unique<Implementation>(experiment, run, workers, store, std::move(observe), std::move(stop))) {}
Evaluator::~Evaluator() = default;
void Evaluator::expect(std::span<const Candidate> next) { implementation_->expect(next); }
std::size_t Evaluator::lookahead() const { return implementation_->lookahead(); }
std::vector<double> Evaluator::fitness(const Candidate& candidate) { return implementation_->fitness(candidate); }
void Evaluator::set_needed_score(std::optional<double> score) { implementation_->set_needed_score(score); }
void Evaluator::mark_restart() { implementation_->mark_restart(); }
const SearchProgress& Evaluator::progress() const { return implementation_->progress(); }
bool Evaluator::stopped() const { return implementation_->stopped(); }
bool Evaluator::budget_spent() const { return implementation_->budget_spent(); }

}  // namespace proleg::optimize
