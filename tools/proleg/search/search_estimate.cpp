#include "tools/proleg/search/search_estimate.hpp"

#include <algorithm>
#include <chrono>

#include "sim/optimize/evaluation/confirmation.hpp"
#include "sim/optimize/evaluation/evaluator.hpp"
#include "sim/optimize/method/search.hpp"
#include "tools/proleg/common/command_line.hpp"

namespace proleg::tools {
namespace {

using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

/// The first evaluations wait for workers that begin, and are not measured.
constexpr std::chrono::milliseconds warm_up{500};
constexpr std::chrono::milliseconds measured{3000};

/// Time of an evaluation while the search runs.
double time_of_evaluation(const optimize::Experiment& experiment, optimize::Workers& workers) {
  const auto begin = Clock::now();
  struct Mark {
    Clock::time_point time;
    std::uint64_t made = 0;
  };
  Mark first{begin};
  Mark last{begin};
  bool is_warm = false;
  const auto observe = [&](const optimize::Evaluation& /*evaluation*/, const optimize::SearchProgress& progress) {
    last = {Clock::now(), progress.evaluations};
    if (!is_warm && last.time - begin >= warm_up) {
      is_warm = true;
      first = last;
    }
  };
  // At least two evaluations are needed for a time between them.
  const auto has_enough = [&] {
    return interrupted() ||
           (Clock::now() - begin >= warm_up + measured && (is_warm ? last.made > first.made : last.made > 0));
  };
  optimize::Evaluator evaluator(experiment, 0, workers, nullptr, observe, has_enough);
  try {
    static_cast<void>(optimize::search(experiment, 0, evaluator));
  } catch (const optimize::SearchEnded&) {  // that is enough
  }
  const Mark from = last.made > first.made ? first : Mark{begin};
  const std::uint64_t made = std::max<std::uint64_t>(last.made - from.made, 1);
  return Seconds(last.time - from.time).count() / static_cast<double>(made);
}

double time_of(const auto& action) {
  const auto begin = Clock::now();
  action();
  return Seconds(Clock::now() - begin).count();
}

}  // namespace

std::optional<double> SearchEstimate::seconds() const {
  return planned ? std::optional(static_cast<double>(*planned) * evaluation_s + confirmation_s) : std::nullopt;
}

SearchEstimate estimate_search(const optimize::Experiment& experiment, optimize::Workers& workers, std::size_t others) {
  SearchEstimate estimate;
  const std::uint64_t planned = optimize::planned_evaluations(experiment);
  estimate.planned = planned > 0 ? std::optional(planned) : std::nullopt;
  estimate.evaluation_s = time_of_evaluation(experiment, workers);
  if (interrupted()) {
    return estimate;
  }
  optimize::Evaluation own;
  own.candidate = experiment.space.nearest(experiment.scenario);
  const double own_run = time_of([&] { static_cast<void>(optimize::run_own_world(experiment, own)); });
  estimate.confirmation_s = own_run;  // the best scenario is run for the warnings on it
  if (optimize::needs_confirmation(experiment)) {
    const optimize::ConfirmationSettings settings = optimize::fresh_runs(experiment);
    const std::uint64_t finalists = settings.candidates + (experiment.has_baseline ? 1 : 0) + others;
    const std::uint64_t runs = finalists * settings.runs;
    const std::uint64_t rounds = (runs + workers.count() - 1) / workers.count();
    estimate.confirmation_s += own_run * static_cast<double>(rounds);
  }
  return estimate;
}

}  // namespace proleg::tools
