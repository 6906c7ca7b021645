#include "sim/mcu/cpu/back_trace.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/sim/mcu/cpu/cpu_rig.hpp"

namespace proleg::sim {
namespace {

class BackTraceTest : public Programs {
 protected:
  std::vector<CallFrame> trace_of_fault() {
    const std::vector<CpuFault> faults = cpu_.take_faults();
    EXPECT_EQ(faults.size(), 1U);
    if (faults.empty()) {
      return {};
    }
    std::copy_n(faults[0].registers.begin(), registers_.size(), registers_.begin());
    return tracer_.trace(registers_, read_);
  }

  static void expect_functions(const std::vector<CallFrame>& frames, const std::vector<std::string>& names) {
    std::vector<std::string> found;
    for (const CallFrame& frame : frames) {
      const std::size_t begin = frame.text.find('(');
      const std::size_t end = frame.text.find('+');
      found.push_back(begin == std::string::npos || end == std::string::npos
                          ? frame.text
                          : frame.text.substr(begin + 1, end - begin - 1));
    }
    EXPECT_EQ(found, names);
  }

  BackTracer tracer_{image_file("cpu_programs")};
  ReadMemory read_ = [this](std::uint32_t address, std::span<std::uint8_t> bytes) { cpu_.read(address, bytes); };
  std::array<std::uint32_t, 17> registers_{};
};

TEST_F(BackTraceTest, NamesTheFunctionsFromTheFaultToTheBegin) {
  script(0, {step::call(address_of("first_function") | 1U)});
  set_vector(3, "faulting_handler");
  start("reset_handler");
  cpu_.set_breakpoints(std::array{address_of("faulting_handler")});
  rig_.run(10'000);
  const std::vector<CallFrame> frames = trace_of_fault();
  expect_functions(frames, {"third_function", "second_function", "first_function", "play", "reset_handler"});
  ASSERT_FALSE(frames.empty());
  EXPECT_NE(frames[0].text.find("scripts.cpp:"), std::string::npos) << frames[0].text;
}

TEST_F(BackTraceTest, ContinuesThroughTheHandlerOfAnInterruptIntoTheInterruptedCode) {
  set_vector(16 + 7, "calling_handler");
  script(0, {step::store(scs::iser, 1U << 7U), step::store(scs::ispr, 1U << 7U)});
  start("reset_handler");
  set_vector(3, "faulting_handler");
  cpu_.set_breakpoints(std::array{address_of("faulting_handler")});
  rig_.run(10'000);
  const std::vector<CallFrame> frames = trace_of_fault();
  expect_functions(frames, {"third_function", "second_function", "calling_handler", "play", "reset_handler"});
  ASSERT_EQ(frames.size(), 5U);
  EXPECT_EQ(frames[2].exception, 16U + 7U);
  EXPECT_EQ(frames[1].exception, 0U);
  const std::vector<std::string> lines = trace_back(image_file("cpu_programs"), registers_, read_);
  ASSERT_EQ(lines.size(), 6U);
  EXPECT_EQ(lines[3], "exception 23 (interrupt 7), which came in");
}

TEST_F(BackTraceTest, AJumpToAnInvalidAddressIsTracedToItsCaller) {
  script(0, {step::call(0x6000'0001)});
  set_vector(3, "faulting_handler");
  start("reset_handler");
  cpu_.set_breakpoints(std::array{address_of("faulting_handler")});
  rig_.run(10'000);
  const std::vector<CallFrame> frames = trace_of_fault();
  expect_functions(frames, {"0x60000000", "play", "reset_handler"});
}

TEST_F(BackTraceTest, HasTheLinkRegisterOnlyWithoutCallFrameInformation) {
  // Assembly.
  registers_[15] = address_of("distinct_registers");
  registers_[14] = address_of("reset_handler") + 5;
  registers_[13] = 0x3000'0000;
  const std::vector<CallFrame> frames = tracer_.trace(registers_, read_);
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_EQ(frames[1].address, address_of("reset_handler") + 4);
}

TEST_F(BackTraceTest, NonsenseEndsTheTrace) {
  for (unsigned i = 0; i < registers_.size(); ++i) {
    registers_[i] = 0xDEAD'0000 + 16 * i;
  }
  EXPECT_LE(tracer_.trace(registers_, read_).size(), 2U);
  registers_.fill(0xFFFF'FFFF);
  EXPECT_LE(tracer_.trace(registers_, read_).size(), 2U);
  registers_[14] = 0xFFFF'FFF1;
  registers_[15] = address_of("third_function");
  EXPECT_LE(tracer_.trace(registers_, read_).size(), 2U);
}

TEST_F(BackTraceTest, EndsAtTheLatestAfter32Frames) {
  // A stack that holds only return addresses into one function, as if it had called itself again and again.
  registers_[15] = address_of("second_function") + 20;
  registers_[14] = registers_[15] | 1U;
  registers_[13] = ChipMemory::ram_start;
  for (std::uint32_t i = 0; i < 0x4000; i += 4) {
    rig_.set_word(ChipMemory::ram_start + i, (address_of("second_function") + 20) | 1U);
  }
  EXPECT_LE(tracer_.trace(registers_, read_).size(), BackTracer::max_frames);
}

TEST_F(BackTraceTest, DescribesAnAddress) {
  EXPECT_NE(tracer_.describe(address_of("play")).find("(play+0), "), std::string::npos);
  EXPECT_EQ(tracer_.describe(0x6000'0000), "0x60000000");
}

}  // namespace
}  // namespace proleg::sim
