#include "sim/optimize/method/map_elites.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "shared/fixed/random.hpp"
#include "sim/optimize/experiment/gait_map.hpp"
#include "sim/optimize/experiment/trials.hpp"

namespace proleg::optimize {
namespace {

class MapElitesSearch {
 public:
  MapElitesSearch(const Experiment& experiment, std::uint32_t run, FitnessSource& source)
      : experiment_(experiment),
        settings_(std::get<MapElitesSettings>(experiment.method)),
        source_(source),
        noise_(method_seed(experiment.seed, run), 0),
        map_(experiment) {
    const std::vector<Dimension>& dimensions = experiment.space.dimensions;
    for (std::size_t i = 0; i < dimensions.size(); ++i) {
      if (dimensions[i].values.size() > 1) {
        choices_.push_back(i);
      }
    }
  }

  std::string run() {
    source_.set_needed_score(std::nullopt);
    rate(first_generation(), {});
    std::vector<Candidate> generation = next_generation();
    for (std::uint32_t left = settings_.generations; left > 0; --left) {
      std::vector<Candidate> next = left > 1 ? next_generation() : std::vector<Candidate>();
      rate(std::move(generation), next);
      generation = std::move(next);
    }
    return "generations used up";
  }

 private:
  /// next: the generation after this one.
  void rate(std::vector<Candidate> generation, std::span<const Candidate> next) {
    const std::size_t count = generation.size();
    generation.insert(generation.end(), next.begin(), next.end());
    source_.expect(generation);
    for (std::size_t i = 0; i < count; ++i) {
      if (map_.add(rated_.size(), source_.fitness(generation[i]))) {
        rated_.push_back(std::move(generation[i]));
      }
    }
  }

  std::vector<Candidate> first_generation() {
    std::vector<Candidate> generation(settings_.first);
    for (Candidate& candidate : generation) {
      candidate = any_candidate();
    }
    if (settings_.start == Start::scenario) {
      generation.front() = experiment_.space.nearest(experiment_.scenario);
    }
    return generation;
  }

  std::vector<Candidate> next_generation() {
    std::vector<Candidate> generation(settings_.population);
    for (Candidate& candidate : generation) {
      candidate = map_.elites().empty() ? any_candidate() : vary(any_elite(), any_elite());
    }
    return generation;
  }

  Candidate any_candidate() {
    Candidate candidate;
    for (const Dimension& dimension : experiment_.space.dimensions) {
      candidate.push_back(noise_.below(static_cast<std::uint32_t>(dimension.values.size())));
    }
    return candidate;
  }

  const Candidate& any_elite() {
    const std::vector<GaitMap::Elite>& elites = map_.elites();
    return rated_[elites[noise_.below(static_cast<std::uint32_t>(elites.size()))].candidate];
  }

  Candidate vary(const Candidate& from, const Candidate& other) {
    Candidate varied = from;
    const double on_line = settings_.line * normal();
    for (const std::size_t i : choices_) {
      const auto last = static_cast<double>(experiment_.space.dimensions[i].values.size() - 1);
      const double start = from[i];
      const double value = start + settings_.noise * last * normal() + on_line * (other[i] - start);
      varied[i] = static_cast<std::uint32_t>(std::lround(std::clamp(value, 0.0, last)));
    }
    if (varied == from) {
      const std::size_t i = choices_[noise_.below(static_cast<std::uint32_t>(choices_.size()))];
      const auto others = static_cast<std::uint32_t>(experiment_.space.dimensions[i].values.size() - 1);
      const std::uint32_t drawn = noise_.below(others);
      varied[i] = drawn < from[i] ? drawn : drawn + 1;
    }
    return varied;
  }

  double normal() {
    constexpr double one = 65536.0;  // Q16
    return noise_.gaussian() / one;
  }

  const Experiment& experiment_;
  const MapElitesSettings& settings_;
  FitnessSource& source_;
  Pcg32 noise_;
  GaitMap map_;
  std::vector<std::size_t> choices_;  ///< dimensions with more than one value
  std::vector<Candidate> rated_;      ///< candidates that are or were on the map
};

}  // namespace

std::string search_map_elites(const Experiment& experiment, std::uint32_t run, FitnessSource& source) {
  return MapElitesSearch(experiment, run, source).run();
}

}  // namespace proleg::optimize
