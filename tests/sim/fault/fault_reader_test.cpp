#include "sim/fault/fault.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "shared/computer/errors/input_error.hpp"
#include "sim/scenario/reader.hpp"
#include "tests/support/files.hpp"
#include "tests/support/message_of.hpp"

namespace proleg::sim {
namespace {

constexpr std::uint64_t run_us = 5'000'000;

const Scenario& caterpillar() {
  static const Scenario scenario = [] {
    DiskFiles files;
    return read_scenario(source_path("/sim/scenarios/travelling_wave/uniform.simulation.xml"), files);
  }();
  return scenario;
}

FaultSchedule parse(const std::string& text) { return parse_faults(text, "f.txt", caterpillar().robot, run_us); }
std::string refusal_of(const std::string& text) {
  return message_of<InputError>([&] { static_cast<void>(parse(text)); });
}

TEST(FaultFile, MayComeFromAnyEditor) {
  const FaultSchedule schedule = parse(
      "\xEF\xBB\xBF"
      "at 1s unplug J3 for 400ms\r\nat\t2s corrupt 12.5% for 1s\r\n");
  ASSERT_EQ(schedule.size(), 2U);
  EXPECT_NE(refusal_of("at\xC2\xA0"
                       "1s unplug J3 for 1s")
                .find("<U+00A0>"),
            std::string::npos);
}

TEST(FaultFile, HasAFaultInEachLine) {
  const FaultSchedule schedule = parse(
      "# a comment\n"
      "at 1.2s unplug J3 for 400ms\n"
      "\n"
      "   at 500us send 080#05 every 7ms for 0.3s   # a foreign SYNC\n"
      "at 2s corrupt 12.5% for 1s\n");
  ASSERT_EQ(schedule.size(), 3U);
  EXPECT_EQ(schedule[0].kind, FaultKind::send) << "by ascending time";
  EXPECT_EQ(schedule[0].start_us, 500U);
  EXPECT_EQ(schedule[0].repeat_us, 7'000U);
  EXPECT_EQ(schedule[0].duration_us, 300'000U);
  EXPECT_EQ(schedule[0].frame, (CanFrame{0x080, 1, {0x05}}));
  EXPECT_EQ(schedule[1].kind, FaultKind::unplug);
  EXPECT_EQ(schedule[1].start_us, 1'200'000U);
  EXPECT_EQ(schedule[1].duration_us, 400'000U);
  EXPECT_EQ(caterpillar().robot.joints[*schedule[1].joint].name, "J3");
  EXPECT_EQ(schedule[2].amount, std::uint32_t{1} << 29U) << "an eighth of 2^32";
}

TEST(FaultFile, AStarIsOneFaultAtEachJoint) {
  const FaultSchedule schedule = parse("at 1s supply * 2.5V for 1s");
  ASSERT_EQ(schedule.size(), caterpillar().robot.joints.size());
  for (unsigned joint = 0; joint < schedule.size(); ++joint) {
    EXPECT_EQ(schedule[joint].joint, joint);
    EXPECT_EQ(schedule[joint].amount, 2'500U);
  }
}

TEST(FaultFile, EachKindHasAnExampleOfItsForm) {
  const std::vector<std::string> lines{
      "at 1s unplug J1 for 1s",      "at 1s supply J1 0V for 1s", "at 1s reset J1",
      "at 1s crystal J1 for 1s",     "at 1s pll J1 for 1s",       "at 1s adc J1 for 1s",
      "at 1s touch J1 open for 1s",  "at 1s jam J1 2.5A for 1s",  "at 1s babble 001 for 1s",
      "at 1s dominant for 1s",       "at 1s corrupt 1% for 1s",   "at 1s lose J1 99.9% for 1s",
      "at 1s delay J1 1.5ms for 1s", "at 1s send 7FF#",           "at 1s master",
      "at 1s host-stall for 0.125s", "at 1s host-dies",
  };
  ASSERT_EQ(lines.size(), fault_declarations().size());
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const FaultSchedule schedule = parse(lines[i]);
    ASSERT_EQ(schedule.size(), 1U) << lines[i];
    EXPECT_EQ(schedule[0].kind, fault_declarations()[i].kind) << lines[i];
  }
}

TEST(FaultFile, WhatIsWrittenIsReadAgain) {
  for (std::uint64_t seed = 0; seed < 2'000; ++seed) {
    const FaultSchedule schedule = random_faults({seed, run_us, true}, caterpillar());
    const std::string text = faults_text(schedule, caterpillar().robot);
    EXPECT_EQ(parse(text), schedule) << text;
  }
}

TEST(FaultFile, WhatIsWrongIsNamedWithItsLine) {
  struct Case {
    const char* text;
    const char* message;
  };
  for (const auto& [text, message] : {
           Case{"at 1s unplug J9 for 1s", "f.txt:1: found the joint 'J9', expected one of J"},
           Case{"\nat 1s explode J1 for 1s", "f.txt:2: found the fault 'explode', expected one of unplug, supply"},
           Case{"on 1s reset J1", "f.txt:1: found 'on', expected at TIME KIND"},
           Case{"at 5s reset J1", "found the time 5s, expected less than the 5s of the run"},
           Case{"at 1 reset J1", "found the time '1', expected a number with s, ms or us"},
           Case{"at -1s reset J1", "found the time '-1s'"},
           Case{"at nans reset J1", "found the time 'nans'"},
           Case{"at 1e30s reset J1", "found the time '1e30s'"},
           Case{"at 1s reset", "expected at TIME reset JOINT"},
           Case{"at 1s reset J1 for 1s", "found 'for', expected at TIME reset JOINT"},
           Case{"at 1s unplug J1", "expected at TIME unplug JOINT for TIME"},
           Case{"at 1s unplug J1 for 0s", "found a time of 0"},
           Case{"at 1s unplug J1 until 2s", "found 'until', expected at TIME unplug JOINT for TIME"},
           Case{"at 1s supply J1 5V for 1s", "found '5V', expected 0V to 3.6V"},
           Case{"at 1s supply J1 3 for 1s", "found '3', expected 0V to 3.6V"},
           Case{"at 1s jam J1 11A for 1s", "found '11A', expected 0A to 10A"},
           Case{"at 1s corrupt 101% for 1s", "found '101%', expected a probability"},
           Case{"at 1s lose J1 x for 1s", "found 'x', expected a probability"},
           Case{"at 1s delay J1 11s for 1s", "found '11s', expected 1us to 10s"},
           Case{"at 1s touch J1 broken for 1s", "found 'broken', expected pressed, open or bouncing"},
           Case{"at 1s send 800#00", "found '800#00', expected ID#DATA"},
           Case{"at 1s send 080#0", "found '080#0', expected ID#DATA"},
           Case{"at 1s send 080#000000000000000000", "expected ID#DATA"},
           Case{"at 1s babble 1 for 1s", "found '1', expected three hexadecimal digits"},
           Case{"at 1s dominant for 100us", "found a dominant bus for 100us, expected at least 300us"},
           Case{"at 1s unplug J1 for 1s\nat 1.5s unplug J1 for 1s",
                "f.txt:2: found 'at 1.5s unplug J1 for 1s' while 'at 1s unplug J1 for 1s' lasts"},
           Case{"at 1s unplug * for 1s\nat 1.5s unplug J1 for 1s", "lasts, expected faults of one kind"},
       }) {
    EXPECT_NE(refusal_of(text).find(message), std::string::npos) << text << ": " << refusal_of(text);
  }
}

TEST(FaultFile, ThatIsMissingOrEmptyIsRefused) {
  const auto read = [](const std::string& path) {
    return message_of<InputError>([&] { static_cast<void>(read_faults(path, caterpillar().robot, run_us)); });
  };
  EXPECT_NE(read("no/such/file").find("no such file"), std::string::npos);
  EXPECT_NE(read(source_path("/sim")).find("found a folder"), std::string::npos);
  EXPECT_NE(read("/dev/null").find("found"), std::string::npos);
}

TEST(FaultTime, IsWrittenAsShortAsItIs) {
  EXPECT_EQ(time_word(0), "0s");
  EXPECT_EQ(time_word(999), "999us");
  EXPECT_EQ(time_word(1'000), "1ms");
  EXPECT_EQ(time_word(1'050), "1.05ms");
  EXPECT_EQ(time_word(1'000'000), "1s");
  EXPECT_EQ(time_word(1'200'001), "1.200001s");
}

}  // namespace
}  // namespace proleg::sim
