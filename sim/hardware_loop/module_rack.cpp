#include "sim/hardware_loop/module_rack.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "shared/fixed/crc32.hpp"
#include "shared/fixed/random.hpp"
#include "shared/kernel/fingerprint.hpp"
#include "sim/hardware_loop/native_module.hpp"
#include "sim/loop/module_readings.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {
namespace {

/// The last word of a unique id whose checksum is the given serial number: CRC-32 (shared/fixed/crc32.hpp), reversed.
std::uint32_t word_for_serial(std::uint32_t crc_before, std::uint32_t serial) {
  constexpr std::uint32_t reflected_polynomial = 0xEDB88320;
  std::uint32_t remainder = ~serial;
  for (int bit = 0; bit < 32; ++bit) {
    const bool divided = (remainder & 0x80000000U) != 0;
    remainder = (divided ? (remainder ^ reflected_polynomial) << 1U | 1U : remainder << 1U);
  }
  return remainder ^ ~crc_before;
}

/// Longer than a SYNC waits for a frame on the wire, plus the drift of the crystals in a tick.
constexpr BusTime max_sync_jitter = 500'000;

/// What a native module measures: its current is the mean over the steps of the plant since the reading before.
class ServoMeter {
 public:
  ServoMeter(const Plant& plant, unsigned joint) : plant_(&plant), joint_(joint) {}
  ServoReadings operator()() {
    ServoReadings readings = plant_->servo_readings(joint_);
    const Plant::DrawnCurrent drawn = plant_->drawn_current(joint_);
    if (drawn.steps != before_.steps) {
      const double mean = (drawn.sum_ma - before_.sum_ma) / static_cast<double>(drawn.steps - before_.steps);
      readings.current_ma = static_cast<std::uint16_t>(std::lround(mean));
      before_ = drawn;
    }
    return readings;
  }

 private:
  const Plant* plant_;
  unsigned joint_;
  Plant::DrawnCurrent before_{0.0, 0};
};

}  // namespace

Crystal make_crystal(const Scenario& scenario, std::size_t joint, std::uint32_t error_ppm) {
  Pcg32 noise(scenario.kernel.seed, random_stream::crystals + joint);
  const auto range = static_cast<std::int32_t>(error_ppm) * 1000;
  return Crystal(static_cast<std::int32_t>(noise.below(static_cast<std::uint32_t>(2 * range + 1))) - range);
}

firmware::ModuleIdentity make_identity(const Scenario& scenario, std::size_t joint) {
  Pcg32 noise(scenario.kernel.seed, random_stream::boards + joint);
  firmware::ModuleIdentity identity;
  identity.node = scenario.modules[joint].node;
  identity.core_fingerprint = core_fingerprint;
  identity.capabilities = canopen::measures_angle | canopen::has_brown_out_reset;
  for (std::uint32_t& word : identity.unique_id) {
    word = noise.next();
  }
  if (const std::optional<std::uint32_t> serial = scenario.modules[joint].serial) {
    Crc32 crc;
    for (const std::uint32_t word : std::span(identity.unique_id).first(2)) {
      for (unsigned shift = 0; shift < 32; shift += 8) {
        crc.add(static_cast<std::uint8_t>(word >> shift));
      }
    }
    identity.unique_id[2] = word_for_serial(crc.value(), *serial);
  }
  return identity;
}

ModuleRack::ModuleRack(Bus& bus, const Plant& plant, const Scenario& scenario, const HardwareOptions& options)
    : bus_(bus),
      scenario_(scenario),
      options_(options),
      records_(scenario.modules.size()),
      ticks_before_(scenario.modules.size()),
      prepared_from_(scenario.modules.size()),
      threads_(std::clamp(options.threads, 1U, static_cast<unsigned>(scenario.modules.size())),
               static_cast<unsigned>(scenario.modules.size())) {
  for (unsigned joint = 0; joint < scenario.modules.size(); ++joint) {
    firmware::ModuleIdentity identity = make_identity(scenario, joint);
    if (options.change_identity) {
      options.change_identity(joint, identity);
    }
    const auto sensors = [&plant, &options, joint] {
      const std::uint8_t contacts = joint_contacts(plant.link_contacts(), joint);
      return options.change_sensors ? options.change_sensors(joint, contacts) : contacts;
    };
    const ModuleParts parts{bus,
                            joint,
                            identity,
                            make_crystal(scenario, joint, options.crystal_error_ppm),
                            sensors,
                            [&plant, joint] { return plant.servo_readings(joint); },
                            ServoMeter(plant, joint),
                            options.gateway && options.gateway->joint == joint};
    std::unique_ptr<JointModule> module = options.make_module ? options.make_module(parts) : nullptr;
    modules_.push_back(module ? std::move(module) : make_native(parts));
  }
  if (options.gateway) {
    modules_.at(options.gateway->joint)
        ->set_serial_watch(
            [host = options.gateway->host](BusTime time, std::uint8_t byte) { host->received(time, byte); });
  }
}

std::unique_ptr<JointModule> ModuleRack::make_native(const ModuleParts& parts) const {
  auto module = std::make_unique<NativeModule>(parts.bus, parts.identity, parts.crystal, parts.sensors,
                                               parts.take_readings, parts.is_gateway);
  module->set_start_time(options_.start_time_us);
  if (options_.tamper) {
    module->set_tamper([&options = options_, joint = parts.joint](const CanFrame& frame, const auto& deliver) {
      options.tamper(joint, frame, deliver);
    });
  }
  return module;
}

void ModuleRack::watch_pulses(const PulseWatch& watch) {
  for (unsigned joint = 0; joint < size(); ++joint) {
    modules_[joint]->set_pulse_watch([watch, joint](const JointModule::WatchedPulse& pulse) { watch(joint, pulse); });
  }
}

void ModuleRack::watch_commands(const CommandWatch& watch) {
  for (unsigned joint = 0; joint < size(); ++joint) {
    modules_[joint]->set_command_watch([watch, joint](BusTime time, std::int32_t /*width*/) { watch(joint, time); });
  }
}

void ModuleRack::power_on(BusTime now) {
  for (const auto& module : modules_) {
    module->power_on(now);
  }
}

BusTime ModuleRack::next_event() const {
  BusTime next = next_serial_input();
  for (const auto& module : modules_) {
    next = std::min(next, module->next_event());
  }
  return next;
}

BusTime ModuleRack::next_serial_input() const {
  return options_.gateway ? options_.gateway->host->next_event() : never_on_bus;
}

void ModuleRack::take_serial_input(BusTime now) {
  SerialHost& host = *options_.gateway->host;
  while (const auto character = host.take(now)) {
    modules_[options_.gateway->joint]->begin_serial_input(now, *character, host.bit_time());
  }
}

void ModuleRack::advance_to(BusTime now, BusTime quiet_until, BusTime ahead_until) {
  if (next_serial_input() <= now) {
    take_serial_input(now);
  }
  quiet_until = std::min(quiet_until, next_serial_input());
  prepare(now, quiet_until, std::min(ahead_until, quiet_until));
  for (const auto& module : modules_) {
    if (module->next_event() <= now) {
      module->advance_to(now, quiet_until);
    }
  }
}

void ModuleRack::prepare(BusTime now, BusTime quiet_until, BusTime ahead_until) {
  // A module that acts later may run to the same end, since no frame can reach it before. It must have a long way to
  // go, because its advance_to() takes it further.
  const BusTime latest = quiet_until > now ? std::min(ahead_until, now + (quiet_until - now) / 2) : now;
  preparations_.clear();
  for (unsigned joint = 0; joint < size(); ++joint) {
    JointModule& module = *modules_[joint];
    const BusTime next = module.next_event();
    if (next <= now) {
      module.submit(now);
    } else if (next >= latest) {
      continue;
    }
    prepared_from_[joint] = std::max(now, next);
    if (module.can_prepare(prepared_from_[joint])) {
      preparations_.push_back(joint);
    }
  }
  if (preparations_.size() < 2) {
    return;
  }
  bus_.begin_sharing();
  threads_.run(preparations_, [&](unsigned joint) { modules_[joint]->prepare(prepared_from_[joint], quiet_until); });
  bus_.end_sharing();
}

void ModuleRack::catch_up_before(BusTime time) {
  for (const auto& module : modules_) {
    module->catch_up_before(time);
  }
}

void ModuleRack::begin_tick(std::uint32_t tick, BusTime now) {
  make_due_restarts(tick, now);
  for (const auto& module : modules_) {
    module->note_sync(tick);
  }
}

void ModuleRack::begin_tick_without_sync(std::uint32_t tick, BusTime now) {
  make_due_restarts(tick, now);
  for (const auto& module : modules_) {
    module->note_missing_sync();
  }
}

void ModuleRack::make_due_restarts(std::uint32_t tick, BusTime now) {
  restarted_ = {};
  for (; next_restart_ < options_.restarts.size() && options_.restarts[next_restart_].tick <= tick; ++next_restart_) {
    restart(options_.restarts[next_restart_].joint, now);
  }
}

void ModuleRack::restart(unsigned joint, BusTime now) {
  // A module with a slow crystal still owes pulses of the tick before.
  modules_[joint]->run_out(now, now + max_sync_jitter);
  last_pulses_[joint] = modules_[joint]->pulse();
  modules_[joint]->power_on(now);
  restarted_.insert(joint);
}

void ModuleRack::end_tick() {
  for (unsigned joint = 0; joint < size(); ++joint) {
    ticks_before_[joint] = records_[joint].tick;
    records_[joint] = modules_[joint]->last_tick();
  }
}

void ModuleRack::take_problems(std::uint32_t tick, HardwareReport& report) {
  for (unsigned joint = 0; joint < size(); ++joint) {
    while (const auto problem = modules_[joint]->take_problem()) {
      report.problems.push_back({tick, joint, *problem, modules_[joint]->leaves_model()});
      if (options_.notice) {
        options_.notice(scenario_.robot.joints[joint].name + " (node " + std::to_string(scenario_.modules[joint].node) +
                        "): " + *problem);
      }
    }
  }
}

}  // namespace proleg::sim
