#pragma once

// Made-up experiments and evaluations, and checks of pictures.

#include <gtest/gtest.h>
#include <tinyxml2.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "sim/optimize/evaluation/task.hpp"
#include "sim/optimize/experiment/experiment.hpp"
#include "sim/optimize/report/method_runs.hpp"

namespace proleg::optimize {

[[nodiscard]] inline Objective objective_of(sim::Measure measure, Goal goal) {
  return {std::string(sim::declaration_of(measure).name), {{measure, 1.0}}, goal, goal == Goal::maximise ? 0.0 : 1e6};
}

/// Amplitudes of five joints, head first, from 0 to 40 degrees in quarters of a degree.
[[nodiscard]] inline SearchSpace amplitudes() {
  SearchSpace space;
  for (std::uint8_t joint = 0; joint < 5; ++joint) {
    Dimension dimension;
    dimension.name = "amplitude:J" + std::to_string(5 - joint);
    dimension.targets.emplace_back().joint = joint;
    dimension.unit = Unit::degree;
    for (int quarter = 0; quarter <= 160; ++quarter) {
      dimension.values.push_back(raw(Unit::degree, quarter, 4));
    }
    space.dimensions.push_back(dimension);
  }
  return space;
}

[[nodiscard]] inline Experiment experiment_of(std::vector<Objective> objectives) {
  Experiment experiment;
  experiment.path = "somewhere/made_up.optimise.xml";
  experiment.space = amplitudes();
  experiment.objectives = std::move(objectives);
  return experiment;
}

[[nodiscard]] inline Experiment distance_experiment() {
  return experiment_of({objective_of(sim::Measure::distance, Goal::maximise)});
}

/// An evaluation with the score of the distance, in m.
[[nodiscard]] inline Evaluation evaluation_of(std::uint64_t number, double distance) {
  Evaluation evaluation;
  evaluation.number = number;
  evaluation.candidate = {160, 159, static_cast<std::uint32_t>(number % 161), 158, 0};
  evaluation.scores = {distance};
  evaluation.measures[sim::Measure::distance] = distance;
  return evaluation;
}

/// An experiment with a map: so many axes from 0 to 1, each with so many cells.
[[nodiscard]] inline Experiment map_experiment(std::size_t axes, std::uint32_t cells) {
  Experiment experiment = distance_experiment();
  experiment.method = MapElitesSettings{};
  constexpr std::array measures{sim::Measure::height, sim::Measure::duty_factor, sim::Measure::slip,
                                sim::Measure::wave_count};
  for (std::size_t i = 0; i < axes; ++i) {
    experiment.axes.push_back({measures[i], 0.0, 1.0, cells});
    experiment.objectives.push_back(objective_of(measures[i], Goal::maximise));
    experiment.objectives.back().failed = -1e12;
  }
  return experiment;
}

/// An evaluation with the scores of all objectives of an experiment with a map.
[[nodiscard]] inline Evaluation evaluation_at(std::uint64_t number, std::vector<double> scores) {
  Evaluation evaluation = evaluation_of(number, scores.front());
  constexpr std::array measures{sim::Measure::distance, sim::Measure::height, sim::Measure::duty_factor,
                                sim::Measure::slip, sim::Measure::wave_count};
  for (std::size_t i = 0; i < scores.size(); ++i) {
    evaluation.measures[measures[i]] = scores[i];
  }
  evaluation.scores = std::move(scores);
  return evaluation;
}

[[nodiscard]] inline Evaluation failed_evaluation(std::uint64_t number, double score) {
  Evaluation evaluation = evaluation_of(number, score);
  evaluation.measures = {};
  evaluation.failure = "the robot flew apart";
  return evaluation;
}

/// The evaluations of a run with these scores.
[[nodiscard]] inline std::vector<Evaluation> run_of(const std::vector<double>& scores) {
  std::vector<Evaluation> run;
  run.reserve(scores.size());
  for (const double score : scores) {
    run.push_back(evaluation_of(run.size(), score));
  }
  return run;
}

[[nodiscard]] inline MethodRuns method_of(const std::string& name, const std::vector<std::vector<double>>& runs) {
  MethodRuns method{name, amplitudes(), {}};
  for (const std::vector<double>& scores : runs) {
    method.runs.push_back(run_of(scores));
  }
  return method;
}

/// The contents of a picture. Checks that it is XML and that all its coordinates are on the page.
class Picture {
 public:
  explicit Picture(const std::string& svg) {
    EXPECT_EQ(document_.Parse(svg.c_str()), tinyxml2::XML_SUCCESS) << document_.ErrorStr();
    if (document_.RootElement() != nullptr) {
      width_ = document_.RootElement()->DoubleAttribute("width");
      height_ = document_.RootElement()->DoubleAttribute("height");
      look_at(*document_.RootElement(), "");
    }
  }

  [[nodiscard]] bool has_text(const std::string& text) const {
    return std::ranges::any_of(texts_, [&](const std::string& shown) { return shown.find(text) != std::string::npos; });
  }
  /// Places of the marks within groups of this class.
  [[nodiscard]] std::size_t marks(const std::string& group) { return marks_[group]; }
  /// Number of lines within groups of this class.
  [[nodiscard]] std::size_t lines(const std::string& group) { return lines_[group]; }

 private:
  void expect_on_page(double x, double y) const {
    EXPECT_TRUE(x >= 0.0 && x <= width_ && y >= 0.0 && y <= height_) << x << ", " << y;
  }

  void look_at(const tinyxml2::XMLElement& element, const std::string& outer_group) {
    const std::string group = element.Attribute("class") != nullptr ? element.Attribute("class") : outer_group;
    for (const char* name : {"x", "y", "x1", "y1", "x2", "y2", "cx", "cy", "r", "width", "height"}) {
      if (element.Attribute(name) != nullptr) {
        double value = NAN;
        EXPECT_EQ(element.QueryDoubleAttribute(name, &value), tinyxml2::XML_SUCCESS) << element.Attribute(name);
        EXPECT_TRUE(std::isfinite(value)) << element.Attribute(name);
        const std::string axis = name;
        expect_on_page(axis.find('x') != std::string::npos ? value : 0.0,
                       axis.find('y') != std::string::npos ? value : 0.0);
      }
    }
    if (const char* points = element.Attribute("points")) {
      ++lines_[group];
      std::istringstream stream(points);
      char comma = ' ';
      double x = NAN;
      double y = NAN;
      while (stream >> x >> comma >> y) {
        expect_on_page(x, y);
      }
      EXPECT_TRUE(stream.eof()) << points;
    }
    if (const char* path = element.Attribute("d")) {
      const std::string text = path;
      EXPECT_EQ(text.find("nan"), std::string::npos);
      EXPECT_EQ(text.find("inf"), std::string::npos);
      for (std::size_t at = text.find('M'); at != std::string::npos; at = text.find('M', at + 1)) {
        ++marks_[group];
        std::istringstream stream(text.substr(at + 1, 30));
        double x = NAN;
        double y = NAN;
        stream >> x >> y;
        expect_on_page(x, y);
      }
    }
    if (element.GetText() != nullptr) {
      texts_.emplace_back(element.GetText());
    }
    for (const auto* child = element.FirstChildElement(); child != nullptr; child = child->NextSiblingElement()) {
      look_at(*child, group);
    }
  }

  tinyxml2::XMLDocument document_;
  double width_ = 0.0;
  double height_ = 0.0;
  std::vector<std::string> texts_;
  std::map<std::string, std::size_t> marks_;
  std::map<std::string, std::size_t> lines_;
};

}  // namespace proleg::optimize
