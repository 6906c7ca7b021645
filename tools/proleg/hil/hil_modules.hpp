#pragma once

// The modules of `proleg hil`, which run on this computer or on virtual chips.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "shared/computer/output/output.hpp"
#include "sim/hardware_loop/hardware_loop.hpp"
#include "sim/mcu/module/flashed_chip.hpp"
#include "tools/proleg/common/command_line.hpp"

namespace proleg::tools {

class Debugger;

struct ModuleOptions {
  std::string modules = "native";
  std::optional<std::string> image;
  std::vector<std::string> consoles;
  std::vector<std::string> traces;
  std::optional<std::string> gdb;
  std::optional<std::string> threads;
};

void add_module_options(CommandLine& command_line, ModuleOptions& options);

class HilModules {
 public:
  /// Reads the image if a module needs it. Throws InputError and BadInput. scenario must outlive this object.
  HilModules(const ModuleOptions& options, const sim::Scenario& scenario);
  ~HilModules();
  HilModules(const HilModules&) = delete;
  HilModules& operator=(const HilModules&) = delete;

  /// The files of --trace, for check_outputs().
  [[nodiscard]] std::vector<PlannedOutput> planned_traces() const;
  /// Opens the files of --trace. Throws BadInput.
  void open_traces();
  /// Flashes the virtual modules; must be called before make(). One chip is flashed through its bootloader, and all
  /// modules get the contents of its flash. The first make() prints a line with the name of this program. Throws
  /// BadInput if the bootloader is missing or refuses the image, and std::runtime_error if the program does not run.
  void flash(const std::string& program);
  /// For HardwareOptions::threads: --threads, by default a thread for each core; 1 without virtual modules.
  [[nodiscard]] unsigned threads() const { return threads_; }
  /// Start time of a chip, for HardwareOptions::start_time_us: native modules then start as virtual ones do.
  [[nodiscard]] std::uint32_t start_time_us() const;
  /// Makes a module, for HardwareOptions::make_module; this object must outlive the loop.
  [[nodiscard]] std::unique_ptr<sim::JointModule> make(const sim::ModuleParts& parts);
  [[nodiscard]] bool is_virtual(unsigned joint) const { return virtual_joints_[joint]; }
  [[nodiscard]] bool any_virtual() const { return image_.has_value(); }
  /// Text of the kinds of modules: "native", "mcu" or "native and mcu (1, 3)".
  [[nodiscard]] std::string kind() const;
  [[nodiscard]] const sim::FirmwareImage& image() const { return *image_; }

  struct CostliestTick {
    std::uint8_t node;
    sim::TickCost cost;
  };
  /// The costliest tick of all virtual modules. Call this before the loop is destroyed.
  [[nodiscard]] std::optional<CostliestTick> costliest_tick() const;
  /// Closes the traces after the run. Throws std::runtime_error if one could not be written.
  void finish();

 private:
  struct InstructionTrace;

  [[nodiscard]] unsigned joint_of(const std::string& option, const std::string& argument) const;
  [[nodiscard]] unsigned virtual_joint_of(const std::string& option, const std::string& argument) const;
  void parse_modules(const std::string& argument);
  void parse_traces(const std::vector<std::string>& arguments);

  const sim::Scenario& scenario_;
  std::vector<bool> virtual_joints_;  ///< whether each joint's module is virtual
  std::vector<bool> consoles_;
  std::vector<std::unique_ptr<InstructionTrace>> traces_;  ///< traces by joint; null for none
  std::optional<sim::FirmwareImage> image_;
  std::optional<sim::FlashedChip> flashed_;
  std::string flash_report_;                  ///< report that is not printed yet
  std::vector<sim::VirtualModule*> modules_;  ///< modules by joint; null for a native one
  std::unique_ptr<Debugger> debugger_;
  unsigned threads_ = 1;
};

}  // namespace proleg::tools
