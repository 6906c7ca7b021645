#include "sim/optimize/report/thesis_experiment.hpp"

#include "made_up.hpp"

namespace proleg::optimize {
namespace {

const ThesisExperiment& wave = travelling_wave_experiment();

/// The uniform amplitudes with this distance.
std::vector<Reference> uniform_at(double distance_m) { return {{wave.references.data(), distance_m, distance_m}}; }

std::vector<std::vector<std::string>> cells_of(const std::string& table) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream lines(table);
  for (std::string line; std::getline(lines, line);) {
    std::vector<std::string>& row = rows.emplace_back(1);
    for (const char c : line) {
      if (c == '\t') {
        row.emplace_back();
      } else {
        row.back() += c;
      }
    }
  }
  return rows;
}

TEST(ExperimentTable, HasTheTenBestRunsAboveTheThesiss) {
  std::vector<std::vector<double>> scores;
  scores.reserve(12);
  for (int i = 0; i < 12; ++i) {
    scores.push_back({0.5, 1.5 + 0.0251 * ((i * 5) % 12), 1.0});
  }
  const auto rows = cells_of(experiment_table(wave, method_of("great-deluge", scores)));
  ASSERT_EQ(rows.size(), 1U + 6U + 6U);
  for (const auto& row : rows) {
    EXPECT_EQ(row.size(), 12U);
  }
  EXPECT_EQ(rows[0][2], "1");
  EXPECT_EQ(rows[0][11], "10");
  EXPECT_EQ(rows[1][1], "Joint 0");
  EXPECT_EQ(rows[1][2], "40");  // index 160 of quarters of a degree
  EXPECT_EQ(rows[2][2], "39.75");
  EXPECT_EQ(rows[5][1], "Joint 4");
  EXPECT_EQ(rows[5][2], "0");
  EXPECT_EQ(rows[6][1], "Displacement [m]");
  EXPECT_EQ(rows[6][2], "1.776");   // 1.5 + 11 * 0.0251
  EXPECT_EQ(rows[6][11], "1.550");  // the tenth best: 1.5 + 2 * 0.0251
  EXPECT_EQ(rows[7][0], "thesis, table 6.2");
  EXPECT_EQ(rows[11][5], "0.75");
  EXPECT_EQ(rows[12][2], "1.958");
}

TEST(ExperimentTable, HasEmptyCellsForFewerRunsAndNoThesisForOtherMethods) {
  const auto rows = cells_of(experiment_table(wave, method_of("cmaes", {{1.0}, {2.0}, {}})));
  ASSERT_EQ(rows.size(), 7U);
  EXPECT_EQ(rows[6][2], "2.000");
  EXPECT_EQ(rows[6][3], "1.000");
  EXPECT_EQ(rows[6][4], "");
}

TEST(ExperimentTable, OrdersJointsFromTheHeadWhateverTheFileDoes) {
  MethodRuns method = method_of("cmaes", {{1.0}});
  std::ranges::reverse(method.space.dimensions);
  for (Evaluation& evaluation : method.runs.front()) {
    std::ranges::reverse(evaluation.candidate);
  }
  const auto rows = cells_of(experiment_table(wave, method));
  EXPECT_EQ(rows[1][2], "40");
  EXPECT_EQ(rows[5][2], "0");
}

TEST(ExperimentSummary, SaysWhatCameOut) {
  const std::vector<MethodRuns> methods{method_of("great-deluge", {{0.1, 0.2, 1.0, 2.0}, {0.1, 0.2, 1.0, 1.9, 1.8}}),
                                        method_of("genetic", {{1.0, 1.5, 1.8}}),
                                        method_of("cmaes", {{1.0, 1.96}, {1.0, 1.96}})};
  const std::string text = experiment_summary(wave, methods, uniform_at(1.6));
  for (const char* part : {"1.600 m (the thesis: 1.65 m)", "4..5", "1.950", "0.071", "2.000", "+25.0 %",  // 2 / 1.6
                           "+18.7 %", "+13.8 %",  // 1.958 / 1.65, 1.878 / 1.65
                           "stays above the genetic algorithm's after evaluation 3 (the thesis: at around 5000)",
                           "genetic's mean does not reach great deluge's final mean (1.950 m)",
                           "cmaes's mean reaches great deluge's final mean (1.950 m) after 2 evaluations: 44.4 %"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
  }
}

TEST(ExperimentSummary, HasTheJudgedDistancesAndThoseOfTheSearch) {
  MethodRuns method = method_of("cmaes", {{1.0, 2.0}, {1.0, 1.8}});
  method.judged = {evaluation_of(1, 1.7), evaluation_of(0, 1.74)};
  const std::string text = experiment_summary(wave, std::vector{method}, uniform_at(1.6));
  for (const char* part : {"1.720", "1.740", "+8.7 %",  // judged: mean, best, 1.74 / 1.6
                           "in the search", "1.900", "2.000"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
  }
  EXPECT_EQ(cells_of(experiment_table(wave, method))[6][2], "1.740");
}

TEST(ExperimentSummary, SaysWhetherTheMethodsDiffer) {
  const std::vector<std::vector<double>> low{{1.0}, {1.1}, {1.2}, {1.3}, {1.4}};
  const std::vector<std::vector<double>> high{{2.0}, {2.1}, {2.2}, {2.3}, {2.4}};
  const std::vector<std::vector<double>> mixed{{1.05}, {2.15}, {1.25}, {2.35}, {1.45}};
  const std::vector<MethodRuns> methods{method_of("genetic", low), method_of("cmaes", high), method_of("de", mixed),
                                        method_of("none", {{}})};
  const std::vector<MethodDifference> differences = method_differences(methods);
  ASSERT_EQ(differences.size(), 3U);
  EXPECT_EQ(differences[0].one, "genetic");
  EXPECT_EQ(differences[0].other, "cmaes");
  EXPECT_EQ(differences[0].share_above, 0.0);
  EXPECT_NEAR(differences[0].p_value, 3 * 2.0 / 252.0, 1e-12) << "two of 252 choices, corrected for three pairs";
  const std::string text = experiment_summary(wave, methods, uniform_at(1.6));
  for (const char* part : {"cmaes goes farther than genetic in 100 % of the pairs of runs, p = 0.024: they differ",
                           "de goes farther than genetic in 76 %", "no difference is shown"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
  }
}

TEST(ExperimentFigures, ShowEveryRunAndTheThesissNumbers) {
  const std::vector<MethodRuns> methods{method_of("great-deluge", {{0.1, 0.2, 1.0, 2.0}, {0.1, 0.2, 1.0, 1.9, 1.8}}),
                                        method_of("genetic", {{1.0, 1.5, 1.8}}), method_of("cmaes", {{1.0, 1.96}})};
  Picture every(draw_every_run(wave, methods[0], uniform_at(1.6)));
  EXPECT_EQ(every.lines("run"), 2U);
  for (const char* text : {"Great deluge: every run", "2 repetitions", "thesis 1.958", "best 2.000", "uniform 1.6"}) {
    EXPECT_TRUE(every.has_text(text)) << text;
  }
  MethodRuns reduced = methods[0];
  reduced.engine = "reduced";
  const std::string named = "Distances in the engine of the search, reduced";
  EXPECT_NE(draw_every_run(wave, reduced, uniform_at(1.6)).find(named), std::string::npos);
  EXPECT_NE(draw_method_comparison(wave, {&reduced, 1}, uniform_at(1.6)).find("(reduced engine)"), std::string::npos);
  EXPECT_EQ(draw_every_run(wave, methods[0], uniform_at(1.6)).find("engine"), std::string::npos);
  Picture range(draw_run_spread(wave, methods[1], uniform_at(1.6)));
  for (const char* text : {"Genetic algorithm", "thesis 1.878", "lowest 1.800", "mean 1.800", "highest 1.800"}) {
    EXPECT_TRUE(range.has_text(text)) << text;
  }
  Picture comparison(draw_method_comparison(wave, methods, uniform_at(1.6)));
  EXPECT_EQ(comparison.lines("run"), 4U);
  EXPECT_EQ(comparison.lines("mean"), 3U);
  for (const char* text :
       {"mean 1.950", "mean 1.800", "mean 1.960", "thesis 1.958", "thesis 1.878", "best 2.000", "uniform 1.6"}) {
    EXPECT_TRUE(comparison.has_text(text)) << text;
  }
}

TEST(ExperimentFigures, AreDrawnWhateverTheRuns) {
  const std::vector<std::vector<MethodRuns>> cases{
      {},
      {method_of("great-deluge", {})},
      {method_of("great-deluge", {{}})},
      {method_of("<b>", {{0.0}})},
      {method_of("genetic", {{0.0, 0.0, 0.0}, {0.0}})},
      {method_of("genetic", {{1e308, -1e308}, {-1e308}})},
      std::vector<MethodRuns>(9, method_of("de", {{1.0, 2.0}})),
  };
  for (const std::vector<MethodRuns>& methods : cases) {
    for (const double uniform_m : {1.6, 0.0, std::nan("")}) {
      EXPECT_TRUE(
          Picture(draw_method_comparison(wave, methods, uniform_at(uniform_m))).has_text("(b) Mean of the runs"));
      for (const MethodRuns& method : methods) {
        EXPECT_TRUE(Picture(draw_every_run(wave, method, uniform_at(uniform_m))).has_text("every run"));
        EXPECT_TRUE(Picture(draw_run_spread(wave, method, uniform_at(uniform_m))).has_text("highest"));
        EXPECT_NE(experiment_table(wave, method).find("Displacement"), std::string::npos);
      }
      EXPECT_NE(experiment_summary(wave, methods, uniform_at(uniform_m)).find("uniform amplitudes"), std::string::npos);
    }
  }
}

TEST(AdaptiveTouchExperiment, HasTheRowsOfTheThesisAndAllItsReferences) {
  const ThesisExperiment& touch = adaptive_touch_experiment();
  MethodRuns method{"great-deluge", {}, {}};
  for (const char* name : {"stuck_threshold", "recovering", "constant_1", "constant_8"}) {
    Dimension dimension;
    dimension.name = name;
    dimension.targets.emplace_back();
    dimension.values = {100, 125};
    method.space.dimensions.push_back(dimension);
  }
  Evaluation evaluation = evaluation_of(0, 3.5);
  evaluation.candidate = {1, 0, 0, 0};
  method.runs = {{evaluation}};
  const auto rows = cells_of(experiment_table(touch, method));
  ASSERT_EQ(rows.size(), 1U + 5U + 11U);
  EXPECT_EQ(rows[1][1], "Get-stuck");
  EXPECT_EQ(rows[1][2], "125");
  EXPECT_EQ(rows[2][1], "Recovering");
  EXPECT_EQ(rows[4][1], "Constant 8");
  EXPECT_EQ(rows[6][0], "thesis, table 6.7");
  EXPECT_EQ(rows[8][2], "11.8");
  EXPECT_EQ(rows[16][2], "3.960");
  const std::vector<Reference> references{
      {&touch.references[0], 1.4, 1.45}, {&touch.references[1], 3.0, 3.25}, {&touch.references[2], 4.0, 4.25}};
  const std::string text = experiment_summary(touch, std::vector{method}, references);
  for (const char* part : {"the sine without the reflex: 1.450 m", "the reflex as set by hand: 3.250 m",
                           "the sine on level ground: 4.250 m", "get-stuck", "125 ms", "+141.4 %", "110 ms"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
  }
  Picture comparison(draw_method_comparison(touch, std::vector{method}, references));
  for (const char* shown : {"no reflex 1.4", "set by hand 3", "level ground 4", "thesis 3.960"}) {
    EXPECT_TRUE(comparison.has_text(shown)) << shown;
  }
}

TEST(ExperimentFigures, DoNotGrowWithThirtyLongRuns) {
  MethodRuns method{"great-deluge", amplitudes(), {}};
  for (int i = 0; i < 30; ++i) {
    std::vector<double> scores;
    scores.reserve(6000);
    for (int k = 0; k < 6000; ++k) {
      scores.push_back(0.0003 * k + 0.001 * i);
    }
    method.runs.push_back(run_of(scores));
  }
  EXPECT_LT(draw_every_run(wave, method, uniform_at(1.65)).size(), 1'500'000U);
}

}  // namespace
}  // namespace proleg::optimize
