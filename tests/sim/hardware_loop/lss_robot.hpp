#pragma once

// Modules without a node id and an LSS master on the simulated bus.

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "shared/computer/master/lss_master.hpp"
#include "sim/bus/bus.hpp"
#include "sim/hardware_loop/joint_module.hpp"

namespace proleg::sim {

class LssRobot final : BusListener {
 public:
  static constexpr BusTime us = 1'000;
  static constexpr BusTime ms = 1'000 * us;

  LssRobot() : host(bus.attach(*this)) {
    bus.set_frame_listener([this](const Transmission& sent) { log.push_back(sent); });
  }

  void power_on() {
    for (const auto& module : modules) {
      module->power_on(bus.now());
    }
    run_for(50 * ms);
  }
  void run_for(BusTime time) {
    const BusTime end = bus.now() + time;
    while (bus.now() < end) {
      step(end);
    }
  }
  /// Until the master has ended.
  void assign(std::vector<canopen::LssModule>& entries, BusTime longest) {
    master = std::make_unique<canopen::LssMaster>(host, entries);
    const BusTime begin = bus.now();
    master->start(begin / us);
    while (master->state() == canopen::LssMaster::State::working) {
      ASSERT_LT(bus.now() - begin, longest);
      step(std::max(bus.now(), std::min(master->next_deadline() * us, begin + longest)));
      master->poll(bus.now() / us);
    }
    duration = bus.now() - begin;
  }
  [[nodiscard]] unsigned count(std::uint16_t identifier, std::size_t from = 0) const {
    return static_cast<unsigned>(
        std::count_if(log.begin() + static_cast<std::ptrdiff_t>(from), log.end(),
                      [&](const Transmission& sent) { return sent.frame.identifier == identifier; }));
  }

  Bus bus;
  Controller& host;
  std::vector<std::unique_ptr<JointModule>> modules;
  std::unique_ptr<canopen::LssMaster> master;
  std::vector<Transmission> log;
  BusTime duration = 0;

 private:
  /// To the next event, or `end`.
  void step(BusTime end) {
    BusTime next = std::min(end, bus.next_event());
    for (const auto& module : modules) {
      next = std::min(next, module->next_event());
    }
    next = std::max(next, bus.now());
    bus.advance_to(next);
    for (const auto& module : modules) {
      if (module->next_event() <= next) {
        module->advance_to(next, std::min(bus.earliest_delivery(), next + us));
      }
    }
  }
  void received(BusTime time, const CanFrame& frame) override {
    if (master) {
      master->receive(time / us, frame);
    }
  }
  void transmitted(BusTime time, const CanFrame& frame) override {
    if (master) {
      master->transmitted(time / us, frame);
    }
  }
};

}  // namespace proleg::sim
