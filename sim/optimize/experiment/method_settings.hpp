#pragma once

// The settings in the method section of a *.optimise.xml file.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace proleg::optimize {

/// Where a search starts: at random candidates only, or with the scenario's own values among the first ones.
enum class Start : std::uint8_t { random, scenario };

/// The modified great deluge algorithm (thesis, section 3.4.2; after G. Dueck, "New optimization heuristics: the great
/// deluge algorithm and the record-to-record travel", J. Comput. Phys. 104, 1993). Points that the thesis leaves open
/// are options. Their defaults read its text literally: a radius that is "increased by itself" doubles.
struct GreatDelugeSettings {
  double water_level = 0.15;      ///< the score that the first accepted candidate must reach
  double rain = 0.01;             ///< rise of the water for each accepted candidate; above 0
  std::uint32_t credits = 10;     ///< times that the search may restart with its first radius
  std::uint32_t retries = 200;    ///< failures in a row that use a credit; at least 1
  std::uint32_t confidence = 20;  ///< failures after which the radius grows; at least 1
  std::uint32_t step = 1;         ///< first radius, in steps of each parameter's value set; at least 1
  enum class Growth : std::uint8_t { linear, doubling } growth = Growth::doubling;
  enum class Move : std::uint8_t { all, one } move = Move::all;  ///< parameters that a candidate changes
  enum class Neighbour : std::uint8_t {
    three,    ///< -radius, 0 or +radius
    sign,     ///< -radius or +radius
    uniform,  ///< any step from -radius to +radius
  } neighbour = Neighbour::three;
  Start start = Start::random;      ///< scenario: all chains start at its values
  bool first_must_pass = true;      ///< whether the start must reach the water level to be accepted
  std::uint32_t reevaluations = 0;  ///< further evaluations of a candidate that would be accepted; the mean decides
  std::uint32_t chains = 1;         ///< searches side by side, each with its own water; the best of all counts
  std::optional<double> target;     ///< stops when a score reaches it
};

/// A genetic algorithm with the settings of GAlib (M. Wall, GAlib 2.4 documentation), which the thesis used.
struct GeneticSettings {
  std::uint32_t population = 30;                  ///< popsize; 2 to 10000
  double mutation = 0.01;                         ///< pmut, a gene's probability; 0 to 1
  double crossover = 0.9;                         ///< pcross; 0 to 1
  std::uint32_t generations_to_convergence = 50;  ///< nconvergence; 1 to 10000
  double convergence = 0.99;                      ///< pconvergence: of best-of-generation scores; 0 to 1
  /// gamode: a setting of the thesis's program that the thesis does not explain. 1: a whole new generation each time,
  /// and the best survives (GAlib's simple algorithm). 2: overlapping generations, half of them new (steady state).
  enum class Mode : std::uint8_t { simple = 1, steady_state = 2 } mode = Mode::simple;
  Start start = Start::random;  ///< scenario: its values are in the first population
};

/// One of pagmo's algorithms.
struct PagmoSettings {
  std::string algorithm;  ///< pagmo's name: cmaes, de, nsga2, sade, de1220, pso, sga, xnes, ...
  std::uint32_t population = 20;
  std::uint32_t generations = 1000;  ///< largest number of generations
  /// After this number of generations in which the best score improves by less than a thousandth, the search restarts
  /// from another random population, for landscapes with several summits. It then ends with its generations or
  /// evaluations. 0: it never restarts. The setting is only for algorithms that evolve by generation.
  std::uint32_t restart_after = 0;
  Start start = Start::random;      ///< scenario: its values are in the first population; not after a restart
  std::optional<double> sigma0;     ///< cmaes, xnes: first step size, as a share of the ranges
  std::optional<double> crossover;  ///< de, sga, nsga2: their CR, cr
  std::optional<double> scale;      ///< de: F
  std::optional<double> mutation;   ///< sga, nsga2: their m
};

/// The options above that an algorithm of pagmo has: sigma0, ...
[[nodiscard]] std::vector<std::string> pagmo_options(std::string_view algorithm);

using MethodSettings = std::variant<GreatDelugeSettings, GeneticSettings, PagmoSettings>;

}  // namespace proleg::optimize
