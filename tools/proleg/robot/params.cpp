// proleg params: the settings of modules in a text file.

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

#include "host/robot/parameter_file.hpp"
#include "shared/canopen/object_name.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/output/output.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/kernel/kernel_configuration.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/common/json_output.hpp"
#include "tools/proleg/robot/bus_access.hpp"

namespace {

using namespace proleg;
using namespace proleg::tools;

struct ParamsOptions : BusOptions {
  std::string action;
  std::string file;
  std::string nodes = "all";
  bool store = false;
  bool any_module = false;
  bool json = false;
};

std::string read_file(const std::string& name) {
  if (std::filesystem::is_directory(name)) {
    throw InputError(name, 0, "a folder", "a file of 'proleg params save'");
  }
  std::ifstream stream(name, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(stream), {}};
  if (!stream && !stream.eof()) {
    throw InputError(name, 0, "no file that can be read", "a file of 'proleg params save'");
  }
  return text;
}

/// The transfers of one command; a failure of any of them ends it.
class Modules {
 public:
  explicit Modules(BusAccess& bus) : bus_(bus), queue_(bus.connection(), patient_transfers()) {}

  [[nodiscard]] host::ModuleParameters read(std::uint8_t node) {
    host::ModuleParameters module;
    module.node = node;
    std::vector<std::uint8_t> algorithms(max_slots);
    read_number(node, canopen::object::serial, [&](std::uint32_t number) { module.serial = number; });
    read_number(node, canopen::object::core_fingerprint,
                [&](std::uint32_t number) { module.core_fingerprint = number; });
    for (unsigned slot = 0; slot < max_slots; ++slot) {
      canopen::Object object = canopen::object::slot_algorithm.first;
      object.address = canopen::object::slot_algorithm.address(slot);
      read_number(node, object,
                  [&algorithms, slot](std::uint32_t number) { algorithms[slot] = static_cast<std::uint8_t>(number); });
    }
    wait();
    for (const canopen::Object& object : host::setting_objects(algorithms)) {
      queue_.read(node, object.address, [this, &module, object](const host::SdoResult& result) {
        if (check(module.node, object, result)) {
          module.values.push_back({object, result.value});
        }
      });
    }
    wait();
    return module;
  }

  void write(std::uint8_t node, const host::ParameterValue& value) {
    queue_.write(node, value.object.address, value.bytes,
                 [this, node, object = value.object](const host::SdoResult& result) {
                   static_cast<void>(check(node, object, result));
                 });
  }
  void store(std::uint8_t node) {
    constexpr std::uint32_t save_signature = 0x65766173;
    const canopen::Object& object = canopen::object::store_parameters;
    queue_.write(node, object.address, object.type, save_signature, [this, node](const host::SdoResult& result) {
      static_cast<void>(check(node, canopen::object::store_parameters, result));
    });
  }
  /// Throws std::runtime_error with the first failure.
  void wait() {
    finish(bus_, queue_);
    if (!failure_.empty()) {
      throw std::runtime_error(failure_);
    }
  }

 private:
  template <typename Take>
  void read_number(std::uint8_t node, const canopen::Object& object, Take take) {
    queue_.read(node, object.address, [this, node, object, take](const host::SdoResult& result) {
      if (check(node, object, result)) {
        take(result.number());
      }
    });
  }
  bool check(std::uint8_t node, const canopen::Object& object, const host::SdoResult& result) {
    if (!result.is_good() && failure_.empty()) {
      const std::string name(canopen::entry_name(object.address).view());
      failure_ = failure_text(node, host::address_text(object.address) + " (" + name + ")", result.abort_code,
                              bus_.connection().diagnosis());
    }
    return result.is_good();
  }

  BusAccess& bus_;
  host::SdoQueue queue_;
  std::string failure_;
};

struct Difference {
  const host::ModuleParameters* wanted;
  host::ParameterValue value;
  std::string found;
};

struct Comparison {
  std::vector<Difference> differences;
  std::vector<std::string> other_modules;  ///< a line for each node with another serial number than in the file
  /// Nodes whose module does not have the gait of the file now, so that it has no such parameters.
  std::vector<std::string> without_gait;

  [[nodiscard]] std::size_t count() const { return differences.size() + other_modules.size(); }
};

/// The values of the file that the modules do not have. Throws std::runtime_error if a module cannot take the file.
Comparison compare(const std::vector<host::ModuleParameters>& file, Modules& modules) {
  Comparison comparison;
  for (const host::ModuleParameters& wanted : file) {
    const host::ModuleParameters found = modules.read(wanted.node);
    const std::string node = std::to_string(wanted.node);
    bool has_gait = true;
    if (found.core_fingerprint != wanted.core_fingerprint) {
      throw std::runtime_error(
          "node " + std::to_string(wanted.node) + ": found core " + hexadecimal(found.core_fingerprint, 8) +
          ", expected " + hexadecimal(wanted.core_fingerprint, 8) + " as in the file: the file is of another firmware");
    }
    if (found.serial != wanted.serial) {
      comparison.other_modules.push_back("node " + node + ": found the serial number " + hexadecimal(found.serial, 8) +
                                         ", the file has " + hexadecimal(wanted.serial, 8));
    }
    for (const host::ParameterValue& value : wanted.values) {
      const auto same = std::ranges::find(found.values, value.object.address,
                                          [](const host::ParameterValue& one) { return one.object.address; });
      if (same == found.values.end()) {
        has_gait = false;  // only parameters of algorithms are not there always
      } else if (same->bytes != value.bytes) {
        comparison.differences.push_back({&wanted, value, host::value_text(same->object, same->bytes)});
      }
    }
    if (!has_gait) {
      comparison.without_gait.push_back(node);
    }
  }
  return comparison;
}

std::string entry_text(const Difference& difference) {
  return std::string(canopen::entry_name(difference.value.object.address).view());
}

std::string wanted_text(const Difference& difference) {
  return host::value_text(difference.value.object, difference.value.bytes);
}

Json list_of(const std::vector<std::string>& texts) {
  Json list = Json::empty_array();
  for (const std::string& text : texts) {
    list.append(text);
  }
  return list;
}

/// What was written into modules.
struct Written {
  std::size_t changed = 0;  ///< values
  bool is_stored = false;
};

void print_json(const ParamsOptions& options, const std::vector<host::ModuleParameters>& file,
                const Comparison& comparison, const Written& written) {
  Json modules = Json::empty_array();
  for (const host::ModuleParameters& module : file) {
    modules.append(unsigned{module.node});
  }
  Json differences = Json::empty_array();
  for (const Difference& difference : comparison.differences) {
    differences.append({{"node", unsigned{difference.wanted->node}},
                        {"object", host::address_text(difference.value.object.address)},
                        {"name", entry_text(difference)},
                        {"found", difference.found},
                        {"wanted", wanted_text(difference)}});
  }
  std::cout << Json{{"file", options.file},
                    {"modules", modules},
                    {"differences", differences},
                    {"other_modules", list_of(comparison.other_modules)},
                    {"without_gait", list_of(comparison.without_gait)},
                    {"changed", written.changed},
                    {"stored", written.is_stored}}
                   .text()
            << '\n';
}

int save(const ParamsOptions& options, BusAccess& bus) {
  Modules modules(bus);
  std::vector<host::ModuleParameters> all;
  for (const std::uint8_t node : nodes_of(bus, options.nodes)) {
    all.push_back(modules.read(node));
  }
  write_file(options.file, host::parameters_text(all));
  if (options.json) {
    print_json(options, all, {}, {});
  } else {
    std::cout << "saved the settings of " << all.size() << " modules in " << options.file << '\n';
  }
  return exit_success;
}

void print_without_gait(const Comparison& comparison) {
  if (!comparison.without_gait.empty()) {
    std::cout << "not compared: the parameters of the gait, which node"
              << (comparison.without_gait.size() == 1 ? " " : "s ") << listed(comparison.without_gait)
              << (comparison.without_gait.size() == 1 ? " does" : " do")
              << " not have now; 'proleg drive' writes those of its scenario\n";
  }
}

int load(const ParamsOptions& options, const std::vector<host::ModuleParameters>& file, BusAccess& bus) {
  require_no_host(bus);
  Modules modules(bus);
  const Comparison comparison = compare(file, modules);
  if (!comparison.other_modules.empty() && !options.any_module) {
    throw std::runtime_error(comparison.other_modules.front() +
                             ": the file is of another module, whose potentiometer and limits it has; nothing was "
                             "written (--any-module writes them all the same)");
  }
  for (const Difference& difference : comparison.differences) {
    modules.write(difference.wanted->node, difference.value);
  }
  modules.wait();
  if (options.store) {
    for (const host::ModuleParameters& module : file) {
      modules.store(module.node);
    }
    modules.wait();
  }
  if (options.json) {
    print_json(options, file, comparison, {comparison.differences.size(), options.store});
    return exit_success;
  }
  print_without_gait(comparison);
  std::cout << "changed " << comparison.differences.size() << " values of " << file.size() << " modules"
            << (options.store ? ", and stored them" : "; they are lost at the next reset, unless --store is given")
            << '\n';
  return exit_success;
}

void print_differences(const Comparison& comparison) {
  for (const std::string& line : comparison.other_modules) {
    std::cout << line << '\n';
  }
  for (const Difference& difference : comparison.differences) {
    std::cout << "node " << unsigned{difference.wanted->node} << "  "
              << host::address_text(difference.value.object.address) << "  " << entry_text(difference) << ": found "
              << difference.found << ", the file has " << wanted_text(difference) << '\n';
  }
  print_without_gait(comparison);
  std::cout << comparison.count() << " differences\n";
}

int diff(const ParamsOptions& options, const std::vector<host::ModuleParameters>& file, BusAccess& bus) {
  Modules modules(bus);
  const Comparison comparison = compare(file, modules);
  if (options.json) {
    print_json(options, file, comparison, {});
  } else {
    print_differences(comparison);
  }
  return comparison.count() == 0 ? exit_success : exit_failed;
}

int run(const ParamsOptions& options) {
  static_cast<void>(host::parse_nodes(options.nodes));
  if (options.action == "save") {
    const std::vector<PlannedOutput> outputs{
        {"FILE", options.file, "file of parameters", starts_with(host::parameter_file_start)}};
    check_outputs(outputs);
    BusAccess bus(options);
    catch_interrupts();
    return save(options, bus);
  }
  if (options.action != "load" && options.action != "diff") {
    throw InputError("ACTION", 0, in_quotes(options.action), "save, load or diff");
  }
  const std::vector<host::ModuleParameters> file = host::read_parameters(options.file, read_file(options.file));
  BusAccess bus(options);
  catch_interrupts();
  return options.action == "load" ? load(options, file, bus) : diff(options, file, bus);
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine command_line(
      "proleg params",
      "Keeps the settings of modules in a text file: what they store in flash except the node id, the "
      "greatest speed, and the parameters of their algorithms.");
  ParamsOptions options;
  command_line
      .add_option("ACTION", options.action, "save: read the modules; load: write what differs; diff: show what differs")
      .required();
  command_line.add_option("FILE", options.file, "the text file").required();
  command_line.add_option("--nodes", options.nodes, "with save: 3, 1,3 or 2-5, or all").shows_default();
  command_line.add_flag("--store", options.store, "with load: the modules keep the settings in their flash");
  command_line.add_flag("--any-module", options.any_module,
                        "with load: also into modules with other serial numbers than in the file");
  command_line.add_flag("--json", options.json, "print one JSON object");
  add_bus_option(command_line, options);
  command_line.add_algorithms_option();
  return command_line.run(argc, argv, [&] { return run(options); });
}
