// The same program on this CPU and on QEMU's Cortex-M4 (machine netduinoplus2, an STM32F405): both must compute the
// same.

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <string>

#include "tests/sim/mcu/cpu/cpu_rig.hpp"

namespace proleg::sim {
namespace {

constexpr std::string_view last_line = "end\n";

/// The output of QEMU's USART1 up to the last line.
std::string output_of_qemu(const std::string& image) {
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) {
    return "no pipe";
  }
  const pid_t child = fork();
  if (child == 0) {
    dup2(ends[1], STDOUT_FILENO);
    close(ends[0]);
    close(ends[1]);
    execl(PROLEG_QEMU, PROLEG_QEMU, "-M", "netduinoplus2", "-display", "none", "-monitor", "none", "-serial", "stdio",
          "-kernel", image.c_str(), nullptr);
    _exit(127);
  }
  close(ends[1]);
  std::string output;
  constexpr int max_silence_ms = 300'000;
  pollfd waiting{ends[0], POLLIN, 0};
  while (!output.ends_with(last_line) && poll(&waiting, 1, max_silence_ms) > 0) {
    std::array<char, 256> buffer{};
    const ssize_t count = read(ends[0], buffer.data(), buffer.size());
    if (count <= 0) {
      break;
    }
    output.append(buffer.data(), static_cast<std::size_t>(count));
  }
  close(ends[0]);
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  return output;
}

/// The same of the virtual CPU, run in slices of this many instructions.
std::string output_of_cpu(const std::string& file, std::uint64_t slice) {
  constexpr std::uint32_t usart_sr = 0x4001'1000;
  constexpr std::uint32_t usart_dr = 0x4001'1004;
  constexpr std::uint32_t empty_and_complete = 0xC0;
  CpuRig rig;
  const ElfImage image(file);
  for (const ElfImage::Segment& segment : image.segments()) {
    rig.cpu.write(segment.load_address, segment.bytes);
  }
  std::string output;
  rig.registers[usart_sr] = empty_and_complete;
  rig.on_store = [&](const CpuRig::Store& store) {
    if (store.address == usart_dr) {
      output.push_back(static_cast<char>(store.value));
    }
    rig.loads.clear();
    rig.stores.clear();
  };
  rig.cpu.reset();
  constexpr std::uint64_t max_instructions = 200'000'000;
  while (!output.ends_with(last_line) && rig.cpu.instructions() < max_instructions) {
    if (const Cpu::State state = rig.run(100'000, slice);
        state != Cpu::State::running && state != Cpu::State::sleeping) {
      return output + "stopped: " + rig.cpu.halt_reason();
    }
  }
  return output;
}

TEST(CrossCheck, ComputesAndInterruptsAsQemuDoes) {
  const std::string image = image_file("cpu_cross_check");
  const std::string expected = output_of_qemu(image);
  ASSERT_TRUE(expected.ends_with(last_line)) << expected;
  EXPECT_GT(expected.size(), 200U);
  EXPECT_EQ(output_of_cpu(image, ~std::uint64_t{0}), expected);
}

TEST(CrossCheck, ComputesTheSameBlockByBlock) {
  const std::string image = image_file("cpu_cross_check");
  EXPECT_EQ(output_of_cpu(image, 1), output_of_cpu(image, ~std::uint64_t{0}));
}

}  // namespace
}  // namespace proleg::sim
