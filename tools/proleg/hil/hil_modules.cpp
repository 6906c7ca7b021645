#include "tools/proleg/hil/hil_modules.hpp"

#include <algorithm>
#include <chrono>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <sstream>
#include <stdexcept>
#include <thread>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/hardware_loop/module_rack.hpp"
#include "sim/hardware_loop/native_program.hpp"
#include "sim/mcu/chip/stm32f405.hpp"
#include "sim/mcu/debug/gdb_server.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/installation.hpp"
#include "tools/proleg/common/scenario_run.hpp"

namespace proleg::tools {
namespace {

namespace fs = std::filesystem;
using DebugEvent = sim::Stm32f405::DebugEvent;

constexpr const char* trace_title = "node\ttick\tto_state_frame\twhole_tick\n";

fs::path default_image() { return image_folder() / "proleg_stm32f405.elf"; }

fs::path bootloader_beside(const fs::path& image) {
  fs::path file = image.parent_path() / "proleg_boot_stm32f405.elf";
  if (!fs::exists(file)) {
    throw BadInput(file.string() +
                   ": found no bootloader, expected it beside the image; 'cmake --preset stm32f405 && cmake --build "
                   "--preset stm32f405' builds both");
  }
  return file;
}

sim::FirmwareImage read_image(const std::optional<std::string>& name) {
  const fs::path file = name ? fs::path(*name) : default_image();
  if (!name && !fs::exists(file)) {
    throw BadInput(file.string() +
                   ": found no image, expected one; build it with 'cmake --preset stm32f405 && cmake --build --preset "
                   "stm32f405', or give --image ELF");
  }
  try {
    return sim::FirmwareImage(file);
  } catch (const sim::ElfError& error) {
    throw BadInput(error.what());
  }
}

}  // namespace

/// Attaches gdb to one virtual module of `proleg hil`. While the program is stopped, the simulation is stopped too.
class Debugger {
 public:
  /// Keeps the arguments; attach() opens the port.
  Debugger(std::uint16_t port, unsigned joint, std::filesystem::path image);

  [[nodiscard]] unsigned joint() const { return joint_; }
  /// Opens the port and waits until gdb connects or the user interrupts. The program then stops at its first
  /// instruction. Throws std::runtime_error if the port is not free.
  void attach(sim::Stm32f405& chip);

 private:
  /// Handles an event. Returns true to execute a single step. Throws std::runtime_error if gdb ended the program.
  [[nodiscard]] bool on_debug_event(DebugEvent event);

  std::uint16_t port_;
  unsigned joint_;
  std::filesystem::path image_;
  std::optional<sim::CpuTarget> target_;
  std::optional<sim::GdbServer> server_;
  bool must_stop_first_ = false;  ///< gdb has connected and has not seen the first stop yet
  std::chrono::steady_clock::time_point last_poll_;
};

Debugger::Debugger(std::uint16_t port, unsigned joint, std::filesystem::path image)
    : port_(port), joint_(joint), image_(std::move(image)) {}

void Debugger::attach(sim::Stm32f405& chip) {
  target_.emplace(chip.cpu());
  server_.emplace(port_, *target_);
  std::cerr << "proleg hil: waits for: gdb-multiarch " << image_.string() << " -ex 'target remote :" << server_->port()
            << "'\n";
  must_stop_first_ = server_->wait_for_client(interrupted);
  chip.set_debug_hook([this](DebugEvent event) { return on_debug_event(event); });
}

bool Debugger::on_debug_event(DebugEvent event) {
  sim::StopReason reason{};
  switch (event) {
    case DebugEvent::about_to_run: {
      constexpr std::chrono::milliseconds poll_period(5);
      const auto now = std::chrono::steady_clock::now();
      if (must_stop_first_) {
        must_stop_first_ = false;
        reason = sim::StopReason::attached;
      } else if (now - last_poll_ >= poll_period) {
        last_poll_ = now;
        if (!server_->interrupt_requested()) {
          return false;
        }
        reason = sim::StopReason::interrupt;
      } else {
        return false;
      }
      break;
    }
    case DebugEvent::breakpoint:
      reason = sim::StopReason::breakpoint;
      break;
    case DebugEvent::step:
      reason = sim::StopReason::step;
      break;
    case DebugEvent::fault:
      reason = sim::StopReason::fault;
      break;
  }
  switch (server_->serve(reason, interrupted)) {
    case sim::Resume::step:
      return true;
    case sim::Resume::kill:
      throw std::runtime_error("gdb ended the program");
    default:
      return false;
  }
}

/// The table of a module's instruction counts, in a file or on standard error.
struct HilModules::InstructionTrace {
  unsigned node = 0;
  std::string file;
  std::ofstream stream;

  [[nodiscard]] std::ostream& out() { return file.empty() ? std::cerr : stream; }
};

void add_module_options(CommandLine& command_line, ModuleOptions& options) {
  command_line
      .add_option(
          "--modules", options.modules,
          "what runs the program of the modules. native: this computer; mcu: a virtual STM32F405 for each module, "
          "with the image that is flashed; 1,3=mcu: a virtual chip for nodes 1 and 3, the others native")
      .shows_default();
  command_line.add_option("--image", options.image,
                          "ELF: use this image instead of the one that the preset stm32f405 builds");
  command_line.add_option("--uart", options.consoles,
                          "NODE: show the console of a virtual module on standard error. May be repeated.");
  command_line.add_option(
      "--trace", options.traces,
      "NODE or NODE=FILE: print a table of the instructions that a virtual module executes in each tick, on "
      "standard error or in a file. May be repeated.");
  command_line.add_option(
      "--gdb", options.gdb,
      "PORT or NODE:PORT: wait until gdb-multiarch attaches to a virtual module (by default the first) with "
      "'target remote :PORT'. While the program is stopped, so is the simulation.");
  command_line.add_option("--threads", options.threads,
                          "N: run the virtual modules on N threads; by default one for each core. The result is the "
                          "same with any number.");
}

HilModules::HilModules(const ModuleOptions& options, const sim::Scenario& scenario)
    : scenario_(scenario),
      virtual_joints_(scenario.modules.size()),
      consoles_(scenario.modules.size()),
      traces_(scenario.modules.size()),
      modules_(scenario.modules.size()) {
  parse_modules(options.modules);
  for (const std::string& argument : options.consoles) {
    consoles_[virtual_joint_of("--uart", argument)] = true;
  }
  if (std::ranges::find(virtual_joints_, true) != virtual_joints_.end()) {
    image_.emplace(read_image(options.image));
  } else if (options.image) {
    throw InputError("--image", 0, "no module that runs the image", "--modules mcu");
  }
  if (image_) {
    threads_ = std::max(std::thread::hardware_concurrency(), 1U);
  }
  if (options.threads) {
    const auto threads = parse_whole<std::uint8_t>(*options.threads);
    if (!threads || *threads == 0) {
      throw InputError("--threads", 0, in_quotes(*options.threads), "a number of threads from 1 to 255");
    }
    if (!image_) {
      throw InputError("--threads", 0, "no virtual module", "--modules mcu");
    }
    threads_ = *threads;
  }
  if (options.gdb) {
    const std::size_t colon = options.gdb->find(':');
    const auto port =
        parse_whole<std::uint16_t>(std::string_view(*options.gdb).substr(colon == std::string::npos ? 0 : colon + 1));
    if (!port || *port == 0) {
      throw InputError("--gdb", 0, in_quotes(*options.gdb), "PORT or NODE:PORT, with a port from 1 to 65535");
    }
    if (!image_) {
      throw InputError("--gdb", 0, "no virtual module", "--modules mcu");
    }
    const auto first = std::ranges::find(virtual_joints_, true) - virtual_joints_.begin();
    const unsigned joint = colon == std::string::npos ? static_cast<unsigned>(first)
                                                      : virtual_joint_of("--gdb", options.gdb->substr(0, colon));
    debugger_ = std::make_unique<Debugger>(*port, joint, image_->file());
  }
  parse_traces(options.traces);
}

HilModules::~HilModules() = default;

void HilModules::parse_modules(const std::string& argument) {
  constexpr std::string_view suffix = "=mcu";
  if (argument == "native") {
    return;
  }
  if (argument == "mcu") {
    virtual_joints_.assign(virtual_joints_.size(), true);
    return;
  }
  if (!argument.ends_with(suffix)) {
    throw InputError("--modules", 0, in_quotes(argument),
                     "native, mcu, or a list of nodes with =mcu, for example 1,3=mcu");
  }
  std::string_view rest = std::string_view(argument).substr(0, argument.size() - suffix.size());
  for (bool more = true; more;) {
    const std::size_t comma = rest.find(',');
    virtual_joints_[joint_of("--modules", std::string(rest.substr(0, comma)))] = true;
    more = comma != std::string_view::npos;
    rest = more ? rest.substr(comma + 1) : rest;
  }
}

unsigned HilModules::joint_of(const std::string& option, const std::string& argument) const {
  return joint_of_node(scenario_, parse_whole<std::uint32_t>(argument), option, in_quotes(argument));
}

unsigned HilModules::virtual_joint_of(const std::string& option, const std::string& argument) const {
  const unsigned joint = joint_of(option, argument);
  if (!is_virtual(joint)) {
    throw InputError(option, 0, "node " + argument + ", which is native", "a virtual module (--modules mcu)");
  }
  return joint;
}

void HilModules::parse_traces(const std::vector<std::string>& arguments) {
  for (const std::string& argument : arguments) {
    const std::size_t equal = argument.find('=');
    const unsigned joint = virtual_joint_of("--trace", argument.substr(0, equal));
    if (traces_[joint]) {
      throw InputError("--trace", 0, "node " + argument.substr(0, equal) + " twice", "each node at most once");
    }
    traces_[joint] = std::make_unique<InstructionTrace>();
    traces_[joint]->node = scenario_.modules[joint].node;
    if (equal != std::string::npos) {
      traces_[joint]->file = argument.substr(equal + 1);
      if (traces_[joint]->file.empty()) {
        throw InputError("--trace", 0, in_quotes(argument), "NODE or NODE=FILE");
      }
    }
  }
}

std::vector<PlannedOutput> HilModules::planned_traces() const {
  std::vector<PlannedOutput> outputs;
  for (const auto& trace : traces_) {
    if (trace && !trace->file.empty()) {
      outputs.push_back({"--trace", trace->file, "trace", starts_with(trace_title)});
    }
  }
  return outputs;
}

void HilModules::open_traces() {
  bool has_title = false;
  for (const auto& trace : traces_) {
    if (!trace) {
      continue;
    }
    if (!trace->file.empty()) {
      trace->stream.open(trace->file);
      if (!trace->stream) {
        throw BadInput("--trace: found " + in_quotes(trace->file) + ", expected a file that can be written");
      }
    }
    if (!trace->file.empty() || !has_title) {
      trace->out() << trace_title;
      has_title = has_title || trace->file.empty();
    }
  }
}

void HilModules::flash(const std::string& program) {
  if (!image_) {
    return;
  }
  const auto count = std::ranges::count(virtual_joints_, true);
  const auto first = std::ranges::find(virtual_joints_, true) - virtual_joints_.begin();
  try {
    flashed_ = sim::flash_chip(*image_, bootloader_beside(image_->file()),
                               sim::make_identity(scenario_, static_cast<std::size_t>(first)).unique_id);
  } catch (const sim::ElfError& error) {
    throw BadInput(error.what());
  }
  for (const std::string& problem : flashed_->problems) {
    std::cerr << program << ": while the chip was flashed: " << problem << '\n';
  }
  if (flashed_->start_time) {
    std::ostringstream line;
    line << program << ": flashed a chip through its bootloader, " << flashed_->image_size << " bytes in " << std::fixed
         << std::setprecision(1) << static_cast<double>(flashed_->flash_time) * 1e-9 << " s of its time; " << count
         << (count == 1 ? " module starts" : " modules start") << " with its flash\n";
    flash_report_ = line.str();
  } else if (debugger_ == nullptr) {
    throw std::runtime_error(image_->file().string() +
                             ": flashed, found a program that did not confirm itself, expected that it runs for half a "
                             "second; --gdb runs it nevertheless");
  }
}

std::uint32_t HilModules::start_time_us() const {
  constexpr sim::BusTime ns_per_us = 1'000;
  return flashed_ && flashed_->start_time ? static_cast<std::uint32_t>(*flashed_->start_time / ns_per_us)
                                          : static_cast<std::uint32_t>(sim::NativeProgram::start_time_us);
}

std::unique_ptr<sim::JointModule> HilModules::make(const sim::ModuleParts& parts) {
  const unsigned joint = parts.joint;
  if (!is_virtual(joint)) {
    return nullptr;
  }
  std::cerr << std::exchange(flash_report_, {});
  sim::VirtualModuleOptions options;
  options.flash = &flashed_.value().flash;
  if (consoles_[joint]) {
    options.console = [node = parts.identity.node](const std::string& line) {
      std::cerr << "node " << unsigned{node} << ": " << line << '\n';
    };
  }
  if (traces_[joint]) {
    options.on_tick = [trace = traces_[joint].get()](const sim::TickCost& cost) {
      trace->out() << trace->node << '\t' << cost.tick << '\t' << cost.to_state_frame << '\t' << cost.whole << '\n';
    };
  }
  auto module = std::make_unique<sim::VirtualModule>(parts, *image_, std::move(options));
  modules_[joint] = module.get();
  if (debugger_ && debugger_->joint() == joint) {
    debugger_->attach(module->chip());
  }
  return module;
}

std::string HilModules::kind() const {
  std::string nodes;
  for (unsigned joint = 0; joint < virtual_joints_.size(); ++joint) {
    if (is_virtual(joint)) {
      nodes += (nodes.empty() ? "" : ", ") + std::to_string(scenario_.modules[joint].node);
    }
  }
  if (nodes.empty()) {
    return "native";
  }
  return std::ranges::find(virtual_joints_, false) == virtual_joints_.end() ? "mcu" : "native and mcu (" + nodes + ")";
}

std::optional<HilModules::CostliestTick> HilModules::costliest_tick() const {
  std::optional<CostliestTick> worst;
  for (unsigned joint = 0; joint < modules_.size(); ++joint) {
    if (modules_[joint] != nullptr &&
        (!worst || modules_[joint]->worst_tick().to_state_frame > worst->cost.to_state_frame)) {
      worst = {scenario_.modules[joint].node, modules_[joint]->worst_tick()};
    }
  }
  return worst;
}

void HilModules::finish() {
  for (const auto& trace : traces_) {
    if (trace && !trace->file.empty()) {
      trace->stream.close();
      if (!trace->stream) {
        throw std::runtime_error(trace->file + ": cannot write the end of the table");
      }
    }
  }
}

}  // namespace proleg::tools
