#include "tools/proleg/ui/compiler_messages.hpp"

#include <gtest/gtest.h>

namespace proleg::tools {
namespace {

using Severity = CompilerMessage::Severity;

void expect(const CompilerMessage& message, const std::string& file, std::uint32_t line, std::uint32_t column,
            Severity severity, const std::string& text) {
  EXPECT_EQ(message.file, file);
  EXPECT_EQ(message.line, line);
  EXPECT_EQ(message.column, column);
  EXPECT_EQ(message.severity, severity);
  EXPECT_EQ(message.text, text);
}

TEST(CompilerMessages, OfGcc) {
  const auto messages = compiler_messages(
      "[1/3] Building CXX object CMakeFiles/wave.dir/wave.algorithm.cpp.o\n"
      "FAILED: CMakeFiles/wave.dir/wave.algorithm.cpp.o \n"
      "/usr/bin/c++ -O2 -c wave.algorithm.cpp: error: not a message but a command\n"
      "In file included from /w/build/wave.algorithm.cpp:3:\n"
      "/w/wave.cpp: In member function 'virtual void Algorithm::advance() const':\n"
      "/w/wave.cpp:61:5: error: 'thet' was not declared in this scope; did you mean 'theta'?\n"
      "   61 |     thet = 1;\n"
      "      |     ^~~~\n"
      "/w/wave.cpp:70:20: warning: unused variable 'a: b' [-Wunused-variable]\n"
      "/w/shared/fixed/sine.hpp:12:3: note: declared here\n"
      "/w/wave.cpp:2:10: fatal error: sine.hpp: No such file or directory\n"
      "compilation terminated.\n");
  ASSERT_EQ(messages.size(), 4U);
  expect(messages[0], "/w/wave.cpp", 61, 5, Severity::error,
         "'thet' was not declared in this scope; did you mean 'theta'?");
  expect(messages[1], "/w/wave.cpp", 70, 20, Severity::warning, "unused variable 'a: b' [-Wunused-variable]");
  expect(messages[2], "/w/shared/fixed/sine.hpp", 12, 3, Severity::note, "declared here");
  expect(messages[3], "/w/wave.cpp", 2, 10, Severity::error, "sine.hpp: No such file or directory");
}

TEST(CompilerMessages, OfClang) {
  const auto messages = compiler_messages(
      "/w/wave.cpp:61:12: error: expected ';' after expression\n"
      "    theta = 1\n"
      "             ^\n"
      "             ;\n"
      "1 error generated.\n");
  ASSERT_EQ(messages.size(), 1U);
  expect(messages[0], "/w/wave.cpp", 61, 12, Severity::error, "expected ';' after expression");
}

TEST(CompilerMessages, OfALinkerAndOfAPlaceWithoutAColumn) {
  const auto messages = compiler_messages(
      "/usr/bin/ld: wave.cpp.o: in function `advance':\n"
      "wave.cpp:(.text+0x15): undefined reference to `proleg::helper(int)'\n"
      "wave.cpp:8: error: old style\n");
  ASSERT_EQ(messages.size(), 2U);
  expect(messages[0], "", 0, 0, Severity::error, "undefined reference to `proleg::helper(int)'");
  expect(messages[1], "wave.cpp", 8, 0, Severity::error, "old style");
}

TEST(CompilerMessages, OfCMakeWithThePlaceThatItNames) {
  const auto messages = compiler_messages(
      "CMake Error at /p/tools/cmake/check_floating_point.cmake:22 (message):\n"
      "  /w/wave.cpp: found floating point (/w/wave.cpp:40:11), expected integers\n"
      "  alone.\n"
      "\n"
      "\n"
      "CMake Error: The source directory is missing.\n");
  ASSERT_EQ(messages.size(), 2U);
  expect(messages[0], "/w/wave.cpp", 40, 11, Severity::error,
         "/w/wave.cpp: found floating point (/w/wave.cpp:40:11), expected integers alone.");
  expect(messages[1], "", 0, 0, Severity::error, "The source directory is missing.");
}

TEST(CompilerMessages, EachOnceAndNotTooMany) {
  EXPECT_EQ(compiler_messages("a.cpp:1:1: error: x\na.cpp:1:1: error: x\n").size(), 1U);
  std::string many;
  for (int i = 1; i < 1000; ++i) {
    many += "a.cpp:" + std::to_string(i) + ":1: error: x\n";
  }
  EXPECT_EQ(compiler_messages(many).size(), 200U);
  EXPECT_TRUE(compiler_messages("").empty());
  EXPECT_TRUE(compiler_messages(": error: \n:1:1: error: x\nCMake Error at").size() <= 1U);
}

TEST(BuildProgress, IsThatOfTheLastLine) {
  const BuildProgress progress = build_progress("[1/25] Building\n[3/25] Linking [x/y] \nerror\n");
  EXPECT_EQ(progress.done, 3U);
  EXPECT_EQ(progress.of, 25U);
  EXPECT_EQ(build_progress("[a/b] x\n[/] \n").of, 0U);
}

}  // namespace
}  // namespace proleg::tools
