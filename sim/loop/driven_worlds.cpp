#include "sim/loop/driven_worlds.hpp"

#include <algorithm>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "sim/loop/simulation_batch.hpp"
#include "sim/physics/physics_error.hpp"

namespace proleg::sim {

struct DrivenWorlds::Member {
  Member(const Scenario& of, std::unique_ptr<World> world)
      : scenario(of),
        plant(of, std::move(world)),
        touch(of.robot.joints.size()),
        contacts(of.robot.links.size()),
        pulse_source({of.robot.servo.period_us, of.kernel.tick_period_us}, of.joint_limits,
                     of.robot.servo.command_speed),
        player(plant, pulse_source.schedule()) {
    sample_contacts();
  }

  void set(std::span<const std::int32_t> wanted) {
    ways.clear();
    for (unsigned joint = 0; joint < setpoints.size(); ++joint) {
      const AngleLimits& limits = scenario.joint_limits[joint];
      const std::int32_t next = std::clamp(wanted[joint], limits.lower, limits.upper);
      ways.push_back({joint, setpoints[joint], next});
      setpoints[joint] = next;
    }
  }

  void sample_contacts() {
    for (unsigned joint = 0; joint < scenario.robot.joints.size(); ++joint) {
      touch.sample(plant.link_contacts(), joint);
    }
    touch.write_links(contacts);
  }

  const Scenario& scenario;
  Plant plant;
  TouchInputs touch;
  std::vector<std::uint8_t> contacts;
  ServoPulses pulse_source;
  PulsePlayer player;
  std::vector<std::int32_t> setpoints{};
  std::vector<ServoPulses::Way> ways{};
  std::vector<ServoPulse> pulses{};
  bool runs = true;
  std::string failure{};
};

DrivenWorlds::DrivenWorlds(std::span<const Scenario* const> scenarios, std::span<const std::int32_t> start)
    : joint_count_(scenarios.front()->robot.joints.size()) {
  const Scenario& first = *scenarios.front();
  std::vector<reduced::WorldInput> inputs;
  bool fit_together = true;
  for (const Scenario* const scenario : scenarios) {
    if (scenario->robot.joints.size() != joint_count_ || scenario->step_s != first.step_s ||
        scenario->kernel.tick_period_us != first.kernel.tick_period_us) {
      throw InputError(scenario->path, 0, "a robot with other joints, tick or step than the first", "the same");
    }
    fit_together = fit_together && scenario->environment.engine == PhysicsEngine::reduced;
    inputs.push_back({&scenario->robot, &scenario->environment, scenario->step_s, scenario->path});
  }
  std::vector<std::unique_ptr<World>> worlds(scenarios.size());
  if (fit_together) {
    together_ = std::make_unique<reduced::ReducedWorlds>(inputs);
    worlds = together_->take_worlds();
  }
  for (std::size_t i = 0; i < scenarios.size(); ++i) {
    members_.push_back(std::make_unique<Member>(*scenarios[i], std::move(worlds[i])));
    const std::span<const std::int32_t> own = start.subspan(i * joint_count_, joint_count_);
    members_.back()->setpoints.assign(own.begin(), own.end());
    members_.back()->set(own);
  }
}

DrivenWorlds::~DrivenWorlds() = default;

template <typename Do>
void DrivenWorlds::for_all(const Do& act) {
  for (std::size_t i = 0; i < members_.size(); ++i) {
    Member& member = *members_[i];
    if (!member.runs) {
      continue;
    }
    try {
      act(member, i);
    } catch (const PhysicsError& error) {
      member.failure = error.what();
      member.runs = false;
    }
  }
}

void DrivenWorlds::advance(std::span<const std::int32_t> setpoints) {
  for_all([&](Member& member, std::size_t i) {
    member.set(setpoints.subspan(i * joint_count_, joint_count_));
    member.pulses.clear();
    member.pulse_source.append(tick_, member.ways, member.pulses);
    member.player.begin_tick(tick_, member.pulses);
    member.player.begin_step(0);
  });
  const std::uint32_t steps = members_.front()->plant.steps_per_tick();
  for (std::uint32_t step = 0; step < steps; ++step) {
    if (together_) {
      together_->step();
    }
    const bool is_last = step + 1 == steps;
    for_all([&](Member& member, std::size_t /*i*/) {
      member.plant.finish_step();
      if (is_last) {
        member.player.end_tick(member.setpoints);
        member.sample_contacts();
      } else {
        member.player.begin_step(step + 1);
      }
    });
  }
  ++tick_;
}

const Plant& DrivenWorlds::plant(std::size_t i) const { return members_[i]->plant; }
std::span<const std::uint8_t> DrivenWorlds::contacts(std::size_t i) const { return members_[i]->contacts; }
std::span<const std::int32_t> DrivenWorlds::setpoints(std::size_t i) const { return members_[i]->setpoints; }
bool DrivenWorlds::runs(std::size_t i) const { return members_[i]->runs; }
const std::string& DrivenWorlds::failure(std::size_t i) const { return members_[i]->failure; }

}  // namespace proleg::sim
