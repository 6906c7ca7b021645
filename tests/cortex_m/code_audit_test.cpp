// All of the core needs no FPU, no floating-point library and no heap, on both processors.

#include "tests/cortex_m/code_audit.hpp"

#include <gtest/gtest.h>

#include "tests/cortex_m/core_image.hpp"

namespace proleg::cortex_m {
namespace {

class CodeAudit : public testing::TestWithParam<Cpu> {
 protected:
  ElfImage image_{core_image_file(GetParam())};
};

TEST_P(CodeAudit, TheCoreUsesNoFpuAndNoOtherCoprocessor) {
  ASSERT_FALSE(image_.code().empty());
  EXPECT_EQ(coprocessor_instructions(image_, image_.code()), std::vector<std::string>());
}

TEST_P(CodeAudit, TheCoreLinksNoFloatingPointLibrary) {
  for (const ElfImage::Symbol& symbol : image_.symbols()) {
    EXPECT_FALSE(is_floating_point_helper(symbol.name)) << symbol.name;
  }
}

TEST_P(CodeAudit, TheCoreLinksNoHeap) {
  for (const ElfImage::Symbol& symbol : image_.symbols()) {
    EXPECT_FALSE(is_heap_function(symbol.name)) << symbol.name;
  }
}

TEST_P(CodeAudit, AllOfTheCodeOfTheKernelIsRead) {
  const ElfImage::Symbol& advance = image_.symbol("proleg::Kernel::advance");
  std::size_t bytes = 0;
  for (const ElfImage::Code& code : image_.code()) {
    if (code.address >= advance.address && code.address < advance.address + advance.size) {
      bytes += code.bytes.size();
    }
  }
  // Constants lie between the instructions, but few.
  EXPECT_GT(bytes, advance.size / 2);
}

TEST_P(CodeAudit, AnFpuInstructionWouldBeFound) {
  // vadd.f32 s0, s0, s1 = EE30 0A20 after nop; ldr r0, =constant that looks like one is not code.
  const std::vector<ElfImage::Code> code{{0x0800'0000, {0x00, 0xBF, 0x30, 0xEE, 0x20, 0x0A, 0x70, 0x47}}};
  EXPECT_EQ(coprocessor_instructions(image_, code).size(), 1U);
}

INSTANTIATE_TEST_SUITE_P(Processors, CodeAudit, testing::Values(Cpu::cortex_m0, Cpu::cortex_m4),
                         [](const testing::TestParamInfo<Cpu>& cpu) {
                           return cpu.param == Cpu::cortex_m4 ? "CortexM4" : "CortexM0";
                         });

TEST(CodeAuditNames, HelpersOfFloatingPointAreKnownByName) {
  for (const char* name : {"__aeabi_dadd", "__aeabi_fmul", "__aeabi_d2iz", "__aeabi_i2d", "__aeabi_ul2f",
                           "__aeabi_cdcmple", "__adddf3", "__mulsf3", "__floatsidf", "__fixunssfsi"}) {
    EXPECT_TRUE(is_floating_point_helper(name)) << name;
  }
  for (const char* name : {"__aeabi_lmul", "__aeabi_ldivmod", "__aeabi_uidiv", "__clzsi2", "memcpy"}) {
    EXPECT_FALSE(is_floating_point_helper(name)) << name;
  }
}

TEST(CodeAuditNames, FunctionsOfTheHeapAreKnownByName) {
  for (const char* name : {"malloc", "free", "_sbrk", "_Znwj", "_ZdlPv", "_Znaj"}) {
    EXPECT_TRUE(is_heap_function(name)) << name;
  }
  EXPECT_FALSE(is_heap_function("_ZN6proleg4sineEm"));
}

}  // namespace
}  // namespace proleg::cortex_m
