// An experiment as a form: its text is an experiment file, and an experiment file becomes the same form again. The
// oracle is the reader of experiment files: what it makes of the file and of the text of its form must agree.

#include "sim/optimize/experiment/experiment_form.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "experiment_files.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/optimize/experiment/method_declaration.hpp"
#include "tests/support/files.hpp"

namespace proleg::optimize {
namespace {

const std::string adaptive_touch = source_path("/sim/scenarios/adaptive_touch/");

std::string text_of(const std::vector<ExperimentPart>& parts) {
  std::string text;
  for (const ExperimentPart& part : parts) {
    text += part.name + ": " + part.text + "\n";
  }
  return text;
}

/// What the reader makes of a form, in the scenario.
Experiment experiment_of(const ExperimentForm& form, const sim::Scenario& scenario) {
  FilesOverDisk files;
  files.texts["form.optimise.xml"] = experiment_text(form, scenario, "none.simulation.xml").text;
  return read_experiment("form.optimise.xml", files, scenario);
}

/// The form of a file, and whether the text of the form is the same experiment.
ExperimentForm expect_the_same(const std::string& file, const std::string& simulation) {
  sim::DiskFiles files;
  const Experiment experiment = read_experiment(file, files, simulation);
  const ExperimentForm form = read_experiment_form(file, files, experiment.scenario);
  const Experiment again = experiment_of(form, experiment.scenario);
  EXPECT_EQ(text_of(parts_of(again)), text_of(parts_of(experiment))) << file;
  EXPECT_EQ(again.evaluations, experiment.evaluations) << file;
  EXPECT_EQ(again.fingerprint(), experiment.fingerprint()) << file;
  return form;
}

TEST(ExperimentForm, OfEveryShippedExperimentIsTheSameExperiment) {
  for (const std::string name : {"great_deluge", "genetic", "cma_es", "pareto"}) {
    expect_the_same(travelling_wave + name + ".optimise.xml", travelling_wave + "uniform.simulation.xml");
  }
  for (const std::string name : {"great_deluge", "genetic", "cma_es", "great_deluge_bounded"}) {
    expect_the_same(adaptive_touch + name + ".optimise.xml", adaptive_touch + "reflex.simulation.xml");
  }
}

TEST(ExperimentForm, OfTheThesissFileHasWhatItsDialoguesShow) {
  const ExperimentForm form = expect_the_same(source_path("/tests/sim/optimize/experiment/thesis/MFIdemo.ga.xml"),
                                              adaptive_touch + "reflex.simulation.xml");
  EXPECT_EQ(form.method, "geneticAlgorithm");
  ASSERT_EQ(form.parameters.size(), 2U);
  EXPECT_EQ(form.parameters[0].parameter, "stuck_threshold") << "the thesis calls it Get-stuck-threshold";
  EXPECT_TRUE(form.parameters[0].is_same);
  EXPECT_FALSE(form.parameters[0].with_lower) << "between 50 and 800, both exclusive";
  EXPECT_FALSE(form.parameters[0].with_upper);
}

/// Everything that a form can have, for the shipped caterpillar.
ExperimentForm full_form() {
  ExperimentForm form;
  form.method = "geneticAlgorithm";
  form.settings = {{"popsize", "12"}, {"pmut", "0.8"}, {"gamode", "2"}, {"start", "random"}, {"pcross", ""}};
  ParameterForm amplitude;
  amplitude.parameter = "amplitude";
  amplitude.joints = JointMask::of(0);
  amplitude.joints->insert(3);
  amplitude.lower = "0 10";
  amplitude.upper = "40";
  amplitude.step = "2.5";
  amplitude.with_upper = false;
  ParameterForm frequency;
  frequency.parameter = "frequency";
  frequency.is_same = true;
  frequency.set = "0.5 0.25 1";
  form.parameters = {amplitude, frequency};
  form.heading = "90";
  form.objectives = {{"thrifty", "maximise", "-1", {{"distance", "2"}, {"mechanical_energy", "-0.1"}}}};
  form.evaluations = "500";
  form.seed = "18446744073709551615";
  form.reuse = false;
  form.trials = TrialsForm{"3", "worst", "fresh", "0.1", "0.05", "0.02", "5", "0.001"};
  form.confirmation = ConfirmationForm{"3", "0"};
  return form;
}

sim::Scenario caterpillar() {
  sim::DiskFiles files;
  return sim::read_scenario(travelling_wave + "uniform.simulation.xml", files);
}

TEST(ExperimentForm, ReachesEverythingThatAnExperimentHas) {
  const sim::Scenario scenario = caterpillar();
  const Experiment experiment = experiment_of(full_form(), scenario);
  const auto& genetic = std::get<GeneticSettings>(experiment.method);
  EXPECT_EQ(genetic.population, 12U);
  EXPECT_EQ(genetic.mutation, 0.8);
  EXPECT_EQ(genetic.crossover, 0.9) << "an empty text is the default";
  EXPECT_EQ(genetic.mode, GeneticSettings::Mode::steady_state);
  EXPECT_EQ(genetic.start, Start::random);
  ASSERT_EQ(experiment.space.dimensions.size(), 3U);
  EXPECT_EQ(experiment.space.dimensions[0].name, "amplitude:J5");
  EXPECT_EQ(experiment.space.dimensions[1].name, "amplitude:J2");
  // The first number of the range is that of J2, which is the first of them in the robot's file.
  EXPECT_EQ(experiment.space.dimensions[0].values.size(), 12U) << "10 to 37.5";
  EXPECT_EQ(experiment.space.dimensions[1].values.size(), 16U) << "0 to 37.5: 40 is not one of them";
  EXPECT_EQ(experiment.space.dimensions[2].name, "frequency");
  EXPECT_EQ(experiment.space.dimensions[2].values.size(), 3U);
  EXPECT_EQ(experiment.heading_deg, 90.0);
  ASSERT_EQ(experiment.objectives.size(), 1U);
  EXPECT_EQ(experiment.objectives[0].name, "thrifty");
  EXPECT_EQ(experiment.objectives[0].failed, -1.0);
  EXPECT_EQ(experiment.objectives[0].terms[1].weight, -0.1);
  EXPECT_EQ(experiment.evaluations, 500U);
  EXPECT_EQ(experiment.seed, 18446744073709551615U);
  EXPECT_FALSE(experiment.reuse);
  EXPECT_EQ(experiment.trials.count, 3U);
  EXPECT_EQ(experiment.trials.aggregate, Aggregate::worst);
  EXPECT_EQ(experiment.trials.random_numbers, RandomNumbers::fresh);
  EXPECT_EQ(experiment.trials.spread.friction, 0.1);
  EXPECT_EQ(experiment.trials.spread.mass, 0.05);
  EXPECT_EQ(experiment.trials.spread.servo_gain, 0.02);
  EXPECT_EQ(experiment.trials.spread.latency_ms, 5.0);
  EXPECT_EQ(experiment.trials.spread.contact_noise, 0.001);
  EXPECT_EQ(experiment.confirmation.candidates, 3U);
  EXPECT_EQ(experiment.confirmation.runs, 0U);
}

TEST(ExperimentForm, WithoutObjectivesMaximisesTheDistance) {
  ExperimentForm form = full_form();
  form.objectives.clear();
  EXPECT_EQ(experiment_of(form, caterpillar()).objectives[0].name, "distance");
  form.heading.clear();
  EXPECT_EQ(experiment_of(form, caterpillar()).objectives[0].name, "distance");
}

/// The field of the line that an error of the reader names; empty: there is none.
std::string field_of_error(const ExperimentForm& form) {
  const sim::Scenario scenario = caterpillar();
  const ExperimentText text = experiment_text(form, scenario, "none.simulation.xml");
  FilesOverDisk files;
  files.texts["form.optimise.xml"] = text.text;
  try {
    static_cast<void>(read_experiment("form.optimise.xml", files, scenario));
  } catch (const InputError& error) {
    EXPECT_GE(error.line(), 1) << error.what();
    return text.fields.at(static_cast<std::size_t>(error.line()) - 1);
  }
  return "no error";
}

TEST(ExperimentForm, AnErrorNamesTheFieldThatMadeTheLine) {
  const auto with = [](const auto& change) {
    ExperimentForm form = full_form();
    change(form);
    return field_of_error(form);
  };
  EXPECT_EQ(with([](ExperimentForm& /*form*/) {}), "no error");
  EXPECT_EQ(with([](ExperimentForm& form) { form.settings["popsize"] = "1"; }), "settings.popsize");
  EXPECT_EQ(with([](ExperimentForm& form) { form.settings["sigma0"] = "0.5"; }), "settings.sigma0");
  EXPECT_EQ(with([](ExperimentForm& form) { form.parameters[0].upper = "4000"; }), "parameters.0.upper");
  EXPECT_EQ(with([](ExperimentForm& form) { form.parameters[0].lower = ""; }), "parameters.0.lower");
  EXPECT_EQ(with([](ExperimentForm& form) { form.parameters[0].step = "0"; }), "parameters.0.step");
  EXPECT_EQ(with([](ExperimentForm& form) { form.parameters[1].set = "a"; }), "parameters.1.set");
  EXPECT_EQ(with([](ExperimentForm& form) { form.parameters[1].parameter = "none"; }), "parameters.1.parameter");
  EXPECT_EQ(with([](ExperimentForm& form) { form.parameters[0].joints = JointMask(); }), "parameters.0.joints");
  EXPECT_EQ(with([](ExperimentForm& form) { form.parameters.clear(); }), "parameters");
  EXPECT_EQ(with([](ExperimentForm& form) { form.heading = "500"; }), "heading");
  EXPECT_EQ(with([](ExperimentForm& form) { form.objectives[0].failed = ""; }), "objectives.0");
  EXPECT_EQ(with([](ExperimentForm& form) { form.objectives[0].terms[1].weight = "0"; }), "objectives.0.terms.1");
  EXPECT_EQ(with([](ExperimentForm& form) { form.evaluations = "-1"; }), "evaluations");
  EXPECT_EQ(with([](ExperimentForm& form) { form.seed = "x"; }), "seed");
  EXPECT_EQ(with([](ExperimentForm& form) { form.trials->count = "0"; }), "trials.count");
  EXPECT_EQ(with([](ExperimentForm& form) { form.trials->latency = "500"; }), "trials.latency");
  EXPECT_EQ(with([](ExperimentForm& form) { form.confirmation->runs = "-1"; }), "confirmation");
  EXPECT_EQ(with([](ExperimentForm& form) { form.racing = RacingForm{"2", ""}; }), "racing");
}

TEST(ExperimentForm, AnyTextIsRefusedOrReadAndNeverBecomesMarkup) {
  const sim::Scenario scenario = caterpillar();
  for (const std::string text : {"</lowerBounds><evil/>", "\"><x", "&amp;", "1\n2", "\x01\xFF", "<!--", "]]>"}) {
    ExperimentForm form = full_form();
    form.parameters[0].lower = text;
    form.objectives[0].name = text;
    form.settings["popsize"] = text;
    EXPECT_THROW(static_cast<void>(experiment_of(form, scenario)), InputError) << text;
  }
  ExperimentForm form = full_form();
  form.settings["popsize></popsize><x"] = "1";
  EXPECT_THROW(static_cast<void>(experiment_text(form, scenario, "s")), InputError);
  form = full_form();
  form.method = "x";
  EXPECT_THROW(static_cast<void>(experiment_text(form, scenario, "s")), InputError);
  form = full_form();
  form.parameters[0].slot = 3;
  EXPECT_THROW(static_cast<void>(experiment_text(form, scenario, "s")), InputError);
}

TEST(ExperimentForm, OfAnExperimentForAnotherRobotIsRefused) {
  sim::DiskFiles files;
  EXPECT_THROW(static_cast<void>(read_experiment_form(adaptive_touch + "genetic.optimise.xml", files, caterpillar())),
               InputError);
}

/// exact_text() would write 1e+06.
std::string bound_text(const MethodSetting& setting, double bound) {
  return setting.kind == MethodSetting::Kind::whole ? std::to_string(std::llround(bound)) : exact_text(bound);
}

/// Settings with their defaults make the same method as none.
TEST(MethodDeclarations, HaveTheDefaultsAndRangesOfTheReader) {
  const sim::Scenario scenario = caterpillar();
  for (const MethodDeclaration& method : methods()) {
    const std::string name = std::string(method.tag) + " " + std::string(method.algorithm);
    ExperimentForm form = full_form();
    form.method = method.tag;
    form.algorithm = method.algorithm;
    form.settings.clear();
    if (method.has_map) {
      form.axes = {{"height", "0", "0.1", "10"}, {"duty_factor", "0", "1", "10"}};
    }
    const std::string usual = text_of(parts_of(experiment_of(form, scenario)));
    for (const MethodSetting& setting : method.settings) {
      EXPECT_FALSE(setting.help.empty()) << name << setting.tag;
      form.settings = {{std::string(setting.tag), setting.usual}};
      EXPECT_EQ(text_of(parts_of(experiment_of(form, scenario))), usual) << name << " " << setting.tag;
      const bool is_choice = setting.kind == MethodSetting::Kind::choice;
      const std::vector<std::string> accepted =
          is_choice
              ? std::vector<std::string>(setting.choices.begin(), setting.choices.end())
              : std::vector<std::string>{bound_text(setting, setting.lowest), bound_text(setting, setting.highest)};
      for (const std::string& value : accepted) {
        form.settings = {{std::string(setting.tag), value}};
        ExperimentForm accepting = form;
        for (AxisForm& axis : accepting.axes) {
          axis.cells = setting.tag == "centroids" && value != "0" ? "" : axis.cells;
        }
        EXPECT_NO_THROW(static_cast<void>(experiment_of(accepting, scenario))) << name << " " << setting.tag << value;
      }
      const std::vector<std::string> refused =
          is_choice ? std::vector<std::string>{"none"}
                    : std::vector<std::string>{bound_text(setting, setting.lowest - 1),
                                               bound_text(setting, setting.highest * 2 + 1)};
      for (const std::string& value : refused) {
        form.settings = {{std::string(setting.tag), value}};
        EXPECT_THROW(static_cast<void>(experiment_of(form, scenario)), InputError) << name << setting.tag << value;
      }
    }
  }
}

TEST(MethodDeclarations, AreInTheDocument) {
  const std::string page = file_contents(source_path("/docs/optimisation-files.md"));
  for (const MethodDeclaration& method : methods()) {
    EXPECT_NE(page.find(method.algorithm.empty() ? "`" + std::string(method.tag) + "`" : std::string(method.algorithm)),
              std::string::npos)
        << method.tag << " " << method.algorithm;
    for (const MethodSetting& setting : method.settings) {
      EXPECT_NE(page.find("`" + std::string(setting.tag) + "`"), std::string::npos) << setting.tag;
    }
  }
}

}  // namespace
}  // namespace proleg::optimize
