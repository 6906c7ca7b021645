#pragma once

// A robot whose modules are virtual chips, for tests.

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "shipped.hpp"
#include "sim/hardware_loop/hardware_loop.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/mcu/module/virtual_module.hpp"

namespace proleg::sim {

/// The image that is flashed, as the preset stm32f405 builds it.
inline const FirmwareImage& flashed_image() {
  static const FirmwareImage image(PROLEG_IMAGE);
  return image;
}

class VirtualRobot {
 public:
  using Choice = std::function<bool(unsigned joint)>;

  static bool all(unsigned /*joint*/) { return true; }

  /// is_virtual: which joints have a virtual chip; the others are native. flash, board: as VirtualModuleOptions.
  explicit VirtualRobot(Scenario scenario, HardwareOptions options = {}, Choice is_virtual = all,
                        const FlashContents* flash = nullptr, const FirmwareImage& image = flashed_image(),
                        const stm32f405::BoardProfile* board = nullptr)
      : scenario_(std::move(scenario)), modules_(scenario_.robot.joints.size()) {
    options.notice = [this](const std::string& text) { notices.push_back(text); };
    options.on_frame = [this, on_frame = options.on_frame](const Transmission& transmission) {
      now_ = transmission.end;
      if (on_frame) {
        on_frame(transmission);
      }
    };
    options.make_module = [this, is_virtual, flash, &image,
                           board](const ModuleParts& parts) -> std::unique_ptr<JointModule> {
      if (!is_virtual(parts.joint)) {
        return nullptr;
      }
      VirtualModuleOptions module_options;
      module_options.flash = flash;
      module_options.board = board;
      module_options.console = [this, joint = parts.joint](const std::string& line) {
        console.emplace_back(joint, line);
      };
      module_options.on_tick = [this](const TickCost& cost) { costs.push_back(cost); };
      auto module = std::make_unique<VirtualModule>(parts, image, std::move(module_options));
      modules_[parts.joint] = module.get();
      return module;
    };
    loop_ = std::make_unique<HardwareLoop>(scenario_, std::move(options));
  }

  void run_to(std::uint32_t tick) {
    while (loop_->tick() < tick) {
      loop_->advance();
      for (const auto& event : loop_->restart_events()) {
        (event.joined ? joined : stopped).emplace_back(event.joint, loop_->tick() - 1);
      }
    }
  }

  [[nodiscard]] HardwareLoop& loop() { return *loop_; }
  [[nodiscard]] VirtualModule& module(unsigned joint) { return *modules_[joint]; }
  [[nodiscard]] const Scenario& scenario() const { return scenario_; }
  /// The end of the last frame.
  [[nodiscard]] BusTime now() const { return now_; }

  /// Whether a notice contains this.
  [[nodiscard]] bool was_noticed(const std::string& words) const {
    return std::ranges::any_of(notices, [&](const std::string& text) { return text.find(words) != std::string::npos; });
  }

  std::vector<std::string> notices;
  std::vector<std::pair<unsigned, std::string>> console;
  std::vector<TickCost> costs;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> stopped;  ///< joint, tick
  std::vector<std::pair<std::uint32_t, std::uint32_t>> joined;

 private:
  Scenario scenario_;
  std::vector<VirtualModule*> modules_;
  BusTime now_ = 0;
  std::unique_ptr<HardwareLoop> loop_;
};

}  // namespace proleg::sim
