// The measurements of servos by modules in the loop, and the protection that uses them.

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <vector>

#include "shared/canopen/declared_objects.hpp"
#include "shipped.hpp"
#include "sim/hardware_loop/hardware_loop.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/robot/servo.hpp"

namespace proleg::sim {
namespace {

constexpr ServoCurrent default_current;

TEST(ServoReadings, AreMonitoredByEveryModuleEveryTenthTick) {
  const Scenario scenario = shipped("travelling_wave/coupled");
  HardwareOptions options;
  std::map<std::uint8_t, std::vector<canopen::Monitoring>> monitored;
  options.on_frame = [&](const Transmission& transmission) {
    if (const auto monitoring = canopen::decode_monitoring(transmission.frame)) {
      monitored[monitoring->node].push_back(*monitoring);
    }
  };
  HardwareLoop loop(scenario, options);
  std::vector<double> angles;  // of the third joint, at the SYNCs after which it sends its monitoring message
  constexpr unsigned joint = 2;
  for (std::uint32_t tick = 0; tick < 200; ++tick) {
    if (tick % 10 == joint) {
      angles.push_back(loop.plant().joint_angles()[joint]);
    }
    loop.advance();
  }
  ASSERT_EQ(monitored.size(), 5U);
  for (const auto& [node, messages] : monitored) {
    EXPECT_EQ(messages.size(), 20U) << "node " << int{node};
  }
  const auto& messages = monitored[scenario.modules[joint].node];
  for (std::size_t i = 0; i < messages.size(); ++i) {
    // A step of the physics may lie on either side of the SYNC.
    EXPECT_NEAR(messages[i].angle * (std::numbers::pi / 2.0 / (1 << 14)), angles[i], 0.05) << i;
    EXPECT_GE(messages[i].current_ma, default_current.idle_ma);
    EXPECT_LE(messages[i].current_ma, default_current.stall_ma);
    EXPECT_EQ(messages[i].temperature_c, 25);
    EXPECT_EQ(messages[i].faults, 0);
  }
}

TEST(ServoReadings, HaveTheMeanCurrentOfTheTickAndNotThatOfItsLastStep) {
  const Scenario scenario = shipped("travelling_wave/coupled");
  constexpr unsigned joint = 2;
  HardwareOptions options;
  std::vector<double> monitored;
  options.on_frame = [&](const Transmission& transmission) {
    const auto monitoring = canopen::decode_monitoring(transmission.frame);
    if (monitoring && monitoring->node == scenario.modules[joint].node) {
      monitored.push_back(monitoring->current_ma);
    }
  };
  HardwareLoop loop(scenario, options);
  double to_mean = 0.0;
  double to_last_step = 0.0;
  for (std::uint32_t tick = 0; tick < 500; ++tick) {
    const std::size_t before = monitored.size();
    const double mean = tick > 0 ? loop.plant().servo_currents()[joint] : 0.0;
    const double last = loop.plant().servo_readings(joint).current_ma;
    loop.advance();
    if (tick > 10 && monitored.size() > before) {
      to_mean += std::abs(monitored.back() - mean);
      to_last_step += std::abs(monitored.back() - last);
    }
  }
  ASSERT_GT(monitored.size(), 40U);
  EXPECT_LT(to_mean, 0.3 * to_last_step) << "a step of the physics may lie on either side of the SYNC";
}

TEST(ServoReadings, AboveTheLimitStopThePulsesButNotTheGait) {
  const Scenario scenario = shipped("travelling_wave/coupled");
  constexpr unsigned joint = 1;
  const std::uint8_t node = scenario.modules[joint].node;
  HardwareOptions options;
  // 0x200A:1 = 1 mA, which is less than a servo at rest draws.
  options.injected.push_back({100,
                              {static_cast<std::uint16_t>(canopen::identifier::sdo_request + node),
                               8,
                               {0x2B, 0x0A, 0x20, 0x01, 0x01, 0x00, 0x00, 0x00}}});
  std::vector<std::pair<std::uint32_t, CanFrame>> emergencies;
  std::vector<std::string> notices;
  HardwareLoop* running = nullptr;
  bool fault_flag = false;
  options.on_frame = [&](const Transmission& transmission) {
    if (transmission.frame.identifier == canopen::identifier::emergency + node) {
      emergencies.emplace_back(running->tick(), transmission.frame);
    }
    if (transmission.frame.identifier == canopen::identifier::state_frame + node) {
      fault_flag = (transmission.frame.data[6] & StateFrame::fault) != 0;
    }
  };
  options.notice = [&](const std::string& notice) { notices.push_back(notice); };
  HardwareLoop loop(scenario, options);
  running = &loop;
  Simulation simulation(scenario);
  while (loop.tick() < 300) {
    loop.advance();
    simulation.advance();
  }
  ASSERT_EQ(emergencies.size(), 1U);
  EXPECT_EQ(emergencies[0].second.data, (std::array<std::uint8_t, 8>{0x10, 0x23, 0x03, 0, 0, 0, 0, 0}));
  // The first reading above the limit is that of tick 101.
  EXPECT_EQ(emergencies[0].first, 101U + 50U);
  ASSERT_EQ(notices.size(), 1U);
  EXPECT_NE(notices[0].find("over-current"), std::string::npos) << notices[0];
  EXPECT_TRUE(fault_flag);
  EXPECT_EQ(loop.setpoint_hash().hex(), simulation.setpoint_hash().hex());
  EXPECT_GT(loop.differences(), 0U) << "pulses that are missing";
  EXPECT_EQ(loop.first_difference()->kind, Difference::Kind::servo_command);
  EXPECT_EQ(loop.first_difference()->joint, joint);
}

}  // namespace
}  // namespace proleg::sim
