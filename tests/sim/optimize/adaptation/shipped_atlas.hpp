#pragma once

#include <vector>

#include "sim/optimize/adaptation/atlas.hpp"
#include "sim/optimize/evaluation/task.hpp"
#include "sim/scenario/reader.hpp"
#include "tests/support/files.hpp"

namespace proleg::optimize {

/// The shipped experiment for a map of gaits of the travelling wave: 25 cells of height, 0 to 0.05 m, by 20 of the duty
/// factor, 0.2 to 0.4. The objective is the distance; a candidate has the amplitudes of J5 to J1.
inline Experiment shipped_map() {
  sim::DiskFiles files;
  return read_experiment(source_path("/sim/scenarios/travelling_wave/gait_map.optimise.xml"), files);
}

/// A made-up evaluation of the candidate whose amplitudes are all the same.
inline Evaluation made_up_evaluation(const Experiment& experiment, std::uint64_t number, std::uint32_t amplitude,
                                     double distance, double height, double duty_factor) {
  Evaluation evaluation;
  evaluation.number = number;
  evaluation.candidate.assign(experiment.space.dimensions.size(), amplitude);
  evaluation.scores = {distance, height, duty_factor};
  return evaluation;
}

/// An atlas with two gaits: number 0 in the first cell, number 1 in the last one.
inline Atlas small_atlas() {
  Atlas atlas{shipped_map(), {}};
  atlas.gaits.push_back({0, Candidate(5, 40), 1.25});
  atlas.gaits.push_back({499, Candidate(5, 120), 0.75});
  return atlas;
}

}  // namespace proleg::optimize
