#include "tools/proleg/ui/fast_simulation.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <ctime>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"

namespace proleg::tools {

void lower_thread_priority() {
  constexpr int lower_priority = 10;
  setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), lower_priority);  // of this thread only (setpriority(2))
}

std::chrono::nanoseconds thread_time() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec);
}

std::unique_ptr<sim::Simulation> make_fast_simulation(sim::Scenario& scenario) {
  std::unique_ptr<sim::Simulation> simulation;
  scenario.environment.engine = sim::PhysicsEngine::reduced;
  try {
    simulation = std::make_unique<sim::Simulation>(scenario);
  } catch (const InputError&) {  // what the reduced engine does not have
    scenario.environment.engine = sim::PhysicsEngine::ode;
    simulation = std::make_unique<sim::Simulation>(scenario);
  }
  simulation->leave_out_hashes();
  return simulation;
}

std::optional<std::string> refusal_of_engine(const sim::Scenario& scenario) {
  try {
    const sim::Simulation simulation(scenario);
    return std::nullopt;
  } catch (const InputError& error) {
    return one_line(error.what());
  }
}

}  // namespace proleg::tools
