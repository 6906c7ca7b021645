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
///   GARealGenome with ranges and increments. That is this class with another number type; its Gaussian mutator draws a
///   gene anew from the whole range if there is an increment, which is what the flip mutator here does. Its uniform
///   crossover, which is not the default of this class, is chosen. Real genes would hold the same indices as floats.
/// - Selection and scaling are GAlib's defaults: roulette wheel, linear scaling by 1.2, in single precision.
/// - A whole generation is told to the source before it is evaluated. A child that is like its parent is not evaluated
///   anew: GAlib keeps its score.
/// - If mutation * length is 1 or more, GAlib draws ceil(mutation * length) genes anew, of random places, one perhaps
///   twice; below that each gene with the probability `mutation`.
/// - Ends ("converged") when the best score of N - 1 generations ago, divided by the best score now, is at least
///   `convergence` (N: generations_to_convergence; not before generation N - 1). The best generation is never lost. If
///   the scores are to become small, it is the inverse quotient.
/// - Linear scaling cannot deal with scores below 0: GAlib is given 0 for them. The quotient of N generations whose
/// best
///   is 0 counts as 1.
///
/// GAlib's random generator is a global variable: one search at a time in a process. It is integer arithmetic (ran2 of
/// Numerical Recipes, a shift register for coin tosses) and the same everywhere; the selection is arithmetic with
/// floats, the same wherever compilers do not fuse multiplications and additions.
[[nodiscard]] std::string search_genetic(const Experiment& experiment, std::uint32_t run, FitnessSource& source);

}  // namespace proleg::optimize
