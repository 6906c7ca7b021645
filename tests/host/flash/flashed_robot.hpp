#pragma once

// A simulated robot whose modules are flashed, on virtual time: native modules with their bootloaders.

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "host/flash/module_program.hpp"
#include "host/flash/robot_update.hpp"
#include "live_bus.hpp"
#include "shipped.hpp"
#include "sim/hardware_loop/native_module.hpp"

namespace proleg::test {

inline constexpr std::size_t body_size = 60'000;
inline const std::vector<std::uint8_t> new_image = sim::make_native_image(1, {0, 2, 0}, body_size);

/// The modules run an image of version 0.1.0, of the same size as the new one.
class FlashedRobot {
 public:
  explicit FlashedRobot(const std::string& scenario = "travelling_wave/uniform", sim::LiveRobotOptions options = {})
      : scenario_(sim::shipped(scenario)), bus(scenario_, keeping_serials(std::move(options))) {
    for (unsigned joint = 0; joint < size(); ++joint) {
      program(joint).write_image(sim::make_native_image(1, {0, 1, 0}, body_size), true);
    }
    bus.run_for(boot_time);
  }

  [[nodiscard]] unsigned size() { return bus.robot().joint_count(); }
  [[nodiscard]] sim::NativeModule& module(unsigned joint) {
    return dynamic_cast<sim::NativeModule&>(bus.robot().module(joint));
  }
  [[nodiscard]] sim::NativeProgram& program(unsigned joint) { return module(joint).program(); }
  [[nodiscard]] unsigned minor_version(unsigned joint) {
    const auto image = program(joint).image();
    return image.empty() ? 0 : image::decode(image).header.version.minor;
  }
  void power_cycle(unsigned joint) { module(joint).power_on(bus.robot().bus().now()); }

  /// Flashes the first `count` modules. Returns when the update is done.
  std::unique_ptr<host::RobotUpdate> update(std::size_t count, std::span<const std::uint8_t> image = new_image,
                                            const host::UpdateOptions& options = {}) {
    auto update = std::make_unique<host::RobotUpdate>(
        bus, image, std::vector(serials.begin(), serials.begin() + static_cast<std::ptrdiff_t>(count)), options);
    bus.attach(*update);
    update->start(bus.now());
    EXPECT_TRUE(bus.run_until(bus.now() + 120 * second, [&] { return update->is_done(); }));
    bus.detach(*update);
    return update;
  }
  [[nodiscard]] host::ModuleProgram ask(unsigned joint) {
    host::ModuleQuery query(bus);
    bus.attach(query);
    query.start(bus.now(), {serials[joint]});
    EXPECT_TRUE(bus.run_until(bus.now() + 10 * second, [&] { return query.is_done(); }));
    bus.detach(query);
    return query.modules()[0];
  }

 private:
  static constexpr Microseconds boot_time = 100'000;

  sim::LiveRobotOptions keeping_serials(sim::LiveRobotOptions options) {
    options.change_identity = [this, change = options.change_identity](unsigned joint,
                                                                       firmware::ModuleIdentity& identity) {
      if (change) {
        change(joint, identity);
      }
      serials.push_back(serial_number(identity));
    };
    return options;
  }

  sim::Scenario scenario_;

 public:
  std::vector<std::uint32_t> serials;  ///< by joint
  LiveBus bus;
};

}  // namespace proleg::test
