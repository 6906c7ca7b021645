#include "other_compilers.hpp"

#include "sim/hardware_loop/hardware_loop.hpp"

namespace proleg::sim {
namespace {

TEST_F(OtherCompilers, VerifyARecordingOfModulesOnTheBus) {
  HardwareOptions options;
  options.losses = &losses_;
  options.restarts = {{700, 3}};
  HardwareLoop loop(scenario_, options);
  Recorder recorder(path_, scenario_, "test", "build");
  while (loop.tick() < 2000) {
    loop.advance();
    for (const auto& event : loop.restart_events()) {
      recorder.record_restart(loop.tick() - 1, event.joint, event.joined);
    }
    recorder.record_tick(loop.sample());
  }
  recorder.finish({});
  expect_verified(loop.setpoint_hash().hex() + " " + loop.servo_hash().hex());
}

}  // namespace
}  // namespace proleg::sim
