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

/// Gives these modules the key, all at once. through_its_line: the connection may end meanwhile.
std::vector<broadcast::Target> give_key(BusAccess& bus, const image::PublicKey& key,
                                        const std::vector<FlashCandidate*>& modules, bool through_its_line) {
  std::vector<std::uint32_t> serials;
  for (const FlashCandidate* const module : modules) {
    serials.push_back(module->program.serial);
  }
  host::BusConnection& connection = bus.connection();
  host::KeyUpdate update(connection, key, serials, new_session(bus));
  {
    const host::BusAttachment attachment(connection, update);
    update.start(connection.now());
    bus.wait_for("the modules that keep the key", 120 * second,
                 [&] { return update.is_done() || (through_its_line && !connection.state().is_connected); });
  }
  connection.run_for(second);  // the programs start
  return update.targets();
}

/// Whether the program of a gateway reports the key. The host may reach the bus through this gateway only: its line
/// ends while its bootloader runs.
bool comes_back_with_key(BusAccess& bus, const FlashCandidate& gateway, std::uint32_t id) {
  host::BusConnection& connection = bus.connection();
  const Microseconds end = connection.now() + 20 * second;
  while (connection.now() < end && !interrupted()) {
    host::ModuleQuery query(connection);
    {
      const host::BusAttachment attachment(connection, query);
      query.start(connection.now(), {gateway.program.serial});
      connection.run_until(end, [&] { return query.is_done() || interrupted() || !connection.state().is_connected; });
    }
    const host::ModuleProgram& program = query.modules().front();
    if (query.is_done() && program.has_answered && program.is(flag::runs_program)) {
      return program.trust.key_id == id;
    }
    connection.run_for(second / 4);
  }
  return false;
}

}  // namespace

int run_flash_key(BusAccess& bus, const std::string& file, const std::optional<std::vector<std::uint8_t>>& nodes) {
  const image::PublicKey key = host::read_public_key(file);
  const std::uint32_t id = image::key_id(key);
  std::vector<FlashCandidate> modules = find_modules(bus, nodes).modules;
  std::vector<std::string> states;
  std::vector<FlashCandidate*> ordinary;
  std::vector<FlashCandidate*> gateways;
  for (FlashCandidate& module : modules) {
    states.push_back(refusal(module, id));
    if (states.back().empty() && module.program.trust.key_id == 0) {
      (module.program.is(flag::is_gateway) ? gateways : ordinary).push_back(&module);
    }
  }
  const auto state_of = [&](const FlashCandidate* module) -> std::string& {
    return states[static_cast<std::size_t>(module - modules.data())];
  };
  if (!ordinary.empty()) {
    const std::vector<broadcast::Target> targets = give_key(bus, key, ordinary, false);
    for (std::size_t i = 0; i < ordinary.size(); ++i) {
      state_of(ordinary[i]) = host::key_failure(targets[i]);
    }
  }
  // Gateways come last, one after the other, as with an image.
  for (FlashCandidate* const gateway : gateways) {
    const broadcast::Target target = give_key(bus, key, {gateway}, true).front();
    const bool has_result = target.status.state == broadcast::ReceiverState::refused ||
                            target.status.state == broadcast::ReceiverState::failed;
    if (has_result) {
      state_of(gateway) = host::key_failure(target);
    } else if (!comes_back_with_key(bus, *gateway, id)) {
      state_of(gateway) = "has not come back with the key";
    }
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
