// The real debugger, with a target that has memory and registers, and pretends to run.

#include <gtest/gtest.h>

#include <string>

#include "fake_target.hpp"
#include "gdb_owner.hpp"

namespace proleg::sim {
namespace {

class GdbSession : public testing::Test {
 protected:
  FakeTarget target;
  GdbServer server{0, target};
};

TEST_F(GdbSession, LoadsBreaksReadsVariablesStepsChangesARegisterAndDetaches) {
  GdbProcess gdb(PROLEG_PROGRAM, server.port(),
                 {"info registers xpsr", "load", "compare-sections", "print last", "print/x vectors[0]",
                  "print total = 77", "print total", "break main", "hbreak take_reading", "continue", "continue",
                  "stepi", "print (long)$pc - (long)main", "set $r5 = 0x12345678", "print/x $r5",
                  "set $sp = 0x20000100", "info threads", "detach"});
  target.registers[16] = 0x0100'0000;
  EXPECT_EQ(run_under(server, target, gdb), Resume::detach);
  EXPECT_TRUE(
      contains(gdb.output(), {"0x1000000", "Section .data", "matched", "$1 = {number = 7, value = -40}",
                              "$2 = 0x20008000", "$3 = 77", "$4 = 77", "Breakpoint 2, take_reading",
                              "Breakpoint 1, main ()", "$5 = 2", "$6 = 0x12345678", "* 1    Thread 1", "detached"}));
  EXPECT_EQ(gdb.output().find("MIS-MATCHED"), std::string::npos) << gdb.output();
  EXPECT_EQ(target.registers[5], 0x1234'5678U);
  EXPECT_EQ(target.registers[13], 0x2000'0100U);
  EXPECT_TRUE(target.breakpoints.empty());
}

TEST_F(GdbSession, IsStoppedByControlC) {
  GdbProcess gdb(PROLEG_PROGRAM, server.port(), {"load", "continue", "print \"after\"", "kill"});
  EXPECT_EQ(run_under(server, target, gdb), Resume::kill);
  EXPECT_TRUE(contains(gdb.output(), {"received signal SIGINT", "\"after\"", "killed"}));
}

TEST_F(GdbSession, PassesMonitorCommandsToTheOwner) {
  std::string asked;
  server.set_monitor([&](std::string_view text) {
    asked = text;
    return std::string("virtual time 1.25 s\n");
  });
  GdbProcess gdb(PROLEG_PROGRAM, server.port(), {"monitor time please"});
  // A debugger that quits detaches.
  EXPECT_EQ(run_under(server, target, gdb), Resume::detach);
  EXPECT_EQ(asked, "time please");
  EXPECT_TRUE(contains(gdb.output(), {"virtual time 1.25 s"}));
}

TEST_F(GdbSession, ReportsWhereThereIsNoMemory) {
  GdbProcess gdb(PROLEG_PROGRAM, server.port(),
                 {"print *(int*)0x30000000", "print *(int*)0x30000000 = 1", "x/4xb 0x2000fffe", "detach"});
  EXPECT_EQ(run_under(server, target, gdb), Resume::detach);
  EXPECT_TRUE(contains(gdb.output(),
                       {"Cannot access memory at address 0x30000000", "Cannot access memory at address 0x30000000",
                        "Cannot access memory at address 0x20010000"}));
}

TEST_F(GdbSession, IsFollowedByAnother) {
  for (int session = 0; session < 2; ++session) {
    GdbProcess gdb(PROLEG_PROGRAM, server.port(), {"print $pc", "detach"});
    EXPECT_EQ(run_under(server, target, gdb), Resume::detach);
    EXPECT_TRUE(contains(gdb.output(), {"$1 = ", "detached"}));
  }
}

TEST_F(GdbSession, ThatIsKilledLeavesTheTargetRunning) {
  GdbProcess gdb(PROLEG_PROGRAM, server.port(), {"load", "break main", "continue", "shell kill -9 $PPID"});
  EXPECT_EQ(run_under(server, target, gdb), Resume::detach);
  EXPECT_TRUE(target.breakpoints.empty());
}

}  // namespace
}  // namespace proleg::sim
