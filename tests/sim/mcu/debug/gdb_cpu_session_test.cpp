// The real debugger, with a virtual CPU that executes a real program.

#include <gtest/gtest.h>

#include <string>

#include "gdb_owner.hpp"
#include "sim/mcu/cpu/cpu.hpp"

namespace proleg::sim {
namespace {

class NoPeripherals final : public CpuSurroundings {
 public:
  std::uint32_t load(std::uint32_t /*address*/, unsigned /*size*/) override { return 0; }
  void store(std::uint32_t /*address*/, unsigned /*size*/, std::uint32_t /*value*/) override {}
  bool store_to_flash(std::uint32_t /*address*/, unsigned /*size*/, std::uint32_t /*value*/) override { return false; }
  [[nodiscard]] LocalTime now() const override { return {}; }
  [[nodiscard]] LocalTime core_period() const override { return LocalTime{1}; }
  void reset_requested() override {}
};

struct CpuProgram {
  void step() { cpu.step(); }
  /// Short, so that runs begin and end everywhere: also at breakpoints.
  bool run_slice() { return cpu.run(7) == Cpu::State::at_breakpoint; }

  Cpu& cpu;
};

class GdbCpuSession : public testing::Test {
 protected:
  // As a user would: reset, and drop the registers of before.
  GdbCpuSession() {
    server.set_monitor([this](std::string_view text) {
      if (text != "reset") {
        return std::string("?\n");
      }
      cpu.reset();
      return std::string("reset\n");
    });
  }

  NoPeripherals surroundings;
  Cpu cpu{surroundings};
  CpuProgram program{cpu};
  CpuTarget target{cpu};
  GdbServer server{0, target};
};

const std::vector<std::string> load_and_reset{"load", "monitor reset", "maintenance flush register-cache"};

std::vector<std::string> after_load(const std::vector<std::string>& commands) {
  std::vector<std::string> all = load_and_reset;
  all.insert(all.end(), commands.begin(), commands.end());
  return all;
}

// main() of program.c takes the readings -10, -20, -30, -40: -100 in total.
TEST_F(GdbCpuSession, BreaksReadsVariablesStepsChangesARegisterAndContinues) {
  GdbProcess gdb(PROLEG_PROGRAM, server.port(),
                 after_load({"print $pc == (long)main",
                             "print/x $sp",
                             "break take_reading",
                             "continue",
                             "info args",
                             "continue",
                             "print total",
                             "print last",
                             "backtrace",
                             "finish",
                             "print $pc > (long)main",
                             "continue",
                             "set $r1 = 1000",
                             "delete",
                             "break program.c:40",
                             "continue",
                             "print total",
                             "print rounds",
                             "next",
                             "print rounds",
                             "stepi",
                             "stepi",
                             "detach"}));
  EXPECT_EQ(run_under(server, program, gdb), Resume::detach);
  EXPECT_TRUE(contains(
      gdb.output(),
      {"$1 = 1", "$2 = 0x20008000", "Breakpoint 1, take_reading", "number = 1", "scale = -10", "number=number@entry=2",
       "$3 = -10", "$4 = {number = 1, value = -10}", "#0  take_reading", "#1 ", "main", "Value returned is $5 = -20",
       "$6 = 1", "number=number@entry=3", "Breakpoint 2, main", "$7 = 2930", "$8 = 500", "$9 = 501", "detached"}));
}

TEST_F(GdbCpuSession, SeesThroughAnExceptionHandlerToTheProgramBelow) {
  GdbProcess gdb(PROLEG_PROGRAM, server.port(),
                 after_load({"break supervisor", "continue", "print $xpsr & 0x1ff", "backtrace", "stepi", "detach"}));
  EXPECT_EQ(run_under(server, program, gdb), Resume::detach);
  EXPECT_TRUE(contains(gdb.output(), {"Breakpoint 1, supervisor", "$1 = 11", "#0  supervisor",
                                      "<signal handler called>", "#2  main ()", "detached"}));
}

TEST_F(GdbCpuSession, IsStoppedByControlCAndContinuesFromThere) {
  GdbProcess gdb(PROLEG_PROGRAM, server.port(),
                 after_load({"continue", "print rounds > 500", "print $pc >= 0x8000000 && $pc < 0x8001000",
                             "break take_reading", "continue", "print total >= -60 && total <= 0", "kill"}));
  EXPECT_EQ(run_under(server, program, gdb), Resume::kill);
  EXPECT_TRUE(
      contains(gdb.output(), {"received signal SIGINT", "$1 = 1", "$2 = 1", "Breakpoint 1, take_reading", "$3 = 1"}));
}

}  // namespace
}  // namespace proleg::sim
