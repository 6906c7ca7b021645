#include "tests/sim/mcu/cpu/cpu_rig.hpp"

#include <algorithm>
#include <array>
#include <filesystem>

namespace proleg::sim {

std::string image_file(std::string_view name) {
  return std::string(PROLEG_CROSS_BUILD_DIR) + "/stm32f405/bin/" + std::string(name) + ".elf";
}

CpuRig::CpuRig() : cpu(*this) {}

std::uint32_t CpuRig::load(std::uint32_t address, unsigned size) {
  loads.push_back({address, size, 0});
  return registers[address];
}

void CpuRig::store(std::uint32_t address, unsigned size, std::uint32_t value) {
  stores.push_back({address, size, value});
  if (address == mark_port && size == 4) {
    marks.push_back(value);
  } else {
    registers[address] = value;
  }
  on_store(stores.back());
}

bool CpuRig::store_to_flash(std::uint32_t address, unsigned size, std::uint32_t value) {
  return on_flash_store({address, size, value});
}

Cpu::State CpuRig::run(std::uint64_t instructions, std::uint64_t slice) {
  const std::uint64_t end = cpu.instructions() + instructions;
  Cpu::State state = cpu.state();
  do {
    std::uint64_t most = std::min(slice, end - cpu.instructions());
    const LocalTime tick = cpu.next_system_tick();
    if (tick != never_on_chip) {
      if (tick <= now()) {
        cpu.advance_system_tick();
        continue;
      }
      most = std::min(most, (tick - now() + core - 1) / core);
    }
    state = cpu.run(most);
    if (state == Cpu::State::sleeping) {
      if (cpu.next_system_tick() == never_on_chip || slept > LocalTime{1'000'000'000}) {
        return state;
      }
      slept += std::max(cpu.next_system_tick(), now()) - now();
      cpu.advance_system_tick();
    } else if (state != Cpu::State::running) {
      return state;
    }
  } while (cpu.instructions() < end);
  return state;
}

std::uint32_t CpuRig::word(std::uint32_t address) const {
  std::array<std::uint8_t, 4> bytes{};
  cpu.read(address, bytes);
  return bytes[0] | std::uint32_t{bytes[1]} << 8U | std::uint32_t{bytes[2]} << 16U | std::uint32_t{bytes[3]} << 24U;
}

void CpuRig::set_word(std::uint32_t address, std::uint32_t value) {
  const std::array<std::uint8_t, 4> bytes{
      static_cast<std::uint8_t>(value & 0xFFU), static_cast<std::uint8_t>(value >> 8U & 0xFFU),
      static_cast<std::uint8_t>(value >> 16U & 0xFFU), static_cast<std::uint8_t>(value >> 24U)};
  cpu.write(address, bytes);
}

const ElfImage& Programs::image() {
  static const ElfImage image(image_file("cpu_programs"));
  return image;
}

Programs::Programs() {
  for (const ElfImage::Segment& segment : image().segments()) {
    cpu_.write(segment.load_address, segment.bytes);
  }
  rig_.set_word(ChipMemory::flash_start, initial_stack);
  const ElfImage::Symbol& scripts = image().symbol("scripts");
  cpu_.write(scripts.address, std::vector<std::uint8_t>(scripts.size));
}

void Programs::start(std::string_view function) {
  set_vector(1, function);
  cpu_.reset();
}

void Programs::set_vector(unsigned exception, std::string_view function) {
  rig_.set_word(ChipMemory::flash_start + 4 * exception, address_of(function) | 1U);
}

void Programs::script(unsigned exception, std::initializer_list<step::Step> steps) {
  constexpr unsigned max_steps = 12;
  ASSERT_LE(steps.size(), max_steps);
  std::uint32_t address = address_of("scripts") + exception * max_steps * 12;
  cpu_.write(address, std::vector<std::uint8_t>(max_steps * 12));
  for (const step::Step& step : steps) {
    rig_.set_word(address, step.action);
    rig_.set_word(address + 4, step.address);
    rig_.set_word(address + 8, step.value);
    address += 12;
  }
}

std::vector<std::uint32_t> Programs::run_script(std::uint64_t instructions) {
  start("reset_handler");
  rig_.run(instructions);
  return rig_.take_marks();
}

}  // namespace proleg::sim
