#include "tools/proleg/common/program_report.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tools/proleg/common/command_line.hpp"

namespace proleg::tools {
namespace {

struct Printed {
  int status;
  std::string output;
};

/// A program that reports an event and its result.
Printed output_of_report(std::vector<std::string> words, const Json& event_value = 3) {
  words.insert(words.begin(), "test");
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (std::string& word : words) {
    arguments.push_back(word.data());
  }
  arguments.push_back(nullptr);
  ProgramReport report;
  CommandLine command_line("proleg test", "A test.");
  report.add_options(command_line);
  testing::internal::CaptureStdout();
  const int status = command_line.run(static_cast<int>(words.size()), arguments.data(), [&] {
    report.print_event("moves", {{"node", event_value}});
    report.print_result({{"joints", 2}});
    return exit_failed;
  });
  return {status, testing::internal::GetCapturedStdout()};
}

TEST(ProgramReport, IsTextUnlessAnOptionAsksForJson) { EXPECT_EQ(output_of_report({}).output, ""); }

TEST(ProgramReport, IsOneObjectWithJson) { EXPECT_EQ(output_of_report({"--json"}).output, "{\n  \"joints\": 2\n}\n"); }

TEST(ProgramReport, IsALineForEachEventWithJsonLinesAndTheResultIsTheLast) {
  EXPECT_EQ(output_of_report({"--json-lines"}).output,
            "{\"event\":\"moves\",\"node\":3}\n{\"event\":\"result\",\"value\":{\"joints\":2}}\n");
  EXPECT_EQ(output_of_report({"--json-lines"}).status, exit_failed) << "the result does not change the exit status";
}

TEST(ProgramReport, TakesOneOfTheTwoOptions) {
  EXPECT_EQ(output_of_report({"--json", "--json-lines"}).status, exit_bad_input);
  EXPECT_EQ(output_of_report({"--json", "--json-lines"}).output, "");
}

/// Unicode has line ends that some readers of lines take for the end of one; and bytes of a file name may be no text.
TEST(ProgramReport, AnEventIsOneLineOfAsciiWhateverTheNamesInItAre) {
  for (const char* const name : {"J\n1", "J\xE2\x80\xA8", "J\xC2\x85", "J\xFF", "J\"1\""}) {
    const std::string output = output_of_report({"--json-lines"}, name).output;
    EXPECT_EQ(std::ranges::count(output, '\n'), 2) << output;
    EXPECT_TRUE(std::ranges::all_of(output, [](char c) { return c == '\n' || (c >= ' ' && c <= '~'); })) << output;
  }
}

}  // namespace
}  // namespace proleg::tools
