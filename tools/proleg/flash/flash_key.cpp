#include "tools/proleg/flash/flash_key.hpp"

#include <algorithm>
#include <iostream>

#include "host/flash/key_file.hpp"
#include "host/flash/key_update.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/flash/flash_modules.hpp"
#include "tools/proleg/flash/update_run.hpp"

namespace proleg::tools {
namespace {

namespace flag = broadcast::module_flag;
using host::FlashCandidate;

constexpr Microseconds second = 1'000'000;

/// Why a module cannot get the key; empty: it can, or has it.
std::string refusal(const FlashCandidate& module, std::uint32_t id) {
  const host::ModuleProgram& program = module.program;
  if (!program.has_answered) {
    return "does not answer";
  }
  if (!program.is(flag::has_bootloader)) {
    return "has no bootloader: 'proleg flash --bare' brings it";
  }
  if (program.is(flag::is_busy)) {
    return "its servo has power, or it is Operational: stop the robot first";
  }
  if (program.trust.key_id != 0 && program.trust.key_id != id) {
    return "has the key " + host::key_id_text(program.trust.key_id) +
           " already: an image that is signed with that key can bring another one ('proleg image sign --next-key')";
  }
  return "";
}

}  // namespace

int run_flash_key(BusAccess& bus, const std::string& file, const std::optional<std::vector<std::uint8_t>>& nodes) {
  const image::PublicKey key = host::read_public_key(file);
  const std::uint32_t id = image::key_id(key);
  std::vector<FlashCandidate> modules = find_modules(bus, nodes).modules;
  std::vector<std::string> states;
  std::vector<std::uint32_t> serials;
  for (const FlashCandidate& module : modules) {
    states.push_back(refusal(module, id));
    if (states.back().empty() && module.program.trust.key_id == 0) {
      serials.push_back(module.program.serial);
    }
  }
  if (!serials.empty()) {
    host::KeyUpdate update(bus.connection(), key, serials, new_session(bus));
    {
      const host::BusAttachment attachment(bus.connection(), update);
      update.start(bus.connection().now());
      bus.wait_for("the modules that keep the key", 120 * second, [&update] { return update.is_done(); });
    }
    for (const broadcast::Target& target : update.targets()) {
      const auto module =
          std::ranges::find(modules, target.serial, [](const FlashCandidate& each) { return each.program.serial; });
      states[static_cast<std::size_t>(module - modules.begin())] = host::key_failure(target);
    }
    bus.connection().run_for(second);  // the programs start
  }
  bool are_all_good = true;
  for (std::size_t i = 0; i < modules.size(); ++i) {
    are_all_good = are_all_good && states[i].empty();
    std::cout << "  " << name_of(modules[i]) << "  "
              << (states[i].empty() ? "takes only images that are signed with key " + host::key_id_text(id) : states[i])
              << '\n';
  }
  return are_all_good ? exit_success : exit_failed;
}

}  // namespace proleg::tools
