// Each case breaks the small experiment in one place and gives the one line that the message must be.

#include <gtest/gtest.h>

#include <ostream>

#include "experiment_files.hpp"

namespace proleg::optimize {
namespace {

struct BadExperiment {
  std::string name;
  std::string old_text;
  std::string new_text;
  std::string message;  ///< without the file's name
};

void PrintTo(const BadExperiment& bad, std::ostream* stream) { *stream << bad.name; }

class BadExperimentFile : public testing::TestWithParam<BadExperiment> {};

TEST_P(BadExperimentFile, IsNamedWithLineFoundAndExpected) {
  const BadExperiment& bad = GetParam();
  MemoryFiles files = small_experiment();
  ASSERT_EQ(message_of(files), "no error");
  files.replace("top.optimise.xml", bad.old_text, bad.new_text);
  EXPECT_EQ(message_of(files), "top.optimise.xml:" + bad.message);
}

const std::string sinusoidal = "controlAlgorithm=\"PatternGenerator_sinusoidal\"";
const std::string first_parameter = "<parameter number=\"0\" " + sinusoidal + " parameter=\"amplitude\"/>";
const std::string first_config_types =
    "allJoints=\"1\" genomeType=\"1\" valueType=\"1\" valueSpace=\"1\" activeJoints=\"11\"";
const std::string second_config =
    "allJoints=\"0\" genomeType=\"1\" valueType=\"1\" valueSpace=\"0\" activeJoints=\"01\"";
const std::string trials = "<trials count=\"2\" aggregate=\"mean\">";
const std::string objective = "<objective measure=\"distance\"/>";
const std::string all_measures =
    "distance, speed, sideways_speed, heading, yaw_rate, mechanical_energy, electrical_energy, cost_of_transport, "
    "electrical_cost_of_transport, "
    "specific_resistance, smoothness, stability_margin, height, slip, duty_factor, froude_number, stride_length, "
    "stride_frequency, tracking_error, max_tracking_error, at_speed_limit, at_torque_limit, largest_acceleration, "
    "mean_current, potential_energy, kinetic_energy, elastic_energy, wave_count, predicted_distance, lifted_links";
const std::string racing_expects =
    "expected one objective, which is distance or speed with a weight above 0, to be maximised";

const auto top_level = testing::Values(
    BadExperiment{"UnknownTag", "<properties>", "<settings/><properties>",
                  "3: found <settings> in <greatDeluge>, expected <simulation>, <properties>, <genome>, <fitness>, "
                  "<evaluation>"},
    BadExperiment{"AlgorithmOutsidePagmo", "<greatDeluge>", "<greatDeluge algorithm=\"sade\">",
                  "1: found attribute 'algorithm' in <greatDeluge>, expected no attributes"},
    BadExperiment{"NoSimulation", "<simulation>top.xml</simulation>", "",
                  "1: found no <simulation> in <greatDeluge>, expected the scenario, named there or with --simulation"},
    BadExperiment{"MissingSimulation", "<simulation>top.xml", "<simulation>other.xml",
                  "2: found no such file 'other.xml', expected a readable file of at most 16 MiB, relative to the "
                  "folder of this file or of the top-level file"});

const auto registrations = testing::Values(
    BadExperiment{"UnknownModule", "DirectJointAccess", "Global Adaptive Touch",
                  "8: found unknown module 'Global Adaptive Touch', expected one of PatternGenerator_sinusoidal (1), "
                  "DirectJointAccess (2)"},
    BadExperiment{
        "EmptySlot", "controlAlgorithm=\"DirectJointAccess\"", "controlAlgorithm=\"3\"",
        "8: found unknown module '3', expected one of PatternGenerator_sinusoidal (1), DirectJointAccess (2)"},
    BadExperiment{"UnknownParameter", "parameter=\"angle\"", "parameter=\"Angle\"",
                  "8: found unknown parameter 'Angle' of DirectJointAccess, expected one of angle"},
    BadExperiment{"NoNumber", "number=\"1\" controlAlgorithm", "controlAlgorithm",
                  "8: found no attribute 'number' in <parameter>, expected one"},
    BadExperiment{"NumberTooLarge", "number=\"1\" controlAlgorithm", "number=\"1000\" controlAlgorithm",
                  "8: found number '1000' in <parameter>, expected a whole number from 0 to 999"},
    BadExperiment{"NumberTwice", "number=\"1\" controlAlgorithm", "number=\"0\" controlAlgorithm",
                  "8: found a second parameter with number 0, expected another number; the first is in line 7"},
    BadExperiment{"NumberMissing", "number=\"1\" controlAlgorithm", "number=\"2\" controlAlgorithm",
                  "6: found no parameter with number 1, expected numbers from 0 to 1"},
    BadExperiment{"NothingRegistered",
                  first_parameter + "\n      <parameter number=\"1\" controlAlgorithm=\"DirectJointAccess\" "
                                    "parameter=\"angle\"/>",
                  "", "6: found no <parameter> in <registeredParameters>, expected at least one"},
    BadExperiment{"OtherCount", "<numOfParametersToOptimize>2", "<numOfParametersToOptimize>3",
                  "5: found '3' in <numOfParametersToOptimize>, expected 2, as many as are registered"},
    BadExperiment{"ConfigOfNothing", "<genomeConfig number=\"1\"", "<genomeConfig number=\"2\"",
                  "20: found number 2 in <genomeConfig>, expected that of a registered parameter, 0 to 1"},
    BadExperiment{"ConfigTwice", "<genomeConfig number=\"1\"", "<genomeConfig number=\"0\"",
                  "20: found a second <genomeConfig> with number 0, expected another number; the first is in line 12"},
    BadExperiment{"ConfigMissing",
                  "<genomeConfig number=\"1\" " + second_config +
                      ">\n      <values>0 -5.5 12</values>\n      <uniform>1</uniform>\n    </genomeConfig>",
                  "", "8: found no <genomeConfig> with number 1, expected one"},
    BadExperiment{"RegisteredTwice", "controlAlgorithm=\"DirectJointAccess\" parameter=\"angle\"",
                  "controlAlgorithm=\"1\" parameter=\"amplitude\"",
                  "20: found parameter 'amplitude' of joint 'J2' a second time, expected it once; the first is in line "
                  "12"});

const auto configs = testing::Values(
    BadExperiment{"MaskTooShort", "activeJoints=\"11\"", "activeJoints=\"1\"",
                  "12: found activeJoints '1', expected 2 characters 0 or 1, one for each joint in the order of the "
                  "robot file"},
    BadExperiment{"MaskOfOtherCharacters", "activeJoints=\"01\"", "activeJoints=\"0x\"",
                  "20: found activeJoints '0x', expected 2 characters 0 or 1, one for each joint in the order of the "
                  "robot file"},
    BadExperiment{"MaskNeeded", " activeJoints=\"01\"", "",
                  "20: found no attribute 'activeJoints' in <genomeConfig>, expected one"},
    BadExperiment{"NoJoint", "activeJoints=\"01\"", "activeJoints=\"00\"",
                  "20: found no joint marked in activeJoints '00', expected at least one 1, or allJoints=\"1\""},
    BadExperiment{"JointNotDriven", "activeJoints=\"01\"", "activeJoints=\"11\"",
                  "20: found joint 'J1' in activeJoints, which DirectJointAccess (2) does not drive, expected some of "
                  "J2"},
    BadExperiment{"AllJoints", "allJoints=\"0\"", "allJoints=\"2\"",
                  "20: found allJoints '2' in <genomeConfig>, expected a whole number from 0 to 1"},
    BadExperiment{"GenomeType", first_config_types, "genomeType=\"2\"",
                  "12: found genomeType '2' in <genomeConfig>, expected '1', the only known value"},
    BadExperiment{"ValueType", first_config_types, "valueType=\"0\"",
                  "12: found valueType '0' in <genomeConfig>, expected '1', the only known value"},
    BadExperiment{"ValueSpace", first_config_types, "valueSpace=\"2\"",
                  "12: found valueSpace '2' in <genomeConfig>, expected a whole number from 0 to 1"},
    BadExperiment{"NoUniform", "<uniform>0</uniform>", "", "12: found no <uniform> in <genomeConfig>, expected one"},
    BadExperiment{"UniformOfJoints", "<uniform>0", "<uniform>2",
                  "18: found '2' in <uniform>, expected a whole number from 0 to 1"},
    BadExperiment{"ListInARange", "<uniform>0</uniform>", "<uniform>0</uniform><values>1</values>",
                  "18: found <values> with valueSpace '1', expected <lowerBounds>, <upperBounds> and "
                  "<boundsIncrements>"},
    BadExperiment{"BoundsOfAList", "<values>0 -5.5 12</values>", "<lowerBounds>1</lowerBounds>",
                  "21: found <lowerBounds> with valueSpace '0', expected <values>"},
    BadExperiment{"EmptyList", "<values>0 -5.5 12", "<values> ",
                  "21: found an empty set of values in <values>, expected at least one number"},
    BadExperiment{"ListOfWords", "<values>0 -5.5 12", "<values>0 five",
                  "21: found 'five' in <values>, expected a decimal number below 10^10 with at most 15 places"},
    BadExperiment{"ListOutOfRange", "<values>0 -5.5 12", "<values>0 90.1",
                  "21: found '90.1' for parameter 'angle', expected a number from -90 to 90 deg"},
    BadExperiment{
        "CrossedBounds", "<upperBounds>40", "<upperBounds>9.5",
        "13: found crossed bounds: 9.5 in <upperBounds>, 10 in <lowerBounds>, expected an upper bound that is "
        "not below the lower one"},
    BadExperiment{"UpperOutOfRange", "<upperBounds>40", "<upperBounds>90.5",
                  "13: found '90.5' for parameter 'amplitude', expected a number from 0 to 90 deg"},
    BadExperiment{"LowerOutOfRange", "<lowerBounds>10", "<lowerBounds>-0.5",
                  "14: found '-0.5' for parameter 'amplitude', expected a number from 0 to 90 deg"},
    BadExperiment{"StepZero", "<boundsIncrements>0.5", "<boundsIncrements>0",
                  "15: found a step of 0 in <boundsIncrements>, expected a step above 0"},
    BadExperiment{"StepNegative", "<boundsIncrements>0.5", "<boundsIncrements>-0.5",
                  "15: found a step of -0.5 in <boundsIncrements>, expected a step above 0"},
    BadExperiment{"StepThatDoesNotFit", "<boundsIncrements>0.5", "<boundsIncrements>0.7",
                  "15: found a step of 0.7 that does not fit from 10 to 40, expected a step that fits, or an upper "
                  "bound of 39.4 or 40.1"},
    BadExperiment{"TooManyValues", "<boundsIncrements>0.5", "<boundsIncrements>0.00003",
                  "15: found more than 1000000 values from 10 to 40 in steps of 0.00003, expected at most 1000000"},
    BadExperiment{"NotANumber", "<lowerBounds>10", "<lowerBounds>nan",
                  "14: found 'nan' in <lowerBounds>, expected a decimal number below 10^10 with at most 15 places"},
    BadExperiment{"NoBound", "<lowerBoundTypes>1", "<lowerBoundTypes>0",
                  "16: found '0' in <lowerBoundTypes>, expected a bound (0 is none): 1 (inclusive) or 2 "
                  "(exclusive)"},
    BadExperiment{"UnknownBound", "<upperBoundTypes>1", "<upperBoundTypes>3",
                  "17: found '3' in <upperBoundTypes>, expected 1 (inclusive) or 2 (exclusive)"},
    BadExperiment{"NothingBetweenExclusiveBounds",
                  "<upperBounds>40</upperBounds>\n      <lowerBounds>10</lowerBounds>\n      "
                  "<boundsIncrements>0.5</boundsIncrements>\n      <lowerBoundTypes>1</lowerBoundTypes>\n      "
                  "<upperBoundTypes>1</upperBoundTypes>",
                  "<upperBounds>10.5</upperBounds><lowerBounds>10</lowerBounds><boundsIncrements>0.5</boundsIncrements>"
                  "<lowerBoundTypes>2</lowerBoundTypes><upperBoundTypes>2</upperBoundTypes>",
                  "13: found no value between the exclusive bounds, expected at least one"},
    BadExperiment{"BoundsOfTooManyJoints", "<upperBounds>40", "<upperBounds>40 40 40",
                  "13: found 3 numbers in <upperBounds>, expected one number, or 2, one for each joint"},
    BadExperiment{"BoundsOfJointsForAUniformParameter",
                  "<upperBounds>40</upperBounds>\n      <lowerBounds>10</lowerBounds>\n      "
                  "<boundsIncrements>0.5</boundsIncrements>\n      <lowerBoundTypes>1</lowerBoundTypes>\n      "
                  "<upperBoundTypes>1</upperBoundTypes>\n      <uniform>0",
                  "<upperBounds>40 40</upperBounds><lowerBounds>10</lowerBounds><boundsIncrements>0.5"
                  "</boundsIncrements><uniform>1",
                  "13: found 2 numbers in <upperBounds>, expected one number"},
    BadExperiment{"EmptyBound", "<upperBounds>40", "<upperBounds>",
                  "13: found 0 numbers in <upperBounds>, expected one number, or 2, one for each joint"},
    BadExperiment{"NoStep", "<boundsIncrements>0.5</boundsIncrements>", "",
                  "12: found no <boundsIncrements> in <genomeConfig>, expected one"});

const auto method_settings = testing::Values(
    BadExperiment{"SettingOfAnotherMethod", "<waterLevel>0.1</waterLevel>", "<popsize>30</popsize>",
                  "4: found <popsize> in <properties>, expected <waterLevel>, <rain>, <credits>, <retries>, "
                  "<confidence>, <step>, <growth>, <move>, <neighbour>, <start>, <firstMustPass>, <reevaluations>, "
                  "<chains>, <target>, <numOfParametersToOptimize>, <registeredParameters>"},
    BadExperiment{"RainZero", "<waterLevel>0.1</waterLevel>", "<rain>0</rain>",
                  "4: found '0' in <rain>, expected a number from 1e-09 to 1e+09"},
    BadExperiment{"WaterLevelNotANumber", "<waterLevel>0.1", "<waterLevel>high",
                  "4: found 'high' in <waterLevel>, expected a number from -1e+09 to 1e+09"},
    BadExperiment{"CreditsTooMany", "<waterLevel>0.1</waterLevel>", "<credits>1000001</credits>",
                  "4: found '1000001' in <credits>, expected a whole number from 0 to 1000000"},
    BadExperiment{"RetriesZero", "<waterLevel>0.1</waterLevel>", "<retries>0</retries>",
                  "4: found '0' in <retries>, expected a whole number from 1 to 1000000"},
    BadExperiment{"ConfidenceZero", "<waterLevel>0.1</waterLevel>", "<confidence>0</confidence>",
                  "4: found '0' in <confidence>, expected a whole number from 1 to 1000000"},
    BadExperiment{"StepOfTheDelugeZero", "<waterLevel>0.1</waterLevel>", "<step>0</step>",
                  "4: found '0' in <step>, expected a whole number from 1 to 1000000"},
    BadExperiment{"Growth", "<waterLevel>0.1</waterLevel>", "<growth>fast</growth>",
                  "4: found 'fast' in <growth>, expected 'linear' or 'doubling'"},
    BadExperiment{"Move", "<waterLevel>0.1</waterLevel>", "<move>some</move>",
                  "4: found 'some' in <move>, expected 'all' or 'one'"},
    BadExperiment{"Neighbour", "<waterLevel>0.1</waterLevel>", "<neighbour>near</neighbour>",
                  "4: found 'near' in <neighbour>, expected 'three', 'sign' or 'uniform'"},
    BadExperiment{"Start", "<waterLevel>0.1</waterLevel>", "<start>best</start>",
                  "4: found 'best' in <start>, expected 'random' or 'scenario'"},
    BadExperiment{"ChainsZero", "<waterLevel>0.1</waterLevel>", "<chains>0</chains>",
                  "4: found '0' in <chains>, expected a whole number from 1 to 64"},
    BadExperiment{"Reevaluations", "<waterLevel>0.1</waterLevel>", "<reevaluations>101</reevaluations>",
                  "4: found '101' in <reevaluations>, expected a whole number from 0 to 100"});

const auto fitness = testing::Values(
    BadExperiment{"Heading", "heading=\"0\"", "heading=\"361\"",
                  "25: found heading '361' in <fitness>, expected a number from -360 to 360 degrees"},
    BadExperiment{"NoObjective", objective, "", "25: found no <objective> in <fitness>, expected at least one"},
    BadExperiment{"EmptyObjective", objective, "<objective/>",
                  "26: found no <term> in <objective>, expected at least one, or an attribute 'measure'"},
    BadExperiment{"UnknownMeasure", objective, "<objective measure=\"beauty\"/>",
                  "26: found unknown measure 'beauty', expected one of " + all_measures},
    BadExperiment{"UnknownMeasureInATerm", objective, "<objective><term measure=\"Distance\"/></objective>",
                  "26: found unknown measure 'Distance', expected one of " + all_measures},
    BadExperiment{"MeasureAndTerms", objective, "<objective measure=\"speed\"><term measure=\"slip\"/></objective>",
                  "26: found attribute 'measure' and <term>s in <objective>, expected one or the other"},
    BadExperiment{"MeasureTwice", objective,
                  "<objective><term measure=\"slip\"/>\n<term measure=\"slip\"/></objective>",
                  "27: found a second term with measure 'slip', expected one"},
    BadExperiment{"WeightZero", objective, "<objective><term measure=\"slip\" weight=\"0\"/></objective>",
                  "26: found weight 0 in <term>, expected a weight other than 0, or no such term"},
    BadExperiment{"WeightInfinite", objective, "<objective><term measure=\"slip\" weight=\"inf\"/></objective>",
                  "26: found weight 'inf' in <term>, expected a number from -1e+09 to 1e+09"},
    BadExperiment{"Goal", objective, "<objective measure=\"speed\" goal=\"most\"/>",
                  "26: found goal 'most' in <objective>, expected 'maximise' or 'minimise'"},
    BadExperiment{"Failed", objective, "<objective measure=\"speed\" failed=\"none\"/>",
                  "26: found failed 'none' in <objective>, expected a number from -1e+12 to 1e+12"},
    BadExperiment{"FailedIsMissingForASignedMeasure", objective, "<objective measure=\"speed\"/>",
                  "26: found a score that may be negative (speed) without 'failed' in <objective>, expected "
                  "failed=\"...\", the score of a run that fails, worse than that of every other run"},
    BadExperiment{"FailedIsMissingForANegativeWeight", objective,
                  "<objective goal=\"maximise\"><term measure=\"distance\" weight=\"-1\"/></objective>",
                  "26: found a score that may be negative (distance) without 'failed' in <objective>, expected "
                  "failed=\"...\", the score of a run that fails, worse than that of every other run"},
    BadExperiment{"FailedIsMissingForASum", objective,
                  "<objective><term measure=\"distance\"/><term measure=\"mechanical_energy\" "
                  "weight=\"-0.1\"/></objective>",
                  "26: found a sum of measures without 'failed' in <objective>, expected failed=\"...\", the score of "
                  "a run that fails, worse than that of every other run"},
    BadExperiment{"EmptyName", objective, "<objective measure=\"speed\" name=\"\"/>",
                  "26: found an empty name in <objective>, expected a name of 1 to 64 characters"},
    BadExperiment{"SameName", objective, objective + objective,
                  "26: found a second objective 'distance', expected another name"});

const auto evaluation = testing::Values(
    BadExperiment{"Evaluations", "<evaluations>100", "<evaluations>many",
                  "29: found 'many' in <evaluations>, expected a whole number from 0 to 1000000000"},
    BadExperiment{"Seed", "<seed>5", "<seed>-5",
                  "30: found '-5' in <seed>, expected a whole number from 0 to 18446744073709551615"},
    BadExperiment{"Reuse", "<reuse>1", "<reuse>yes", "31: found 'yes' in <reuse>, expected a whole number from 0 to 1"},
    BadExperiment{"NoTrial", trials, "<trials count=\"0\">",
                  "32: found count '0' in <trials>, expected a whole number from 1 to 1000"},
    BadExperiment{
        "TrialsThatAreAllEqual", "<friction>0.1</friction>\n      <latency unit=\"ms\">20</latency>", "",
        "32: found 2 trials that are all equal, expected a spread of <friction>, <mass>, <servoGain>, <latency> "
        "or <contactNoise>, or noise in the scenario"},
    BadExperiment{"Aggregate", "aggregate=\"mean\"", "aggregate=\"best\"",
                  "32: found aggregate 'best' in <trials>, expected 'mean' or 'worst'"},
    BadExperiment{"UnknownSpread", "<friction>0.1</friction>", "<gravity>0.1</gravity>",
                  "33: found <gravity> in <trials>, expected <friction>, <mass>, <servoGain>, <latency>, "
                  "<contactNoise>"},
    BadExperiment{"SpreadTooWide", "<friction>0.1", "<friction>1",
                  "33: found '1' in <friction>, expected a number from 0 to 0.9"},
    BadExperiment{"LatencyTooLong", "<latency unit=\"ms\">20", "<latency unit=\"ms\">101",
                  "34: found '101' in <latency>, expected a number from 0 to 100 ms"},
    BadExperiment{"LatencyInSeconds", "unit=\"ms\"", "unit=\"s\"",
                  "34: found unit 's' in <latency>, expected unit 'ms'"},
    BadExperiment{"ContactNoise", "<friction>0.1</friction>", "<contactNoise>2</contactNoise>",
                  "33: found '2' in <contactNoise>, expected a number from 0 to 1"},
    BadExperiment{"RacingAtTheEnd", "after=\"0.3\"", "after=\"1\"",
                  "36: found after '1' in <racing>, expected a number from 0 to 0.99"},
    BadExperiment{"RacingWithoutTime", "after=\"0.3\"", "", "36: found no attribute 'after' in <racing>, expected one"},
    BadExperiment{"RacingKeepsTooMuch", "keep=\"0.5\"", "keep=\"1.5\"",
                  "36: found keep '1.5' in <racing>, expected a number from 0 to 1"},
    BadExperiment{"RacingOfAnotherMeasure", objective, "<objective measure=\"slip\"/>",
                  "36: found <racing> with this fitness, " + racing_expects},
    BadExperiment{
        "RacingOfASum", objective,
        "<objective failed=\"-9\"><term measure=\"speed\"/><term measure=\"slip\" weight=\"-1\"/></objective>",
        "36: found <racing> with this fitness, " + racing_expects},
    BadExperiment{"RacingOfObjectives", objective, objective + "<objective measure=\"speed\" failed=\"-1\"/>",
                  "36: found <racing> with this fitness, " + racing_expects},
    BadExperiment{"RacingToTheLeast", objective, "<objective measure=\"distance\" goal=\"minimise\"/>",
                  "36: found <racing> with this fitness, " + racing_expects},
    BadExperiment{"RacingOfANegativeDistance", objective,
                  "<objective goal=\"maximise\" failed=\"-9\"><term measure=\"distance\" weight=\"-1\"/></objective>",
                  "36: found <racing> with this fitness, " + racing_expects});

std::string name_of_case(const testing::TestParamInfo<BadExperiment>& info) { return info.param.name; }

INSTANTIATE_TEST_SUITE_P(TopLevel, BadExperimentFile, top_level, name_of_case);
INSTANTIATE_TEST_SUITE_P(Registrations, BadExperimentFile, registrations, name_of_case);
INSTANTIATE_TEST_SUITE_P(Configs, BadExperimentFile, configs, name_of_case);
INSTANTIATE_TEST_SUITE_P(Method, BadExperimentFile, method_settings, name_of_case);
INSTANTIATE_TEST_SUITE_P(Fitness, BadExperimentFile, fitness, name_of_case);
INSTANTIATE_TEST_SUITE_P(Evaluation, BadExperimentFile, evaluation, name_of_case);

TEST(BadExperiments, AWrongOutermostTagIsRejectedWithTheKnownOnes) {
  MemoryFiles files = small_experiment();
  files.texts["top.optimise.xml"] = "<hillClimbing/>";
  EXPECT_EQ(message_of(files),
            "top.optimise.xml:1: found <hillClimbing> as the outermost tag, expected <geneticAlgorithm>, "
            "<greatDeluge>, <cmaEs>, <differentialEvolution>, <nsga2>, <pagmo>, <mapElites>");
}

TEST(BadExperiments, AMissingFileIsNamed) {
  MemoryFiles files;
  EXPECT_EQ(message_of(files),
            "top.optimise.xml: found no file that can be read, expected a readable file of at most 16 MiB");
}

TEST(BadExperiments, PropertiesAndGenomeAreNeeded) {
  MemoryFiles files = small_experiment();
  std::string& text = files.texts["top.optimise.xml"];
  const std::size_t genome = text.find("<genome>");
  text.erase(genome, text.find("</genome>") + 9 - genome);
  EXPECT_EQ(message_of(files), "top.optimise.xml:1: found no <genome> in <greatDeluge>, expected one");
  text = "<cmaEs><simulation>top.xml</simulation></cmaEs>";
  EXPECT_EQ(message_of(files), "top.optimise.xml:1: found no <properties> in <cmaEs>, expected one");
  text = "<cmaEs><simulation>top.xml</simulation><properties/><genome/></cmaEs>";
  EXPECT_EQ(message_of(files), "top.optimise.xml:1: found no <registeredParameters> in <properties>, expected one");
}

TEST(BadExperiments, AMistakeInTheScenarioIsNamedThere) {
  MemoryFiles files = small_experiment();
  files.replace("top.xml", "<duration>2", "<duration>0");
  EXPECT_EQ(message_of(files), "top.xml:6: found '0' in <duration>, expected a number from 0.01 to 86400 s");
}

TEST(BadExperiments, AModuleThatDrivesNoJointHasNothingToChoose) {
  MemoryFiles files = small_experiment();
  files.replace("actuation.xml", "joints=\"01\"", "joints=\"00\"");
  EXPECT_EQ(message_of(files),
            "top.optimise.xml:8: found module 'DirectJointAccess', which drives no joint, expected one that does");
}

TEST(BadExperiments, TheNameOfTwoModulesIsRefusedWithTheirNumbers) {
  MemoryFiles files = small_experiment();
  files.replace("actuation.xml", "</actuation>",
                "<actuationModule name=\"DirectJointAccess\"><jointConfiguration joints=\"10\"/></actuationModule>"
                "</actuation>");
  EXPECT_EQ(message_of(files),
            "top.optimise.xml:8: found several modules 'DirectJointAccess', expected the number of one of "
            "PatternGenerator_sinusoidal (1), DirectJointAccess (2), DirectJointAccess (3)");
  files.replace("top.optimise.xml", "controlAlgorithm=\"DirectJointAccess\"", "controlAlgorithm=\"2\"");
  EXPECT_EQ(message_of(files), "no error");
}

TEST(BadExperiments, MoreObjectivesThanEightAreRefused) {
  MemoryFiles files = small_experiment();
  std::string nine;
  for (int i = 0; i < 9; ++i) {
    nine += "<objective measure=\"distance\" name=\"" + std::to_string(i) + "\"/>";
  }
  files.replace("top.optimise.xml", objective, nine);
  EXPECT_EQ(message_of(files), "top.optimise.xml:26: found more than 8 objectives, expected at most 8");
}

TEST(BadExperiments, MoreValuesThanTenMillionInAllAreRefused) {
  MemoryFiles files = small_experiment();
  std::string parameters;
  std::string genome;
  // All parameters of all slots, each with nearly a million values.
  const std::vector<std::string> names{"amplitude", "offset", "phase", "phase_difference", "frequency"};
  files.replace("actuation.xml", "joints=\"01\"", "joints=\"11\"");
  int number = 0;
  for (const std::string& name : names) {
    parameters +=
        "<parameter number=\"" + std::to_string(number) + "\" controlAlgorithm=\"1\" parameter=\"" + name + "\"/>";
    genome += "<genomeConfig number=\"" + std::to_string(number) +
              "\"><lowerBounds>0</lowerBounds><upperBounds>9.99999</upperBounds><boundsIncrements>0.00001"
              "</boundsIncrements><uniform>0</uniform></genomeConfig>";
    ++number;
  }
  parameters += "<parameter number=\"5\" controlAlgorithm=\"2\" parameter=\"angle\"/>";
  genome += "<genomeConfig number=\"5\" valueSpace=\"0\"><values>1</values><uniform>0</uniform></genomeConfig>";
  files.texts["top.optimise.xml"] = "<cmaEs><simulation>top.xml</simulation><properties><registeredParameters>" +
                                    parameters + "</registeredParameters></properties>\n<genome>" + genome +
                                    "</genome></cmaEs>";
  EXPECT_EQ(message_of(files),
            "top.optimise.xml:2: found more than 1000 dimensions or 10000000 values in all, expected at "
            "most that");
}

TEST(BadExperiments, EveryTruncationIsRefused) {
  const MemoryFiles whole = small_experiment();
  const std::string& text = whole.texts.at("top.optimise.xml");
  for (std::size_t size = 0; size < text.rfind("</") + 2; size += 3) {
    MemoryFiles files = small_experiment();
    files.texts["top.optimise.xml"].resize(size);
    EXPECT_NE(message_of(files), "no error") << "cut to " << size << " bytes";
  }
}

}  // namespace
}  // namespace proleg::optimize
