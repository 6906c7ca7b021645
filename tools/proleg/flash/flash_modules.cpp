#include "tools/proleg/flash/flash_modules.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "host/robot/object_word.hpp"
#include "host/robot/silent_modules.hpp"
#include "shared/broadcast/image_receiver.hpp"
#include "shared/canopen/declared_objects.hpp"
#include "shared/canopen/object_name.hpp"
#include "shared/computer/text/text.hpp"
#include "shared/fixed/little_endian.hpp"
#include "shared/image/board_names.hpp"

namespace proleg::tools {
namespace {

using host::FlashCandidate;

constexpr Microseconds second = 1'000'000;

/// Sorts modules by node id. Modules without one come last.
void sort(std::vector<FlashCandidate>& modules) {
  std::ranges::stable_sort(modules, {}, [](const FlashCandidate& module) {
    return module.node == 0 ? unsigned{canopen::max_node_id} + 1U : module.node;
  });
}

constexpr Microseconds longest_search = 60 * second;

/// Begins to search for modules that are not among the known ones.
void start(BusAccess& bus, host::SilentModules& search, std::span<const FlashCandidate> known) {
  std::vector<std::uint32_t> products;
  products.reserve(image::board_names.size() + known.size());
  for (const image::BoardName& board : image::board_names) {
    products.push_back(board.id);
  }
  std::vector<std::uint32_t> serials;
  for (const FlashCandidate& module : known) {
    serials.push_back(module.program.serial);
    if (std::ranges::find(products, module.board_id) == products.end()) {
      products.push_back(module.board_id);
    }
  }
  search.start(bus.connection().now(), canopen::object::vendor.default_value, std::move(products), std::move(serials));
}

host::SilentModulesOptions search_options() {
  host::SilentModulesOptions options;
  options.max_modules = canopen::max_node_id;
  options.longest_us = longest_search;
  return options;
}

std::vector<FlashCandidate> finish(BusAccess& bus, host::SilentModules& search) {
  bus.wait_for("modules without a node id", longest_search + second, [&search] { return search.is_done(); });
  std::vector<FlashCandidate> modules;
  for (const host::SilentModule& module : search.found()) {
    modules.push_back({{module.serial, false, {}, {}, {}},
                       module.node_id.value_or(0),
                       static_cast<std::uint16_t>(module.product),
                       false});
  }
  return modules;
}

}  // namespace

std::vector<FlashCandidate> find_silent_modules(BusAccess& bus, std::span<const FlashCandidate> known) {
  host::SilentModulesOptions options = search_options();
  options.answer_timeout_us = host::BusScanOptions().answer_timeout_us;  // a module behind a radio is found by both
  host::SilentModules search(bus.connection(), options);
  const host::BusAttachment attachment(bus.connection(), search);
  start(bus, search, known);
  return finish(bus, search);
}

FoundModules look_for_modules(BusAccess& bus, SilentSearch search) {
  host::BusScan all(bus.connection());
  scan(bus, all);
  FoundModules found;
  for (const host::ScannedNode& node : all.nodes()) {
    if (!node.has_answered) {
      found.silent.push_back(node.node);
    } else if (!node.is_module) {
      found.foreign.push_back(node.node);
    } else {
      found.modules.push_back(
          {{node.serial, false, {}, {}, {}}, node.node, static_cast<std::uint16_t>(node.product), true});
    }
  }
  const bool are_signs = all.has_fresh_modules() || !found.silent.empty() || !all.duplicates().empty();
  if (are_signs || search == SilentSearch::always) {
    for (const FlashCandidate& module : find_silent_modules(bus, found.modules)) {
      found.modules.push_back(module);
      std::erase(found.silent, module.node);
    }
  }
  sort(found.modules);
  return found;
}

void ask_programs(BusAccess& bus, std::span<FlashCandidate> modules) {
  std::vector<std::uint32_t> asked;
  for (const FlashCandidate& module : modules) {
    asked.push_back(module.program.serial);
  }
  host::ModuleQuery query(bus.connection());
  const host::BusAttachment attachment(bus.connection(), query);
  query.start(bus.connection().now(), asked);
  bus.wait_for("the answers of the modules", 120 * second, [&query] { return query.is_done(); });
  for (std::size_t i = 0; i < modules.size(); ++i) {
    modules[i].program = query.modules()[i];
  }
}

namespace {

/// Whether a module is missing that was asked for, or that has sent frames.
bool is_any_missing(const FoundModules& found, const std::optional<std::vector<std::uint8_t>>& nodes) {
  if (!nodes) {
    return found.modules.empty() || !found.silent.empty();
  }
  return std::ranges::any_of(*nodes, [&found](std::uint8_t node) {
    return std::ranges::find(found.modules, node, &FlashCandidate::node) == found.modules.end();
  });
}

}  // namespace

FoundModules find_modules(BusAccess& bus, const std::optional<std::vector<std::uint8_t>>& nodes) {
  // A bootloader that installs answers nothing for that long.
  constexpr Microseconds longest_silence = 4 * second;
  constexpr Microseconds pause = second / 5;
  const Microseconds end = bus.connection().now() + longest_silence;
  FoundModules found = look_for_modules(bus, SilentSearch::after_signs);
  while (is_any_missing(found, nodes) && bus.connection().now() < end) {
    bus.connection().run_for(pause);
    found = look_for_modules(bus, SilentSearch::always);
  }
  if (nodes) {
    for (const std::uint8_t node : *nodes) {
      if (std::ranges::find(found.modules, node, &FlashCandidate::node) == found.modules.end()) {
        throw std::runtime_error("no joint module answers as node " + std::to_string(node) + "; " +
                                 bus.connection().diagnosis());
      }
    }
    std::erase_if(found.modules, [&nodes](const FlashCandidate& module) {
      return std::ranges::find(*nodes, module.node) == nodes->end();
    });
    found.foreign.clear();
    found.silent.clear();
  }
  if (found.modules.empty()) {
    throw std::runtime_error("found no joint module on the bus; " + bus.connection().diagnosis());
  }
  if (nodes) {
    ask_programs(bus, found.modules);
    return found;
  }
  // A module that is Stopped gives no sign of itself. The search uses other identifiers than the questions for the
  // programs, and takes hardly any time beside them.
  constexpr Microseconds wired_answer = 15'000;
  host::SilentModulesOptions options = search_options();
  options.answer_timeout_us = wired_answer;
  host::SilentModules search(bus.connection(), options);
  std::vector<FlashCandidate> stopped;
  {
    const host::BusAttachment attachment(bus.connection(), search);
    start(bus, search, found.modules);
    ask_programs(bus, found.modules);
    stopped = finish(bus, search);
  }
  ask_programs(bus, stopped);
  found.modules.insert(found.modules.end(), stopped.begin(), stopped.end());
  sort(found.modules);
  return found;
}

std::vector<host::ModuleParameters> read_settings(BusAccess& bus, const std::vector<std::uint8_t>& nodes) {
  std::vector<host::ModuleParameters> all(nodes.size());
  host::SdoQueue queue(bus.connection(), patient_transfers());
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    all[i].node = nodes[i];
    queue.read(nodes[i], canopen::object::serial.address,
               [&module = all[i]](const host::SdoResult& result) { module.serial = result.number(); });
    queue.read(nodes[i], canopen::object::core_fingerprint.address,
               [&module = all[i]](const host::SdoResult& result) { module.core_fingerprint = result.number(); });
    for (const canopen::Object& object : host::kept_objects()) {
      queue.read(nodes[i], object.address, [&module = all[i], object](const host::SdoResult& result) {
        if (result.is_good()) {
          module.values.push_back({object, result.value});
        }
      });
    }
  }
  finish(bus, queue);
  return all;
}

std::vector<std::string> compare_settings(const host::ModuleParameters& before, const host::ModuleParameters& after) {
  std::vector<std::string> lines;
  for (const host::ParameterValue& value : before.values) {
    const auto now = std::ranges::find(after.values, value.object.address,
                                       [](const host::ParameterValue& one) { return one.object.address; });
    if (now != after.values.end() && now->bytes == value.bytes) {
      continue;
    }
    const canopen::Object& object = value.object;
    lines.push_back("node " + std::to_string(before.node) + ": " + host::address_text(object.address) + " (" +
                    std::string(canopen::entry_name(object.address).view()) +
                    "): " + host::value_text(object, value.bytes) + " before, " +
                    (now == after.values.end() ? "no answer" : host::value_text(object, now->bytes)) + " now");
  }
  return lines;
}

void wait_for_sessions(BusAccess& bus, const std::vector<FlashCandidate>& modules) {
  using broadcast::ReceiverState;
  const bool is_any_open = std::ranges::any_of(modules, [](const FlashCandidate& module) {
    const ReceiverState state = module.program.status.state;
    return module.program.status.session != 0 && state >= ReceiverState::selected && state <= ReceiverState::complete;
  });
  if (is_any_open) {
    bus.connection().run_for(broadcast::ImageReceiver::session_timeout_us + second / 10);
  }
}

std::string name_of(const FlashCandidate& module) {
  return module.node != 0 ? "node " + std::to_string(module.node)
                          : "the module " + hexadecimal(module.program.serial, 8);
}

}  // namespace proleg::tools
