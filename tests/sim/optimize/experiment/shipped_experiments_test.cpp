// The experiments that ship, against what the thesis gives (section 6.1, tables 6.1 and 6.3), and the thesis's own
// file.

#include <gtest/gtest.h>

#include "experiment_files.hpp"
#include "shared/fixed/decimal.hpp"
#include "tests/support/files.hpp"

namespace proleg::optimize {
namespace {

Experiment shipped(const std::string& name) {
  sim::DiskFiles files;
  return read_experiment(travelling_wave + name + ".optimise.xml", files);
}

/// The search space of thesis section 6.1.
void expect_amplitudes(const SearchSpace& space) {
  ASSERT_GE(space.dimensions.size(), 5U);
  for (std::size_t d = 0; d < 5; ++d) {
    const Dimension& dimension = space.dimensions[d];
    EXPECT_EQ(dimension.name, "amplitude:J" + std::to_string(5 - d)) << "joints count from head to tail";
    ASSERT_EQ(dimension.targets.size(), 1U);
    EXPECT_EQ(dimension.targets[0].joint, d);
    ASSERT_EQ(dimension.values.size(), 161U);
    for (unsigned n = 0; n < 161; ++n) {
      const std::string text = std::to_string(n / 4) + std::vector<std::string>{"", ".25", ".5", ".75"}[n % 4];
      EXPECT_EQ(dimension.values[n], parse_decimal(text, Unit::degree).raw) << text;
      Candidate candidate(space.dimensions.size(), 0);
      candidate[d] = n;
      EXPECT_EQ(space.value_text(candidate, d), text);
    }
  }
}

TEST(ShippedExperiments, HaveTheThesissSearchSpace) {
  for (const std::string name : {"great_deluge", "genetic", "cma_es"}) {
    const Experiment experiment = shipped(name);
    expect_amplitudes(experiment.space);
    EXPECT_EQ(experiment.space.size(), 108'175'616'801.0) << "thesis, section 6.1, footnote 2";
    ASSERT_EQ(experiment.objectives.size(), 1U);
    EXPECT_EQ(experiment.objectives[0].name, "distance");
    EXPECT_EQ(experiment.scenario.duration_s, 30.0);
    EXPECT_FALSE(depends_on_seed(experiment.scenario, experiment.space, experiment.trials.spread));
    const Candidate reference = experiment.space.nearest(experiment.scenario);
    EXPECT_EQ(reference, Candidate(5, 160)) << "40 degrees on every joint";
  }
}

TEST(ShippedExperiments, OfTheThesisStartAtRandomAsThere) {
  EXPECT_EQ(std::get<GreatDelugeSettings>(shipped("great_deluge").method).start, Start::random);
  EXPECT_EQ(std::get<GeneticSettings>(shipped("genetic").method).start, Start::random);
  EXPECT_EQ(std::get<PagmoSettings>(shipped("cma_es").method).start, Start::random);
  EXPECT_EQ(std::get<PagmoSettings>(shipped("pareto").method).start, Start::scenario) << "the default";
}

TEST(ShippedExperiments, GreatDelugeHasTheSettingsOfTable61) {
  const Experiment experiment = shipped("great_deluge");
  const auto& deluge = std::get<GreatDelugeSettings>(experiment.method);
  EXPECT_EQ(deluge.credits, 10U);
  EXPECT_EQ(deluge.retries, 200U);
  EXPECT_EQ(deluge.water_level, 0.15);
  EXPECT_EQ(deluge.rain, 0.01);
  EXPECT_EQ(deluge.confidence, 20U);
  EXPECT_EQ(experiment.evaluations, 6000U);
}

TEST(ShippedExperiments, GeneticHasTheSettingsOfTable63) {
  const Experiment experiment = shipped("genetic");
  const auto& genetic = std::get<GeneticSettings>(experiment.method);
  EXPECT_EQ(genetic.population, 30U);
  EXPECT_EQ(genetic.mutation, 0.8);
  EXPECT_EQ(genetic.crossover, 0.2);
  EXPECT_EQ(genetic.convergence, 0.99);
  EXPECT_EQ(genetic.generations_to_convergence, 50U);
  EXPECT_EQ(experiment.evaluations, 5000U) << "no run of the thesis made more (section 7)";
}

TEST(ShippedExperiments, CmaEsHasHalfOfTheEvaluationsAndRestarts) {
  const Experiment experiment = shipped("cma_es");
  EXPECT_EQ(method_name(experiment.method), "cmaes");
  EXPECT_EQ(experiment.evaluations, 2000U);
  const auto& cma_es = std::get<PagmoSettings>(experiment.method);
  EXPECT_EQ(cma_es.population, 32U) << "docs/optimisation.md has thirty searches with these three";
  EXPECT_EQ(cma_es.restart_after, 5U);
  EXPECT_EQ(cma_es.sigma0, 0.7);
}

TEST(ShippedExperiments, ParetoSetsSpeedAgainstTheCostOfTransport) {
  const Experiment experiment = shipped("pareto");
  EXPECT_EQ(method_name(experiment.method), "nsga2");
  expect_amplitudes(experiment.space);
  ASSERT_EQ(experiment.space.dimensions.size(), 7U);
  const Dimension& frequency = experiment.space.dimensions[5];
  EXPECT_EQ(frequency.name, "frequency");
  EXPECT_EQ(frequency.targets.size(), 5U);
  EXPECT_EQ(frequency.values.front(), parse_decimal("0.2", Unit::hertz).raw);
  EXPECT_EQ(frequency.values.back(), parse_decimal("1", Unit::hertz).raw);
  const Dimension& phase = experiment.space.dimensions[6];
  EXPECT_EQ(phase.name, "phase_difference");
  EXPECT_EQ(phase.values.front(), parse_decimal("20", Unit::phase_degree).raw);
  EXPECT_EQ(phase.values.back(), parse_decimal("120", Unit::phase_degree).raw);
  ASSERT_EQ(experiment.objectives.size(), 2U);
  EXPECT_EQ(experiment.objectives[0].name, "speed");
  EXPECT_EQ(experiment.objectives[0].goal, Goal::maximise);
  EXPECT_EQ(experiment.objectives[1].name, "cost_of_transport");
  EXPECT_EQ(experiment.objectives[1].goal, Goal::minimise);
}

TEST(ShippedExperiments, OfTheAdaptiveAlgorithmHaveTheSearchSpaceOfTable65) {
  for (const char* name : {"great_deluge_bounded", "genetic", "cma_es"}) {
    sim::DiskFiles files;
    const Experiment experiment =
        read_experiment(source_path("/sim/scenarios/adaptive_touch/" + std::string(name) + ".optimise.xml"), files);
    EXPECT_EQ(experiment.space.size(), 740e9) << name << ": thesis, section 6.2, footnote 10";
    ASSERT_EQ(experiment.space.dimensions.size(), 10U);
    EXPECT_EQ(experiment.space.dimensions[0].name, "stuck_threshold");
    EXPECT_EQ(experiment.space.dimensions[0].values.size(), 37U);
    EXPECT_EQ(experiment.space.dimensions[1].values.size(), 200U);
    for (const Dimension& dimension : experiment.space.dimensions) {
      EXPECT_EQ(dimension.targets.size(), 5U) << "the same on all joints";
    }
    EXPECT_EQ(experiment.scenario.duration_s, 90.0);
  }
}

TEST(ShippedExperiments, OfTheAdaptiveAlgorithmHaveTheSettingsOfTables66And68) {
  sim::DiskFiles files;
  const std::string folder = source_path("/sim/scenarios/adaptive_touch/");
  for (const char* name : {"great_deluge", "great_deluge_bounded"}) {
    const Experiment experiment = read_experiment(folder + name + ".optimise.xml", files);
    const auto& deluge = std::get<GreatDelugeSettings>(experiment.method);
    EXPECT_EQ(deluge.water_level, 0.6);
    EXPECT_EQ(deluge.rain, 0.02);
    EXPECT_EQ(deluge.credits, 10U);
    EXPECT_EQ(deluge.retries, 200U);
    EXPECT_EQ(deluge.confidence, 20U);
  }
  const Experiment experiment = read_experiment(folder + "genetic.optimise.xml", files);
  const auto& genetic = std::get<GeneticSettings>(experiment.method);
  EXPECT_EQ(genetic.population, 40U);
  EXPECT_EQ(genetic.mutation, 1.0);
  EXPECT_EQ(genetic.crossover, 0.0);
  EXPECT_EQ(genetic.generations_to_convergence, 50U);
  EXPECT_EQ(genetic.convergence, 0.99);
}

TEST(ShippedExperiments, KeepEveryFileThatWasReadTheirOwnFirst) {
  const Experiment experiment = shipped("great_deluge");
  ASSERT_EQ(experiment.sources.size(), experiment.scenario.sources.size() + 1);
  EXPECT_TRUE(experiment.sources[0].path.ends_with("great_deluge.optimise.xml"));
  EXPECT_NE(experiment.sources[0].text.str().find("<greatDeluge>"), std::string::npos);
  EXPECT_TRUE(experiment.sources[1].path.ends_with("uniform.simulation.xml"));
}

const std::string thesis_file = source_path("/tests/sim/optimize/experiment/thesis/MFIdemo.ga.xml");
const std::string uniform = travelling_wave + "uniform.simulation.xml";

/// The thesis's file (listing B.7) with texts replaced, wherever they stand.
Experiment thesis_experiment(const std::vector<std::pair<std::string, std::string>>& replacements,
                             const std::optional<std::filesystem::path>& simulation = uniform) {
  FilesOverDisk files;
  std::string text = sim::DiskFiles().read(thesis_file).value();
  for (const auto& [from, to] : replacements) {
    EXPECT_NE(text.find(from), std::string::npos) << from;
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
      text.replace(at, from.size(), to);
    }
  }
  files.texts["MFIdemo.ga.xml"] = text;
  return read_experiment("MFIdemo.ga.xml", files, simulation);
}

template <typename Read>
std::string message_of_reading(const Read& read) {
  try {
    static_cast<void>(read());
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(ThesisFile, IsRefusedByTheNameOfTheAlgorithmThatIsNotThere) {
  EXPECT_EQ(message_of_reading([] { return thesis_experiment({}); }),
            "MFIdemo.ga.xml:12: found unknown module 'Global Adaptive Touch', expected one of "
            "PatternGenerator_sinusoidal (1)");
}

TEST(ThesisFile, NamesNoScenario) {
  EXPECT_EQ(message_of_reading([] { return thesis_experiment({}, std::nullopt); }),
            "MFIdemo.ga.xml:1: found no <simulation> in <geneticAlgorithm>, expected the scenario, named there or with "
            "--simulation");
}

TEST(ThesisFile, IsReadAsPrinted) {
  const Experiment experiment =
      thesis_experiment({}, source_path("/sim/scenarios/adaptive_touch/reflex.simulation.xml"));
  ASSERT_EQ(experiment.space.dimensions.size(), 2U);
  const Dimension& first = experiment.space.dimensions[0];
  EXPECT_EQ(first.name, "stuck_threshold");
  // Between 50 and 800, both exclusive, in steps of 25.
  ASSERT_EQ(first.values.size(), 29U);
  EXPECT_EQ(first.values.front(), 75);
  EXPECT_EQ(first.values.back(), 775);
  const Dimension& second = experiment.space.dimensions[1];
  EXPECT_EQ(second.name, "recovering");
  ASSERT_EQ(second.values.size(), 98U);
  EXPECT_EQ(second.values.front(), parse_decimal("0.02", Unit::degree).raw);
  EXPECT_EQ(second.values.back(), parse_decimal("0.99", Unit::degree).raw);
}

TEST(ThesisFile, IsReadAsPrintedWithTheNamesOfAnAlgorithmThatShips) {
  const Experiment experiment = thesis_experiment({{"Global Adaptive Touch", "PatternGenerator_sinusoidal"},
                                                   {"Get-stuck-threshold", "phase_difference"},
                                                   {"back to zero constant", "frequency"}});
  const auto& genetic = std::get<GeneticSettings>(experiment.method);
  EXPECT_EQ(genetic.population, 30U);
  EXPECT_EQ(genetic.mutation, 0.01);
  EXPECT_EQ(genetic.crossover, 0.9);
  EXPECT_EQ(genetic.generations_to_convergence, 50U);
  EXPECT_EQ(genetic.convergence, 0.99);
  EXPECT_EQ(genetic.mode, GeneticSettings::Mode::simple);

  ASSERT_EQ(experiment.space.dimensions.size(), 2U);
  const Dimension& first = experiment.space.dimensions[0];
  EXPECT_EQ(first.name, "phase_difference");
  EXPECT_EQ(first.targets.size(), 5U);
  // Between 50 and 800, both exclusive, in steps of 25.
  ASSERT_EQ(first.values.size(), 29U);
  for (unsigned n = 0; n < 29; ++n) {
    EXPECT_EQ(first.values[n], parse_decimal(std::to_string(75 + 25 * n), Unit::phase_degree).raw);
  }
  const Dimension& second = experiment.space.dimensions[1];
  EXPECT_EQ(second.name, "frequency");
  // Between 0.01 and 1, both exclusive, in steps of 0.01.
  ASSERT_EQ(second.values.size(), 98U);
  for (unsigned n = 0; n < 98; ++n) {
    EXPECT_EQ(second.values[n], parse_decimal(std::to_string(n + 2) + "e-2", Unit::hertz).raw);
  }
}

TEST(ThesisFile, IsRefusedWhereTheDeclaredRangeIsNarrowerAndReadWithBoundsWithin) {
  const std::vector<std::pair<std::string, std::string>> names{{"Global Adaptive Touch", "PatternGenerator_sinusoidal"},
                                                               {"Get-stuck-threshold", "amplitude"},
                                                               {"back to zero constant", "frequency"}};
  EXPECT_EQ(message_of_reading([&] { return thesis_experiment(names); }),
            "MFIdemo.ga.xml:18: found '775' for parameter 'amplitude', expected a number from 0 to 90 deg");
  std::vector<std::pair<std::string, std::string>> bounds = names;
  bounds.emplace_back("<upperBounds>800<", "<upperBounds>100<");
  EXPECT_EQ(thesis_experiment(bounds).space.dimensions[0].values,
            (std::vector<std::int32_t>{parse_decimal("75", Unit::degree).raw}));
}

}  // namespace
}  // namespace proleg::optimize
