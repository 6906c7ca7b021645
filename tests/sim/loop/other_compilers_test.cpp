#include "other_compilers.hpp"

#include "sim/loop/simulation.hpp"

namespace proleg::sim {
namespace {

TEST_F(OtherCompilers, VerifyARecordingOfTheSimulation) {
  Simulation simulation(scenario_, &losses_);
  Recorder recorder(path_, scenario_, "test", "build");
  while (simulation.tick() < 2000) {
    simulation.advance();
    recorder.record_tick(simulation.sample());
  }
  recorder.finish({});
  expect_verified(simulation.setpoint_hash().hex() + " " + simulation.servo_hash().hex());
}

}  // namespace
}  // namespace proleg::sim
