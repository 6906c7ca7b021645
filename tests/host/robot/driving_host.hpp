#pragma once

// A host that drives the simulated robot of a test.

#include "host/robot/robot_drive.hpp"
#include "live_bus.hpp"
#include "shared/kernel/fingerprint.hpp"
#include "sim/hardware_loop/master_input.hpp"

namespace proleg::test {

inline canopen::MasterOptions host_options() {
  canopen::MasterOptions options;
  options.core_fingerprint = core_fingerprint;
  options.resets_modules = true;
  options.ramps_down = true;
  options.reads_checksums = true;
  options.ramp_in_speed = 90;
  options.answer_timeout_us = 150'000;
  options.attempts = 8;
  return options;
}

class DrivingHost {
 public:
  DrivingHost(LiveBus& bus, const sim::Scenario& scenario)
      : bus_(bus), input_(scenario), drive(bus, input_.setup, host_options(), input_.changes) {
    bus_.attach(drive);
  }
  ~DrivingHost() { bus_.detach(drive); }
  DrivingHost(const DrivingHost&) = delete;
  DrivingHost& operator=(const DrivingHost&) = delete;

  bool start(Microseconds at_most = 20'000'000) {
    drive.master().start(bus_.now());
    bus_.run_until(bus_.now() + at_most, [this] {
      return drive.master().state() == canopen::MasterState::running ||
             drive.master().state() == canopen::MasterState::failed;
    });
    return drive.master().state() == canopen::MasterState::running;
  }
  bool stop() {
    drive.master().stop(bus_.now());
    return bus_.run_until(bus_.now() + 10'000'000,
                          [this] { return drive.master().state() == canopen::MasterState::stopped; });
  }
  bool run_to_tick(std::uint32_t tick) {
    return bus_.run_until(bus_.now() + 60'000'000, [&] { return drive.master().tick().value_or(0) >= tick; });
  }

 private:
  LiveBus& bus_;
  sim::MasterInput input_;

 public:
  host::RobotDrive drive;
};

}  // namespace proleg::test
