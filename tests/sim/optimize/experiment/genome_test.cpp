// What a genome section becomes.

#include <gtest/gtest.h>

#include "experiment_files.hpp"
#include "shared/fixed/decimal.hpp"
#include "sim/scenario/settings.hpp"

namespace proleg::optimize {
namespace {

std::vector<std::int32_t> degrees(const std::vector<std::string>& texts) {
  std::vector<std::int32_t> values;
  values.reserve(texts.size());
  for (const std::string& text : texts) {
    values.push_back(parse_decimal(text, Unit::degree).raw);
  }
  return values;
}

std::vector<std::string> names(const SearchSpace& space) {
  std::vector<std::string> result;
  for (const Dimension& dimension : space.dimensions) {
    result.push_back(dimension.name);
  }
  return result;
}

const std::string amplitude_range = R"(<upperBounds>40</upperBounds>
      <lowerBounds>10</lowerBounds>
      <boundsIncrements>0.5</boundsIncrements>
      <lowerBoundTypes>1</lowerBoundTypes>
      <upperBoundTypes>1</upperBoundTypes>
      <uniform>0</uniform>)";

/// The search space with another range of the amplitude.
SearchSpace space_with(const std::string& range) { return read_with(amplitude_range, range).space; }

TEST(Genome, MakesADimensionForEachJointOfAnIndividualParameterFromHeadToTail) {
  MemoryFiles files = small_experiment();
  const SearchSpace space = read(files).space;
  EXPECT_EQ(names(space), (std::vector<std::string>{"amplitude:J2", "amplitude:J1", "angle:J2"}));
  for (std::size_t d = 0; d < 2; ++d) {
    const Dimension& dimension = space.dimensions[d];
    ASSERT_EQ(dimension.targets.size(), 1U);
    EXPECT_EQ(dimension.targets[0].slot, 0);
    EXPECT_EQ(dimension.targets[0].joint, d);
    EXPECT_EQ(dimension.targets[0].number, 0);
    EXPECT_FALSE(dimension.targets[0].internal);
    EXPECT_EQ(dimension.unit, Unit::degree);
    EXPECT_EQ(dimension.values.size(), 61U);
    EXPECT_EQ(dimension.values.front(), degrees({"10"})[0]);
    EXPECT_EQ(dimension.values[1], degrees({"10.5"})[0]);
    EXPECT_EQ(dimension.values.back(), degrees({"40"})[0]);
  }
}

TEST(Genome, SortsASetOfValues) {
  MemoryFiles files = small_experiment();
  EXPECT_EQ(read(files).space.dimensions[2].values, degrees({"-5.5", "0", "12"}));
}

TEST(Genome, TakesAValueOfASetOnce) {
  EXPECT_EQ(read_with("0 -5.5 12", "3 0 3.0 0.0 30e-1").space.dimensions[2].values, degrees({"0", "3"}));
}

TEST(Genome, MakesOneDimensionOfAUniformParameter) {
  const SearchSpace space = read_with("<uniform>0</uniform>", "<uniform>1</uniform>").space;
  EXPECT_EQ(names(space), (std::vector<std::string>{"amplitude", "angle:J2"}));
  ASSERT_EQ(space.dimensions[0].targets.size(), 2U);
  EXPECT_EQ(space.dimensions[0].targets[0].joint, 0);
  EXPECT_EQ(space.dimensions[0].targets[1].joint, 1);
}

TEST(Genome, NamesTheJointOfAUniformParameterOfOneJoint) {
  MemoryFiles files = small_experiment();
  files.replace("top.optimise.xml",
                "allJoints=\"1\" genomeType=\"1\" valueType=\"1\" valueSpace=\"1\" activeJoints=\"11\"",
                "allJoints=\"0\" activeJoints=\"10\"");
  files.replace("top.optimise.xml", "<uniform>0</uniform>", "<uniform>1</uniform>");
  const SearchSpace space = read(files).space;
  EXPECT_EQ(names(space), (std::vector<std::string>{"amplitude:J1", "angle:J2"}));
  EXPECT_EQ(space.dimensions[0].targets[0].joint, 1) << "J1 is at the tail";
}

TEST(Genome, WithAllJointsMeansThoseThatTheModuleDrivesWhateverTheMask) {
  MemoryFiles files = small_experiment();
  files.replace("top.optimise.xml",
                "allJoints=\"0\" genomeType=\"1\" valueType=\"1\" valueSpace=\"0\" activeJoints=\"01\"",
                "allJoints=\"1\" valueSpace=\"0\" activeJoints=\"10\"");
  EXPECT_EQ(names(read(files).space), (std::vector<std::string>{"amplitude:J2", "amplitude:J1", "angle:J2"}));
}

TEST(Genome, CanDoWithoutWhatHasAnObviousValue) {
  MemoryFiles files = small_experiment();
  files.replace("top.optimise.xml",
                " allJoints=\"1\" genomeType=\"1\" valueType=\"1\" valueSpace=\"1\" activeJoints=\"11\"", "");
  files.replace("top.optimise.xml", "<lowerBoundTypes>1</lowerBoundTypes>", "");
  files.replace("top.optimise.xml", "<upperBoundTypes>1</upperBoundTypes>", "");
  files.replace("top.optimise.xml", "<numOfParametersToOptimize>2</numOfParametersToOptimize>", "");
  MemoryFiles whole = small_experiment();
  EXPECT_EQ(read(files).fingerprint(), read(whole).fingerprint());
}

TEST(Genome, LeavesOutExclusiveBounds) {
  EXPECT_EQ(space_with("<upperBounds>12</upperBounds><lowerBounds>10</lowerBounds><boundsIncrements>0.5"
                       "</boundsIncrements><lowerBoundTypes>2</lowerBoundTypes><upperBoundTypes>2</upperBoundTypes>"
                       "<uniform>1</uniform>")
                .dimensions[0]
                .values,
            degrees({"10.5", "11", "11.5"}));
}

TEST(Genome, NeedsOnlyTheValuesInTheDeclaredRangeNotAnExclusiveBound) {
  EXPECT_EQ(space_with("<upperBounds>91</upperBounds><lowerBounds>-1</lowerBounds><boundsIncrements>46"
                       "</boundsIncrements><lowerBoundTypes>2</lowerBoundTypes><upperBoundTypes>2</upperBoundTypes>"
                       "<uniform>1</uniform>")
                .dimensions[0]
                .values,
            degrees({"45"}));
}

TEST(Genome, TakesEverythingOfAJointFromThePlaceOfTheJointInTheRobotFile) {
  const SearchSpace space = space_with(
      "<upperBounds>12 30</upperBounds><lowerBounds>10 20</lowerBounds><boundsIncrements>1 5</boundsIncrements>"
      "<lowerBoundTypes>1 2</lowerBoundTypes><upperBoundTypes>2 1</upperBoundTypes><uniform>0</uniform>");
  EXPECT_EQ(space.dimensions[0].name, "amplitude:J2");
  EXPECT_EQ(space.dimensions[0].values, degrees({"25", "30"}));
  EXPECT_EQ(space.dimensions[1].name, "amplitude:J1");
  EXPECT_EQ(space.dimensions[1].values, degrees({"10", "11"}));
}

TEST(Genome, TakesOneNumberForAllJointsBesideOneForEach) {
  const SearchSpace space = space_with(
      "<upperBounds>12 11</upperBounds><lowerBounds>10</lowerBounds><boundsIncrements>1</boundsIncrements>"
      "<uniform>0</uniform>");
  EXPECT_EQ(space.dimensions[0].values, degrees({"10", "11"}));
  EXPECT_EQ(space.dimensions[1].values, degrees({"10", "11", "12"}));
}

/// Two modules of the same algorithm, and another that has a parameter of the same name on one of the joints.
MemoryFiles files_with_three_generators() {
  MemoryFiles files = small_experiment();
  files.texts["actuation.xml"] = R"(<actuation>
  <actuationModule name="PatternGenerator_sinusoidal"><jointConfiguration joints="10"/></actuationModule>
  <actuationModule name="PatternGenerator_sinusoidal"><jointConfiguration joints="01"/></actuationModule>
  <actuationModule name="PatternGenerator_coupled_oscillator"><jointConfiguration joints="11"/></actuationModule>
</actuation>)";
  return files;
}

std::string three_generators_with(const std::string& first, const std::string& second, const std::string& config) {
  return "<greatDeluge><simulation>top.xml</simulation><properties><registeredParameters>"
         "<parameter number=\"0\" " +
         first + "/><parameter number=\"1\" " + second + "/></registeredParameters></properties><genome>" +
         "<genomeConfig number=\"1\" valueSpace=\"0\"><values>1 2</values>" + config +
         "</genomeConfig><genomeConfig number=\"0\" valueSpace=\"0\"><values>1 2</values>" + config +
         "</genomeConfig></genome></greatDeluge>";
}

TEST(Genome, PutsTheModulesNumberInFrontOfANameThatAnotherModuleOfTheJointHasToo) {
  MemoryFiles files = files_with_three_generators();
  files.texts["top.optimise.xml"] =
      three_generators_with("controlAlgorithm=\"3\" parameter=\"amplitude\"",
                            "controlAlgorithm=\"1\" parameter=\"amplitude\"", "<uniform>0</uniform>");
  EXPECT_EQ(names(read(files).space), (std::vector<std::string>{"3.amplitude:J2", "3.amplitude:J1", "1.amplitude:J1"}));
}

TEST(Genome, GivesNoNumberToANameThatIsClear) {
  MemoryFiles files = files_with_three_generators();
  files.texts["top.optimise.xml"] =
      three_generators_with("controlAlgorithm=\"PatternGenerator_coupled_oscillator\" parameter=\"coupling\"",
                            "controlAlgorithm=\"2\" parameter=\"phase\"", "<uniform>1</uniform>");
  EXPECT_EQ(names(read(files).space), (std::vector<std::string>{"coupling", "phase:J2"}));
}

TEST(Genome, NamesAreWordsOfTheSetOption) {
  MemoryFiles files = files_with_three_generators();
  files.texts["top.optimise.xml"] =
      three_generators_with("controlAlgorithm=\"3\" parameter=\"frequency\"",
                            "controlAlgorithm=\"2\" parameter=\"amplitude\"", "<uniform>1</uniform>");
  const Experiment experiment = read(files);
  for (std::size_t d = 0; d < 2; ++d) {
    sim::Scenario by_word = experiment.scenario;
    sim::apply_setting(by_word, experiment.space.dimensions[d].name + "=2");
    SearchSpace only{{experiment.space.dimensions[d]}};
    sim::Scenario by_candidate = experiment.scenario;
    only.apply({1}, by_candidate);
    ASSERT_EQ(by_word.settings.size(), by_candidate.settings.size());
    for (std::size_t i = 0; i < by_word.settings.size(); ++i) {
      const Setting& left = by_word.settings[i];
      const Setting& right = by_candidate.settings[i];
      EXPECT_EQ(std::tuple(left.slot, left.joint, left.number, left.value),
                std::tuple(right.slot, right.joint, right.number, right.value));
    }
  }
}

TEST(Genome, NamesOfSomeJointsAreInTheOrderOfTheRobotFile) {
  FilesOverDisk files;
  files.texts["x"] = R"(<cmaEs><properties><registeredParameters>
    <parameter number="0" controlAlgorithm="1" parameter="amplitude"/></registeredParameters></properties>
    <genome><genomeConfig number="0" allJoints="0" activeJoints="10101" valueSpace="0"><values>1</values>
    <uniform>1</uniform></genomeConfig></genome></cmaEs>)";
  const Experiment experiment = read_experiment("x", files, travelling_wave + "uniform.simulation.xml");
  ASSERT_EQ(experiment.space.dimensions.size(), 1U);
  EXPECT_EQ(experiment.space.dimensions[0].name, "amplitude:J1,J3,J5");
  ASSERT_EQ(experiment.space.dimensions[0].targets.size(), 3U);
  EXPECT_EQ(experiment.space.dimensions[0].targets[1].joint, 2);
}

}  // namespace
}  // namespace proleg::optimize
