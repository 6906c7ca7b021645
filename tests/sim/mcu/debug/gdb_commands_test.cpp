// Oracle: "Debugging with GDB", appendix E.2 to E.4.

#include "sim/mcu/debug/gdb_commands.hpp"

#include <gtest/gtest.h>

#include <string>

#include "fake_target.hpp"
#include "sim/mcu/debug/gdb_packet.hpp"

namespace proleg::sim {
namespace {

using Breakpoints = std::vector<std::uint32_t>;

class Commands : public testing::Test {
 protected:
  // What is sent; "(none)" if nothing is.
  std::string reply(std::string_view packet) { return commands.answer(packet).reply.value_or("(none)"); }
  std::optional<Resume> resume(std::string_view packet) { return commands.answer(packet).resume; }

  FakeTarget target;
  GdbCommands commands{target};
};

TEST_F(Commands, UnknownOnesGetAnEmptyReply) {
  for (const char* const packet :
       {"", "!", "R00", "b", "qOffsets", "qSymbol::", "vMustReplyEmpty", "vKill;1", "QNonStop:1", "Z2,20000000,4",
        "z4,20000000,4", "qRcmd,00", "\xFF", "qXfer:memory-map:read::0,100"}) {
    EXPECT_EQ(reply(packet), "") << packet;
    EXPECT_FALSE(resume(packet)) << packet;
  }
}

TEST_F(Commands, RegistersTravelInTheByteOrderOfTheTarget) {
  for (unsigned i = 0; i < DebugTarget::register_count; ++i) {
    target.registers.at(i) = 0x11223300 + i;
  }
  const std::string all = reply("g");
  ASSERT_EQ(all.size(), 17U * 8U);
  EXPECT_EQ(all.substr(0, 16), "0033221101332211");
  EXPECT_EQ(reply("pf"), "0f332211");
  EXPECT_EQ(reply("p10"), "10332211");
  EXPECT_EQ(reply("p11"), "E16");
  EXPECT_EQ(reply("Pd=00010020"), "OK");
  EXPECT_EQ(target.registers[13], 0x2000'0100U);
  for (const char* const bad : {"P11=00000000", "P0=0000", "P0", "P=00000000", "P0=0000000g", "p", "G00"}) {
    EXPECT_EQ(reply(bad), "E16") << bad;
  }
  EXPECT_EQ(reply("G" + all), "OK");
  EXPECT_EQ(reply("g"), all);
}

TEST_F(Commands, MemoryIsReadAndWrittenInDigitsAndInBytes) {
  EXPECT_EQ(reply("M20000010,3:0102ff"), "OK");
  EXPECT_EQ(reply("m2000000f,5"), "000102ff00");
  EXPECT_EQ(reply(std::string("X20000010,2:\0#", 14)), "OK");
  EXPECT_EQ(reply("m20000010,3"), "0023ff");
  EXPECT_EQ(reply("X20000010,0:"), "OK");
  for (const char* const bad : {"m", "m,", "m20000000", "m20000000,", "m120000000,1", "M20000000,2:00",
                                "M20000000,1:0g", "M20000000,1", "X20000000,2:a", "mx,1"}) {
    EXPECT_EQ(reply(bad), "E16") << bad;
  }
}

TEST_F(Commands, MemoryEndsWhereItEnds) {
  EXPECT_EQ(reply("m30000000,4"), "E0e");
  EXPECT_EQ(reply("m2000fffe,8"), "0000");
  EXPECT_EQ(reply("M2000fffe,4:00000000"), "E0e");
  EXPECT_EQ(reply("mffffffff,ffffffff"), "E0e");
  EXPECT_EQ(reply("Mffffffff,2:0000"), "E0e");
  EXPECT_EQ(reply("m20000000,ffffffff").size(), GdbDecoder::max_packet);
}

TEST_F(Commands, BreakpointsOfBothKindsAreOneSetOfAddresses) {
  EXPECT_EQ(reply("Z0,8000100,2"), "OK");
  EXPECT_EQ(reply("Z1,8000101,2"), "OK");
  EXPECT_EQ(reply("Z0,8000200,3"), "OK");
  EXPECT_EQ(resume("c"), Resume::run);
  EXPECT_EQ(target.breakpoints, (Breakpoints{0x0800'0100, 0x0800'0200}));
  EXPECT_EQ(reply("z0,8000100,2"), "OK");
  EXPECT_EQ(reply("z0,8000200,2"), "OK");
  EXPECT_EQ(reply("z0,8000300,2"), "OK");
  EXPECT_EQ(resume("s"), Resume::step);
  EXPECT_EQ(target.breakpoints, Breakpoints{0x0800'0100});
  for (const char* const bad : {"Z0", "Z0,", "Z0,8000100", "Z0,x,2", "Z", "z"}) {
    EXPECT_EQ(reply(bad), "E16") << bad;
  }
}

TEST_F(Commands, ThereIsNoLimitToBreakpoints) {
  for (std::uint32_t i = 0; i < 5000; ++i) {
    const std::uint32_t address = FakeTarget::flash + 2 * i;
    const std::array<std::uint8_t, 4> bytes{0x08, 0, static_cast<std::uint8_t>(address >> 8U),
                                            static_cast<std::uint8_t>(address)};
    EXPECT_EQ(reply("Z1," + to_hex(bytes) + ",2"), "OK");
  }
  EXPECT_EQ(resume("c"), Resume::run);
  EXPECT_EQ(target.breakpoints.size(), 5000U);
}

// GDB removes them all at each stop and sets them again; each change costs the target its translated code.
TEST_F(Commands, BreakpointsThatComeBackBeforeTheTargetRunsChangeNothing) {
  EXPECT_EQ(reply("Z0,8000100,2"), "OK");
  EXPECT_EQ(resume("c"), Resume::run);
  EXPECT_EQ(reply("z0,8000100,2"), "OK");
  EXPECT_EQ(reply("Z0,8000100,2"), "OK");
  EXPECT_EQ(resume("c"), Resume::run);
  EXPECT_EQ(target.breakpoint_calls, 1);
}

TEST_F(Commands, DetachAndKillRemoveBreakpoints) {
  for (const auto& [packet, expected] : {std::pair("D", Resume::detach), std::pair("k", Resume::kill)}) {
    EXPECT_EQ(reply("Z0,8000100,2"), "OK");
    EXPECT_EQ(resume("c"), Resume::run);
    EXPECT_EQ(resume(packet), expected);
    EXPECT_EQ(target.breakpoints, Breakpoints{});
  }
  EXPECT_EQ(reply("D"), "OK");
  EXPECT_EQ(reply("k"), "(none)");
}

TEST_F(Commands, ContinueFromHereOrFromAnAddress) {
  EXPECT_EQ(reply("c"), "(none)");
  EXPECT_EQ(resume("s8000010"), Resume::step);
  EXPECT_EQ(target.registers[15], 0x0800'0010U);
  EXPECT_EQ(resume("C05;8000020"), Resume::run);
  EXPECT_EQ(target.registers[15], 0x0800'0020U);
  EXPECT_EQ(resume("S05"), Resume::step);
  EXPECT_EQ(target.registers[15], 0x0800'0020U);
  EXPECT_FALSE(resume("cx"));
  EXPECT_EQ(reply("cx"), "E16");
}

TEST_F(Commands, VContUsesTheFirstActionThatNamesTheThread) {
  EXPECT_EQ(reply("vCont?"), "vCont;c;C;s;S");
  EXPECT_EQ(resume("vCont;c"), Resume::run);
  EXPECT_EQ(resume("vCont;s:1;c"), Resume::step);
  EXPECT_EQ(resume("vCont;s:2;c"), Resume::run);
  EXPECT_EQ(resume("vCont;c:-1"), Resume::run);
  EXPECT_EQ(resume("vCont;S05:1;c:1"), Resume::step);
  EXPECT_EQ(resume("vCont;C0b"), Resume::run);
  for (const char* const bad : {"vCont;", "vCont;x", "vCont;s:2", "vCont;C", "vCont;Cx", "vCont;:1", "vCont;;"}) {
    EXPECT_FALSE(resume(bad)) << bad;
    EXPECT_EQ(reply(bad), "E16") << bad;
  }
}

TEST_F(Commands, StopRepliesHaveTheSignal) {
  const auto signal = [&](StopReason reason) {
    commands.set_stop_reason(reason);
    return reply("?").substr(0, 3);
  };
  EXPECT_EQ(signal(StopReason::attached), "T05");
  EXPECT_EQ(signal(StopReason::breakpoint), "T05");
  EXPECT_EQ(signal(StopReason::step), "T05");
  EXPECT_EQ(signal(StopReason::interrupt), "T02");
  EXPECT_EQ(signal(StopReason::fault), "T0b");
  target.registers[15] = 0x0800'1234;
  EXPECT_NE(reply("?").find(";0f:34120008;"), std::string::npos) << reply("?");
}

TEST_F(Commands, TheDescriptionIsTheSameInPortionsOfAnySize) {
  const std::string whole = reply("qXfer:features:read:target.xml:0,fff");
  ASSERT_EQ(whole.front(), 'l');
  EXPECT_NE(whole.find("org.gnu.gdb.arm.m-profile"), std::string::npos);
  std::string joined;
  for (std::string part = "m"; part.front() == 'm';) {
    const auto at = static_cast<std::uint16_t>(joined.size());
    const std::array<std::uint8_t, 2> bytes{static_cast<std::uint8_t>(at >> 8U), static_cast<std::uint8_t>(at)};
    part = reply("qXfer:features:read:target.xml:" + to_hex(bytes) + ",1f");
    ASSERT_TRUE(part.size() <= 0x1F + 1 && !part.empty());
    joined += part.substr(1);
  }
  EXPECT_EQ(joined, whole.substr(1));
  EXPECT_EQ(reply("qXfer:features:read:other.xml:0,fff"), "E00");
  for (const char* const bad : {"qXfer:features:read:target.xml", "qXfer:features:read:target.xml:0",
                                "qXfer:features:read:target.xml:ffff,1"}) {
    EXPECT_EQ(reply(bad), "E16") << bad;
  }
}

TEST_F(Commands, ThereIsOneThread) {
  EXPECT_EQ(reply("qC"), "QC1");
  EXPECT_EQ(reply("qfThreadInfo"), "m1");
  EXPECT_EQ(reply("qsThreadInfo"), "l");
  EXPECT_EQ(reply("Hg1"), "OK");
  EXPECT_EQ(reply("T1"), "OK");
  EXPECT_EQ(reply("T2"), "E16");
  EXPECT_EQ(reply("qAttached"), "1");
}

TEST_F(Commands, MonitorTextsComeFromTheOwner) {
  commands.set_monitor([](std::string_view text) { return text == "time" ? "1.5 s\n" : std::string(); });
  EXPECT_EQ(reply("qRcmd,74696d65"), "312e3520730a");
  EXPECT_EQ(reply("qRcmd,00"), "OK");
  EXPECT_EQ(reply("qRcmd,7"), "E16");
}

}  // namespace
}  // namespace proleg::sim
