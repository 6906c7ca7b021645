#include "tools/proleg/flash/update_run.hpp"

#include <stdexcept>

#include "tools/proleg/common/interrupt.hpp"
#include "tools/proleg/flash/flash_modules.hpp"
#include "tools/proleg/flash/flash_progress.hpp"

namespace proleg::tools {
namespace {

using host::RobotUpdate;

std::string state_of(const RobotUpdate& update, const host::UpdatedModule& module) {
  if (module.outcome != host::UpdateOutcome::pending) {
    return describe(module.outcome, module.detail);
  }
  switch (update.step()) {
    case RobotUpdate::Step::transfer:
      return module.has_image ? "waits for the others" : "receives the image";
    case RobotUpdate::Step::installation:
      return "installs it";
    default:
      return "restarts";
  }
}

void follow(host::BusConnection& bus, const RobotUpdate& update, std::span<const host::FlashCandidate> modules,
            bool through_its_line, const std::string& hint) {
  FlashProgress progress;
  constexpr Microseconds longest = 300'000'000;  // it ends by itself; this bounds one with a fault
  constexpr Microseconds drawing_period = 50'000;
  // A connection may come back: the line of a gateway ends for a while, and a plug may be loose.
  const Microseconds longest_loss = through_its_line ? longest : 8'000'000;
  const Microseconds end = bus.now() + longest;
  Microseconds connected_at = bus.now();
  while (!update.is_done()) {
    bus.run_until(bus.now() + drawing_period, [&update] { return update.is_done() || interrupted(); });
    if (interrupted()) {
      throw std::runtime_error("interrupted; a module that was installing goes on by itself, and starts its program" +
                               hint);
    }
    if (bus.state().is_connected) {
      connected_at = bus.now();
    } else if (bus.now() - connected_at > longest_loss) {
      throw std::runtime_error(bus.diagnosis() +
                               "; modules that have the whole image install it by themselves, and the same command "
                               "again completes what is missing" +
                               hint);
    }
    if (bus.now() > end) {
      throw std::runtime_error("no end after 5 minutes");
    }
    if (progress.is_due()) {
      std::vector<FlashProgress::Bar> bars;
      for (std::size_t i = 0; i < modules.size(); ++i) {
        const host::UpdatedModule& module = update.modules()[i];
        bars.push_back({name_of(modules[i]), module.has_image ? 1.0 : update.progress(), state_of(update, module)});
      }
      progress.draw(bars);
    }
  }
}

}  // namespace

std::uint8_t new_session(BusAccess& bus) {
  constexpr Microseconds sessions = 0xFF;
  return static_cast<std::uint8_t>(1 + bus.connection().now() % sessions);
}

UpdateRun run_update(BusAccess& bus, std::span<const std::uint8_t> image, std::span<const host::FlashCandidate> modules,
                     bool through_its_line, const std::string& hint) {
  std::vector<std::uint32_t> serials;
  for (const host::FlashCandidate& module : modules) {
    serials.push_back(module.program.serial);
  }
  host::UpdateOptions options;
  options.session = new_session(bus);
  options.through_its_line = through_its_line;
  host::BusConnection& connection = bus.connection();
  RobotUpdate update(connection, image, serials, options);
  connection.attach(update);
  update.start(connection.now());
  try {
    follow(connection, update, modules, through_its_line, hint);
  } catch (...) {
    connection.detach(update);
    throw;
  }
  connection.detach(update);
  const auto seconds = [&update](RobotUpdate::Step step) { return static_cast<double>(update.duration(step)) / 1e6; };
  return {update.modules(),
          {seconds(RobotUpdate::Step::transfer), seconds(RobotUpdate::Step::installation),
           seconds(RobotUpdate::Step::restart)}};
}

}  // namespace proleg::tools
