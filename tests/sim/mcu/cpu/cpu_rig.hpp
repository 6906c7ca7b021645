#pragma once

// A CPU with minimal surroundings, and the programs of image/ for it.

#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <initializer_list>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sim/mcu/cpu/cpu.hpp"
#include "sim/mcu/cpu/elf_image.hpp"

namespace proleg::sim {

/// A file of the cross build; its name without ".elf".
[[nodiscard]] std::string image_file(std::string_view name);

class CpuRig final : public CpuSurroundings {
 public:
  struct Store {
    std::uint32_t address;
    unsigned size;
    std::uint32_t value;
    bool operator==(const Store&) const = default;
  };

  /// Words stored to this address are marks.
  static constexpr std::uint32_t mark_port = 0x4000'0000;
  static constexpr LocalTime period = Clocks::hsi;

  CpuRig();

  std::uint32_t load(std::uint32_t address, unsigned size) override;
  void store(std::uint32_t address, unsigned size, std::uint32_t value) override;
  bool store_to_flash(std::uint32_t address, unsigned size, std::uint32_t value) override;
  [[nodiscard]] LocalTime now() const override { return cpu.instructions() * core + slept; }
  [[nodiscard]] LocalTime core_period() const override { return core; }
  void reset_requested() override { ++resets; }

  /// Runs up to this number of instructions, time passing with them; while the CPU sleeps, up to the next SysTick.
  Cpu::State run(std::uint64_t instructions, std::uint64_t slice = ~std::uint64_t{0});

  [[nodiscard]] std::uint32_t word(std::uint32_t address) const;
  void set_word(std::uint32_t address, std::uint32_t value);
  [[nodiscard]] std::vector<std::uint32_t> take_marks() { return std::exchange(marks, {}); }

  std::vector<std::uint32_t> marks;
  std::vector<Store> stores;
  std::vector<Store> loads;
  std::map<std::uint32_t, std::uint32_t> registers;
  std::function<void(const Store&)> on_store = [](const Store&) {};
  std::function<bool(const Store&)> on_flash_store = [](const Store&) { return false; };
  LocalTime core = period;
  LocalTime slept = 0;
  int resets = 0;
  Cpu cpu;
};

/// Steps of a script; as in image/scripts.cpp.
namespace step {
struct Step {
  std::uint32_t action;
  std::uint32_t address;
  std::uint32_t value;
};
inline Step store(std::uint32_t address, std::uint32_t value) { return {1, address, value}; }
inline Step mark(std::uint32_t value) { return {2, 0, value}; }
inline Step mark_load(std::uint32_t address) { return {3, address, 0}; }
inline Step wait_for_interrupt() { return {4, 0, 0}; }
inline Step wait_for_event() { return {5, 0, 0}; }
inline Step send_event() { return {6, 0, 0}; }
inline Step supervisor_call() { return {7, 0, 0}; }
inline Step primask(std::uint32_t value) { return {8, 0, value}; }
inline Step faultmask(std::uint32_t value) { return {9, 0, value}; }
inline Step basepri(std::uint32_t value) { return {10, 0, value}; }
inline Step mark_basepri() { return {11, 0, 0}; }
inline Step mark_control() { return {12, 0, 0}; }
inline Step call(std::uint32_t address) { return {13, address, 0}; }
inline Step spin(std::uint32_t rounds) { return {14, 0, rounds}; }
}  // namespace step

/// In the vector table.
inline constexpr std::uint32_t initial_stack = 0x2002'0000;

/// Tests with the programs of image/.
class Programs : public testing::Test {
 protected:
  static const ElfImage& image();

  Programs();

  /// Restarts the CPU with a function as its program.
  void start(std::string_view function);
  /// Sets the vector of an exception.
  void set_vector(unsigned exception, std::string_view function);
  [[nodiscard]] static std::uint32_t address_of(std::string_view symbol) { return image().symbol(symbol).address; }
  /// What an exception's handler does, or thread mode (0); of scripted_handler and reset_handler.
  void script(unsigned exception, std::initializer_list<step::Step> steps);
  /// Starts the script of thread mode. Returns the marks.
  [[nodiscard]] std::vector<std::uint32_t> run_script(std::uint64_t instructions = 100'000);

  CpuRig rig_;
  Cpu& cpu_ = rig_.cpu;
};

/// Registers of the System Control Space.
namespace scs {
inline constexpr std::uint32_t syst_csr = 0xE000'E010;
inline constexpr std::uint32_t syst_rvr = 0xE000'E014;
inline constexpr std::uint32_t syst_cvr = 0xE000'E018;
inline constexpr std::uint32_t iser = 0xE000'E100;
inline constexpr std::uint32_t icer = 0xE000'E180;
inline constexpr std::uint32_t ispr = 0xE000'E200;
inline constexpr std::uint32_t icpr = 0xE000'E280;
inline constexpr std::uint32_t iabr = 0xE000'E300;
inline constexpr std::uint32_t ipr = 0xE000'E400;
inline constexpr std::uint32_t icsr = 0xE000'ED04;
inline constexpr std::uint32_t vtor = 0xE000'ED08;
inline constexpr std::uint32_t aircr = 0xE000'ED0C;
inline constexpr std::uint32_t scr = 0xE000'ED10;
inline constexpr std::uint32_t ccr = 0xE000'ED14;
inline constexpr std::uint32_t shpr1 = 0xE000'ED18;
inline constexpr std::uint32_t shpr2 = 0xE000'ED1C;
inline constexpr std::uint32_t shpr3 = 0xE000'ED20;
inline constexpr std::uint32_t shcsr = 0xE000'ED24;
inline constexpr std::uint32_t cfsr = 0xE000'ED28;
inline constexpr std::uint32_t hfsr = 0xE000'ED2C;
inline constexpr std::uint32_t bfar = 0xE000'ED38;
inline constexpr std::uint32_t stir = 0xE000'EF00;
}  // namespace scs

}  // namespace proleg::sim
