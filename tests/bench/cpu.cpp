// Prints the costs of the virtual CPU: opening, a wake-up by an interrupt, and plain code.

#include <cstdint>
#include <cstdio>
#include <ctime>
#include <exception>
#include <functional>
#include <memory>
#include <string_view>
#include <vector>

#include "sim/mcu/cpu/cpu.hpp"
#include "sim/mcu/cpu/elf_image.hpp"

namespace proleg::sim {
namespace {

/// The interrupt that the program `sleeps` enables.
constexpr unsigned interrupt = 3;

class EmptySurroundings final : public CpuSurroundings {
 public:
  std::uint32_t load(std::uint32_t /*address*/, unsigned /*size*/) override { return 0; }
  void store(std::uint32_t /*address*/, unsigned /*size*/, std::uint32_t /*value*/) override {}
  bool store_to_flash(std::uint32_t /*address*/, unsigned /*size*/, std::uint32_t /*value*/) override { return false; }
  [[nodiscard]] LocalTime now() const override { return 0; }
  [[nodiscard]] LocalTime core_period() const override { return Clocks::hsi; }
  void reset_requested() override {}
};

/// Processor time of the work, so other programs do not affect it.
double seconds_of(const std::function<void()>& work) {
  const std::clock_t start = std::clock();
  work();
  return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

void set_word(Cpu& cpu, std::uint32_t address, std::uint32_t value) {
  std::vector<std::uint8_t> bytes;
  for (unsigned i = 0; i < 4; ++i) {
    bytes.push_back(static_cast<std::uint8_t>(value >> 8U * i & 0xFFU));
  }
  cpu.write(address, bytes);
}

void load(Cpu& cpu, const ElfImage& image, std::string_view program, std::string_view handler) {
  for (const ElfImage::Segment& segment : image.segments()) {
    cpu.write(segment.load_address, segment.bytes);
  }
  constexpr std::uint32_t first_interrupt = 16;
  set_word(cpu, ChipMemory::flash_start + 4, image.symbol(program).address | 1U);
  set_word(cpu, ChipMemory::flash_start + 4 * (first_interrupt + interrupt), image.symbol(handler).address | 1U);
  cpu.reset();
}

void print_wake_ups(const ElfImage& image, std::string_view handler) {
  constexpr int wake_ups = 200'000;
  constexpr std::size_t cpu_count = 20;
  EmptySurroundings surroundings;
  std::vector<std::unique_ptr<Cpu>> cpus;
  for (std::size_t i = 0; i < cpu_count; ++i) {
    cpus.push_back(std::make_unique<Cpu>(surroundings));
    load(*cpus.back(), image, "sleeps", handler);
    cpus.back()->run(1000);
  }
  std::uint64_t before = 0;
  for (const auto& cpu : cpus) {
    before += cpu->instructions();
  }
  const double seconds = seconds_of([&] {
    for (int i = 0; i < wake_ups; ++i) {
      Cpu& cpu = *cpus[static_cast<std::size_t>(i) % cpu_count];
      cpu.set_interrupt(interrupt, true);
      cpu.set_interrupt(interrupt, false);
      cpu.run(100'000);
    }
  });
  std::uint64_t after = 0;
  for (const auto& cpu : cpus) {
    after += cpu->instructions();
  }
  std::printf("%zu CPUs, %.0f instructions a wake-up: %.2f us, %.0f wake-ups/s\n", cpu_count,
              static_cast<double>(after - before) / wake_ups, 1e6 * seconds / wake_ups, wake_ups / seconds);
}

void print_figures() {
  const ElfImage image(PROLEG_CROSS_BUILD_DIR "/stm32f405/bin/cpu_programs.elf");
  EmptySurroundings surroundings;
  constexpr int openings = 20;
  const double opening = seconds_of([&] {
    for (int i = 0; i < openings; ++i) {
      Cpu cpu(surroundings);
      load(cpu, image, "compute_loop", "short_handler");
      cpu.run(100);
    }
  });
  std::printf("open, load, run and close: %.1f ms\n", 1e3 * opening / openings);
  print_wake_ups(image, "short_handler");
  print_wake_ups(image, "benchmark_handler");

  Cpu cpu(surroundings);
  load(cpu, image, "compute_loop", "short_handler");
  cpu.run(1000);
  constexpr std::uint64_t instructions = 100'000'000;
  const double computing = seconds_of([&] { cpu.run(instructions); });
  std::printf("plain code with loads and stores: %.0f million instructions/s\n", instructions / computing / 1e6);
}

}  // namespace
}  // namespace proleg::sim

int main() {
  try {
    proleg::sim::print_figures();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
  return 0;
}
