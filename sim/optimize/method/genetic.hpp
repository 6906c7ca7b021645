#pragma once

#include <cstdint>
#include <string>

#include "sim/optimize/evaluation/fitness_source.hpp"
#include "sim/optimize/experiment/experiment.hpp"

namespace proleg::optimize {

/// search() for an experiment whose method is GeneticSettings, with one objective: the genetic algorithm of GAlib 2.4.7
/// (M. Wall, MIT, 1995-2005), which the thesis used.
///
/// - Genome: one gene for each dimension, the index of its value (GA1DArrayAlleleGenome<int>). The thesis used
///   GARealGenome with ranges and increments. That is the same class with another number type. Its Gaussian mutator
///   draws a gene again from the whole range if there is an increment, as the flip mutator here does. The crossover is
///   uniform, as in the thesis; the default of this class is another one.
/// - Selection and scaling are GAlib's defaults: roulette wheel, linear scaling by 1.2, in single precision.
/// - The source receives a whole generation before it is evaluated. A child that equals its parent is not evaluated
///   again: GAlib keeps its score.
/// - If mutation * length is 1 or more, GAlib draws ceil(mutation * length) genes again, at random places, and may draw
///   one twice. Otherwise it draws each gene again with the probability `mutation`.
/// - The search ends ("converged") when the best score of N - 1 generations ago, divided by the best score now, is at
/// least
///   `convergence`. N is generations_to_convergence; it never ends before generation N - 1. The best individual always
///   survives. To minimise, the inverse quotient counts.
/// - Linear scaling needs scores of 0 or more. After N generations with a best of 0 the search counts as converged.
/// - An objective that may be negative (Objective::may_be_negative) has sigma truncation scaling instead, which GAlib
///   provides for such scores. The search then ends when the best score of N - 1 generations ago differs from the best
///   score now by no more than the share 1 - `convergence` of its size.
/// - With Start::scenario the first individual has the scenario's own values.
///
/// GAlib's random generator is a global variable: only one search at a time may run in a process. The generator is
/// integer arithmetic (ran2 of Numerical Recipes, a shift register for coin tosses) and the same everywhere. The
/// selection uses floats, and is the same wherever compilers do not fuse multiplications and additions.
[[nodiscard]] std::string search_genetic(const Experiment& experiment, std::uint32_t run, FitnessSource& source);

}  // namespace proleg::optimize
