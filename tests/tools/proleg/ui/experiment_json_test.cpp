// Experiments as the page sends them. The oracle is the reader of experiment files.

#include "tools/proleg/ui/experiment_json.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <variant>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "shipped.hpp"
#include "sim/optimize/experiment/experiment.hpp"
#include "sim/scenario/sources.hpp"
#include "tests/support/files.hpp"
#include "tools/proleg/ui/search_form.hpp"

namespace proleg::tools {
namespace {

using nlohmann::json;

std::string parts_text(const optimize::Experiment& experiment) {
  std::string text;
  for (const optimize::ExperimentPart& part : optimize::parts_of(experiment)) {
    text += part.name + ": " + part.text + "\n";
  }
  return text;
}

/// What a person types into the dialogues of section 4.4.8 for the thesis's listing B.7.
json thesis_dialogue() {
  const auto parameter = [](const char* name, const char* lower, const char* upper, const char* step) {
    return json{{"module", 1},    {"parameter", name}, {"joints", nullptr},   {"same", true},        {"lower", lower},
                {"upper", upper}, {"step", step},      {"with_lower", false}, {"with_upper", false}, {"set", nullptr}};
  };
  return {
      {"method", "geneticAlgorithm"},
      {"settings",
       {{"popsize", "30"},
        {"pmut", "0.01"},
        {"pcross", "0.9"},
        {"nconvergence", "50"},
        {"pconvergence", "0.99"},
        {"gamode", "1"}}},
      {"parameters", {parameter("stuck_threshold", "50", "800", "25"), parameter("recovering", "0.01", "1", "0.01")}}};
}

TEST(ExperimentJson, TheThesissListingIsMadeByItsDialogue) {
  const sim::Scenario scenario = sim::shipped("adaptive_touch/reflex");
  sim::DiskFiles files;
  const optimize::Experiment printed =
      optimize::read_experiment(source_path("/tests/sim/optimize/experiment/thesis/MFIdemo.ga.xml"), files, scenario);
  const auto judged = judge_form(read_experiment_json(thesis_dialogue()), scenario);
  ASSERT_TRUE(std::holds_alternative<optimize::Experiment>(judged)) << std::get<FormProblem>(judged).text;
  EXPECT_EQ(parts_text(std::get<optimize::Experiment>(judged)), parts_text(printed));
}

TEST(ExperimentJson, OfAFileComesBackAsItWas) {
  const sim::Scenario scenario = sim::shipped("travelling_wave/uniform");
  for (const std::string name : {"great_deluge", "genetic", "cma_es", "pareto"}) {
    sim::DiskFiles files;
    const json experiment = experiment_json(optimize::read_experiment_form(
        source_path("/sim/scenarios/travelling_wave/" + name + ".optimise.xml"), files, scenario));
    EXPECT_EQ(experiment_json(read_experiment_json(experiment)), experiment) << name;
    EXPECT_TRUE(std::holds_alternative<optimize::Experiment>(judge_form(read_experiment_json(experiment), scenario)));
  }
}

TEST(ExperimentJson, OfAnotherKindIsRefused) {
  for (const json& experiment :
       {json(), json(5), json::array(), json{{"method", 5}}, json{{"settings", {{"popsize", 30}}}},
        json{{"parameters", {5}}}, json{{"parameters", {{{"module", -1}}}}}, json{{"parameters", {{{"joints", {64}}}}}},
        json{{"objectives", {{{"terms", {5}}}}}}, json{{"trials", "5"}}, json{{"reuse", "yes"}},
        json{{"seed", std::string(2000, '1')}}, json{{"objectives", json::array_t(9, json::object())}}}) {
    EXPECT_THROW(static_cast<void>(read_experiment_json(experiment)), InputError) << experiment;
  }
}

}  // namespace
}  // namespace proleg::tools
