#include "tools/proleg/new/algorithm_form.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "shared/computer/errors/input_error.hpp"

namespace proleg::tools {
namespace {

std::string refusal(const std::function<void(AlgorithmForm&)>& change) {
  AlgorithmForm form = example_form("my_wave", 100);
  change(form);
  try {
    check_form(form);
    return "accepted";
  } catch (const InputError& error) {
    return error.what();
  }
}

TEST(AlgorithmForm, TheExampleIsAccepted) {
  EXPECT_EQ(refusal([](AlgorithmForm&) {}), "accepted");
  const AlgorithmForm form = example_form("my_wave", 100);
  EXPECT_TRUE(is_wave(form) && has_harmonic(form) && has_values_of_example(form));
  EXPECT_EQ(form.parameters[2].minimum, "-180");
  EXPECT_EQ(form.parameters[2].maximum, "180");
}

TEST(AlgorithmForm, NamesTheFieldThatBreaksARule) {
  const struct {
    std::function<void(AlgorithmForm&)> change;
    const char* begin;
  } cases[] = {
      {[](AlgorithmForm& form) { form.name = "9lives"; }, "name: found '9lives', expected a letter"},
      {[](AlgorithmForm& form) { form.name = std::string(33, 'a'); }, "name: found 'aaa"},
      {[](AlgorithmForm& form) { form.name = "../up"; }, "name: found '../up'"},
      {[](AlgorithmForm& form) { form.name = "class"; }, "name: found 'class', expected a name that C++"},
      {[](AlgorithmForm& form) { form.name = "Directjointaccess"; }, "name: found 'Directjointaccess', a built-in"},
      {[](AlgorithmForm& form) { form.id = 95; }, "id: found 95, expected 96 to 126"},
      {[](AlgorithmForm& form) { form.id = 127; }, "id: found 127"},
      {[](AlgorithmForm& form) { form.help = "a \"quoted\" word"; }, "help: found"},
      {[](AlgorithmForm& form) { form.help.clear(); }, "help: found"},
      {[](AlgorithmForm& form) { form.parameters.clear(); }, "parameters: found 0, expected 1 to 32"},
      {[](AlgorithmForm& form) { form.parameters.resize(33); }, "parameters: found 33"},
      {[](AlgorithmForm& form) { form.values.resize(18); }, "values: found 18, expected at most 17"},
      {[](AlgorithmForm& form) { form.parameters[1].name = "amplitude"; }, "parameters.1.name: found another one"},
      {[](AlgorithmForm& form) { form.parameters[3].name = "while"; }, "parameters.3.name: found 'while'"},
      {[](AlgorithmForm& form) { form.parameters[3].name = "my_wave"; }, "parameters.3.name: found 'my_wave'"},
      {[](AlgorithmForm& form) { form.parameters[0].minimum = "low"; }, "parameters.0.minimum: found 'low'"},
      {[](AlgorithmForm& form) { form.parameters[0].maximum = "1e9"; }, "parameters.0.maximum: found '1e9'"},
      {[](AlgorithmForm& form) { form.parameters[0].minimum = "95"; }, "parameters.0.maximum: found 90, expected"},
      {[](AlgorithmForm& form) { form.parameters[1].usual = "21"; },
       "parameters.1.default: found 21, expected 0 to 20"},
      {[](AlgorithmForm& form) { form.parameters[1].help = "a\nb"; }, "parameters.1.help: found"},
      {[](AlgorithmForm& form) {
         form.values = {{"amplitude", Unit::ratio, "x"}};
       },
       "values.0.name: found another one"},
      {[](AlgorithmForm& form) {
         form.values = {{"state", Unit::ratio, "x"}};
       },
       "values.0.name: found 'state'"},
  };
  for (const auto& [change, begin] : cases) {
    EXPECT_TRUE(refusal(change).starts_with(begin)) << begin << ": " << refusal(change);
  }
}

TEST(AlgorithmForm, APhaseOf180DegreesIsTheLargestAsAMaximum) {
  EXPECT_EQ(form_value("180", Unit::phase_degree, true), phase_maximum);
  EXPECT_EQ(form_value("-180", Unit::phase_degree), phase_minimum);
}

}  // namespace
}  // namespace proleg::tools
