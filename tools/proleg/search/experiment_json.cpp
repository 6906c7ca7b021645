#include "tools/proleg/search/experiment_json.hpp"

#include <map>
#include <string>

#include "sim/environment/physics_engine.hpp"

namespace proleg::tools {
namespace {

/// By method.
using Curves = std::map<std::string, optimize::BestCurves>;

/// The mean of the best so far after 100, 200, 400, ... evaluations.
Json course(const optimize::BestCurves& curves) {
  Json means = Json::empty_object();
  for (std::size_t evaluations = 100; evaluations <= curves.mean.size(); evaluations *= 2) {
    means.add(std::to_string(evaluations), curves.mean[evaluations - 1]);
  }
  return means;
}

Json to_json(const MethodResult& result, const optimize::SearchSpace& space, double reference_m) {
  Json runs = Json::empty_array();
  double sum = 0.0;
  for (std::size_t run = 0; run < result.runs.runs.size(); ++run) {
    const double searched = optimize::best_so_far(result.runs.runs[run]).back();
    const double best = result.runs.judged.empty() ? searched : result.runs.judged[run].scores.front();
    sum += best;
    runs.append({{"evaluations", result.runs.runs[run].size()},
                 {"best", best},
                 {"best_in_search", searched},
                 {"ended", result.endings[run]}});
  }
  return {{"method", result.runs.method},
          {"best_score", result.best->scores.front()},
          {"best_values", values_object(space, result.best->candidate)},
          {"gain", result.best->scores.front() / reference_m - 1.0},
          {"mean_best", sum / static_cast<double>(result.runs.runs.size())},
          {"runs", runs},
          {"wall_s", result.wall_s}};
}

Json methods_json(const std::vector<ChosenMethod>& chosen, const std::vector<MethodResult>& results,
                  const Curves& curves, double reference_m) {
  const auto deluge = curves.find("great-deluge");
  Json list = Json::empty_array();
  for (std::size_t i = 0; i < results.size(); ++i) {
    const optimize::BestCurves& own = curves.at(results[i].runs.method);
    Json entry = to_json(results[i], chosen[i].experiment.space, reference_m);
    entry.add("mean_best_after", course(own));
    if (deluge != curves.end()) {
      entry.add("reaches_mean_of_great_deluge_after", optimize::evaluations_to_reach(own, deluge->second.mean.back()));
    }
    list.append(entry);
  }
  return list;
}

Json differences_json(const std::vector<optimize::MethodRuns>& runs) {
  Json list = Json::empty_array();
  for (const optimize::MethodDifference& difference : optimize::method_differences(runs)) {
    list.append({{"one", difference.one},
                 {"other", difference.other},
                 {"share_above", difference.share_above},
                 {"p_value", difference.p_value}});
  }
  return list;
}

}  // namespace

Json experiment_json(const std::vector<ChosenMethod>& chosen, const std::vector<MethodResult>& results,
                     const std::vector<optimize::Reference>& references, const std::vector<CheckedGait>& checks) {
  Curves curves;
  std::vector<optimize::MethodRuns> runs;
  for (const MethodResult& result : results) {
    curves[result.runs.method] = optimize::best_curves(result.runs);
    runs.push_back(result.runs);
  }
  Json distances = Json::empty_object();
  for (const optimize::Reference& reference : references) {
    distances.add(std::string(reference.scenario->short_name), reference.judged_m);
  }
  Json object{{"engine", sim::name_of(chosen.front().experiment.scenario.environment.engine)},
              {"references", distances},
              {"methods", methods_json(chosen, results, curves, references.front().judged_m)},
              {"differences", differences_json(runs)}};
  if (!checks.empty()) {
    object.add("gaits", gait_checks_json(checks));
  }
  const auto deluge = curves.find("great-deluge");
  const auto genetic = curves.find("genetic");
  if (deluge != curves.end() && genetic != curves.end()) {
    object.add("great_deluge_above_genetic_after", optimize::overtaking(deluge->second, genetic->second));
  }
  return object;
}

}  // namespace proleg::tools
