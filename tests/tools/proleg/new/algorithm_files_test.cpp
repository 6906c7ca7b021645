#include "tools/proleg/new/algorithm_files.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace proleg::tools {
namespace {

const std::string source_tree = "/home/me/proleg";

std::string file_of(const AlgorithmForm& form, const std::string& name) {
  const std::vector<sim::SourceFile> files = algorithm_files(form, source_tree);
  const auto file = std::ranges::find(files, name, &sim::SourceFile::path);
  return file == files.end() ? "no file " + name : file->text.str();
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(AlgorithmFiles, TheExampleHasTheSharedParametersAndItsEquation) {
  const std::string source = file_of(example_form("my_wave", 100), "my_wave.cpp");
  EXPECT_TRUE(has(source, "enum Parameters : std::uint8_t { amplitude, frequency, phase_difference, steepness };"));
  EXPECT_TRUE(has(source, "    generator_parameters::amplitude,\n"));
  EXPECT_TRUE(
      has(source, "    Parameter{\"steepness\", Unit::ratio, raw(Unit::ratio, 1, 4), 0, raw(Unit::ratio, 1),\n"));
  EXPECT_TRUE(
      has(source, "    100, \"my_wave\", \"a sine with a second harmonic\", parameters, internal_values, frame,"));
  EXPECT_TRUE(has(file_of(example_form("my_wave", 100), "robot/robot.actuation.xml"), "value=\"35\" unit=\"deg\""));
}

TEST(AlgorithmFiles, TheDeclarationIsThatOfTheForm) {
  AlgorithmForm form = example_form("my_wave", 101);
  form.parameters[0].maximum = "60";
  form.parameters[3] = {"delay", Unit::count, "0", "3", "250", "ticks until it begins"};
  form.values = {{"waited", Unit::count, "ticks that have passed"}, {"touch_time", Unit::per_second, "since a touch"}};
  form.senses_touch = true;
  const std::string source = file_of(form, "my_wave.cpp");
  EXPECT_TRUE(has(source, "enum Parameters : std::uint8_t { amplitude, frequency, phase_difference, delay };"));
  EXPECT_TRUE(has(source, "Parameter{\"amplitude\", Unit::degree, raw(Unit::degree, 40), 0, raw(Unit::degree, 60),"));
  EXPECT_TRUE(has(source, "Parameter{\"delay\", Unit::count, 3, 0, 250,\n              \"ticks until it begins\"},"));
  EXPECT_TRUE(has(source, "InternalValue{\"waited\", Unit::count, 0, \"ticks that have passed\"},"));
  EXPECT_TRUE(has(source, "enum OwnValues : std::uint8_t { waited = first_own_value, touch_time };"));
  EXPECT_TRUE(has(source, "bool senses_contacts() const override { return true; }"));
  EXPECT_FALSE(has(source, "steepness")) << "nothing of the example that the form does not have";
  EXPECT_TRUE(has(file_of(form, "robot/robot.actuation.xml"), "<parameter name=\"delay\" value=\"3\"/>"));
  EXPECT_TRUE(has(file_of(form, "my_wave_test.cpp"), "two robots of five joints move alike"));
}

TEST(AlgorithmFiles, WithoutTheParametersOfAWaveTheJointsStay) {
  AlgorithmForm form = example_form("bend", 102);
  form.parameters = {{"angle", Unit::degree, "-90", "12.5", "90", "angle of all joints"}};
  const std::string source = file_of(form, "bend.cpp");
  EXPECT_TRUE(has(source, "class Algorithm final : public ActuationModule {"));
  EXPECT_TRUE(has(source, "raw(Unit::degree, 25, 2), -quarter_turn, quarter_turn,"));
  EXPECT_TRUE(has(source, "parameters, {}, {}, PROLEG_ALGORITHM_SOURCES};"));
  EXPECT_FALSE(has(source, "PatternGenerator"));
}

TEST(AlgorithmFiles, NothingOfTheTemplatesIsLeft) {
  for (const bool is_touching : {false, true}) {
    for (const std::size_t parameters : {1U, 3U, 4U}) {
      AlgorithmForm form = example_form("my_wave", 103);
      form.parameters.resize(parameters);
      form.senses_touch = is_touching;
      for (const sim::SourceFile& file : algorithm_files(form, source_tree)) {
        EXPECT_EQ(file.text.str().find('@'), std::string::npos) << file.path << ":\n" << file.text.str();
      }
    }
  }
}

}  // namespace
}  // namespace proleg::tools
