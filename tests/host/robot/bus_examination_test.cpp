// Faults of a bus and its robot, seeded: for each the right finding is the first one. A healthy bus has no finding, and
// an examination changes nothing.

#include "host/robot/bus_examination.hpp"

#include <gtest/gtest.h>

#include <random>

#include "examined_bus.hpp"
#include "shared/canopen/declared_objects.hpp"
#include "shipped.hpp"
#include "sim/hardware_loop/native_module.hpp"

namespace proleg::test {
namespace {

using host::BusObservations;
using host::Finding;

constexpr unsigned seeds = 2;
constexpr unsigned joints = 5;
constexpr sim::BusTime millisecond = 1'000'000;

/// Chances of a case, which follow from its seed.
class Chances {
 public:
  explicit Chances(std::uint64_t seed) : random_(seed) {}
  /// A whole number between these, inclusive.
  std::uint64_t between(std::uint64_t low, std::uint64_t high) {
    return std::uniform_int_distribution<std::uint64_t>(low, high)(random_);
  }
  unsigned joint() { return static_cast<unsigned>(between(0, joints - 1)); }

 private:
  std::mt19937_64 random_;
};

std::vector<Finding> findings_of(const BusObservations& observations) {
  return host::find_bus_faults(observations, host::parse_bus_address("can0"), {core_fingerprint});
}

std::string text_of(const std::vector<Finding>& findings) {
  std::string text;
  for (const Finding& finding : findings) {
    text += "\n  " + std::string(finding.code) + ": " + finding.what + " To do: " + finding.to_do;
  }
  return text.empty() ? "no fault found" : text;
}

class BusFaults : public testing::Test {
 protected:
  /// Plays a case with several seeds. `prepare` seeds the fault and returns the nodes that the finding must name.
  using Prepare = std::function<std::vector<std::uint8_t>(ExaminedBus& bus, Chances& chances)>;
  void expect_first(std::string_view code, const Prepare& prepare,
                    const std::function<sim::LiveRobotOptions(Chances&)>& options = {}) {
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
      SCOPED_TRACE("seed " + std::to_string(seed));
      Chances chances(seed);
      ExaminedBus bus(scenario_, options ? options(chances) : sim::LiveRobotOptions{});
      bus.run_for(100'000 + chances.between(0, 100'000));
      const std::vector<std::uint8_t> nodes = prepare(bus, chances);
      const auto findings = findings_of(bus.examine());
      EXPECT_TRUE(bus.is_done());
      ASSERT_FALSE(findings.empty());
      EXPECT_EQ(findings.front().code, code) << text_of(findings);
      EXPECT_EQ(findings.front().nodes, nodes) << text_of(findings);
      EXPECT_FALSE(findings.front().to_do.empty());
      EXPECT_EQ(findings.size(), 1U) << "a consequence is no finding:" << text_of(findings);
    }
  }
  [[nodiscard]] std::uint8_t node(unsigned joint) const { return scenario_.modules[joint].node; }

  sim::Scenario scenario_ = sim::shipped("travelling_wave/uniform");
};

// A healthy bus.

TEST_F(BusFaults, AreNoneOnABusOfModulesThatWait) {
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Chances chances(seed);
    ExaminedBus bus(scenario_);
    bus.run_for(chances.between(20'000, 300'000));
    const BusObservations seen = bus.examine();
    EXPECT_EQ(text_of(findings_of(seen)), "no fault found");
    EXPECT_EQ(seen.nodes.size(), joints);
    EXPECT_TRUE(seen.is_complete);
  }
}

TEST_F(BusFaults, ABoardWithoutACurrentSensorIsNoneAndIsSeen) {
  sim::LiveRobotOptions options;
  options.change_identity = [](unsigned joint, firmware::ModuleIdentity& identity) {
    identity.capabilities |= joint == 1 ? canopen::has_no_current_sensor : 0;
  };
  ExaminedBus bus(scenario_, options);
  bus.run_for(100'000);
  const BusObservations seen = bus.examine();
  EXPECT_EQ(text_of(findings_of(seen)), "no fault found");
  ASSERT_EQ(seen.nodes.size(), joints);
  for (unsigned joint = 0; joint < joints; ++joint) {
    EXPECT_EQ(seen.nodes[joint].has_current_sensor, joint != 1);
  }
}

TEST_F(BusFaults, AreNoneWhileTheModulesAreSwitchedOn) {
  ExaminedBus bus(scenario_);
  const BusObservations seen = bus.examine();
  EXPECT_EQ(text_of(findings_of(seen)), "no fault found");
  for (const host::ObservedNode& node : seen.nodes) {
    EXPECT_EQ(node.boot_ups, 1U);
  }
}

TEST_F(BusFaults, AreNoneWhileAHostDrivesTheRobotWhichIsNotDisturbed) {
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Chances chances(seed);
    ExaminedBus bus(scenario_);
    bus.run_for(100'000);
    ASSERT_TRUE(bus.drive());
    bus.run_for(chances.between(0, second));
    const BusObservations seen = bus.examine();
    EXPECT_EQ(text_of(findings_of(seen)), "no fault found");
    EXPECT_EQ(seen.nodes.size(), joints);
    EXPECT_NEAR(seen.syncs, 100, 2) << "a second with a tick of 10 ms";
    EXPECT_EQ(seen.sync_jumps, 0U);
    EXPECT_EQ(bus.host().master().state(), canopen::MasterState::running);
    EXPECT_EQ(bus.host().master().problem().code, canopen::ProblemCode::none);
    for (unsigned joint = 0; joint < joints; ++joint) {
      EXPECT_EQ(bus.robot().module(joint).power(), canopen::PowerState::operation_enabled);
    }
  }
}

TEST_F(BusFaults, AreNoneAfterTheSetUpAlthoughNoServoHasPower) {
  ExaminedBus bus(scenario_);
  bus.run_for(100'000);
  for (unsigned joint = 0; joint < joints; ++joint) {
    ASSERT_TRUE(bus.adapter().send(canopen::encode(canopen::NmtRequest{canopen::NmtCommand::reset_node, node(joint)})));
  }
  bus.run_for(100'000);
  EXPECT_EQ(text_of(findings_of(bus.examine())), "no fault found");
}

// The wires.

TEST_F(BusFaults, NobodyAcknowledges) {
  expect_first("no_acknowledgement", [](ExaminedBus& bus, Chances& /*chances*/) {
    bus.unplug_modules();
    return std::vector<std::uint8_t>{};
  });
}

TEST_F(BusFaults, AnotherBitRate) {
  expect_first("wrong_bit_rate", [](ExaminedBus& bus, Chances& chances) {
    EXPECT_TRUE(bus.drive());
    bus.run_for(chances.between(0, second));
    bus.bus().set_error_rule([](const CanFrame& /*frame*/, std::uint64_t /*transmission*/) { return true; });
    bus.run_for(second);
    // As if the adapter was plugged in now.
    return std::vector<std::uint8_t>{};
  });
}

TEST_F(BusFaults, AShortCircuitHoldsTheBusDominant) {
  expect_first("wrong_bit_rate", [](ExaminedBus& bus, Chances& /*chances*/) {
    bus.bus().hold_dominant(true);
    return std::vector<std::uint8_t>{};
  });
}

TEST_F(BusFaults, AMissingTerminatorDamagesSomeFrames) {
  expect_first("damaged_frames", [](ExaminedBus& bus, Chances& chances) {
    EXPECT_TRUE(bus.drive());
    const std::uint64_t one_in = chances.between(15, 40);
    bus.bus().set_error_rule([one_in](const CanFrame& /*frame*/, std::uint64_t transmission) {
      return transmission * 0x9E3779B97F4A7C15U % one_in == 0;
    });
    return std::vector<std::uint8_t>{};
  });
}

TEST_F(BusFaults, TheOwnAdapterCannotSend) {
  expect_first("bus_off", [](ExaminedBus& bus, Chances& chances) {
    EXPECT_TRUE(bus.drive());
    bus.run_for(chances.between(0, second));
    // What it sends is damaged by its own transceiver: requests of LSS and SDO. The host has none under way now.
    bus.bus().set_error_rule([](const CanFrame& frame, std::uint64_t /*transmission*/) {
      return frame.identifier == canopen::identifier::lss_request ||
             canopen::identifier::base_of(frame.identifier) == canopen::identifier::sdo_request;
    });
    return std::vector<std::uint8_t>{};
  });
}

TEST_F(BusFaults, TheOwnAdapterIsErrorPassive) {
  expect_first("error_passive", [](ExaminedBus& bus, Chances& chances) {
    const std::uint64_t good_after = chances.between(17, 24);  // 128 / 8 errors make it passive, 256 / 8 bus-off
    bus.bus().set_error_rule(
        [good_after, errors = std::uint64_t{0}](const CanFrame& frame, std::uint64_t /*transmission*/) mutable {
          return frame.identifier == canopen::identifier::lss_request && errors++ < good_after;
        });
    return std::vector<std::uint8_t>{};
  });
}

TEST_F(BusFaults, ANodeThatBabbles) {
  expect_first("bus_overload", [](ExaminedBus& bus, Chances& chances) {
    EXPECT_TRUE(bus.drive());
    const auto sender = static_cast<std::uint8_t>(chances.between(20, 30));
    const auto identifier = static_cast<std::uint16_t>(0x180 + sender);
    bus.add_sender().repeat(0, [identifier](unsigned n) {
      return CanFrame{identifier, 8, {static_cast<std::uint8_t>(n)}};
    });
    return std::vector<std::uint8_t>{sender};
  });
}

// The nodes.

TEST_F(BusFaults, TwoModulesWithOneNodeIdThatStoppedWhenTheyBooted) {
  unsigned first = 0;
  unsigned second_joint = 0;
  expect_first(
      "duplicate_node_id",
      [&](ExaminedBus& /*bus*/, Chances& /*chances*/) { return std::vector<std::uint8_t>{node(first)}; },
      [&](Chances& chances) {
        first = chances.joint();
        second_joint = static_cast<unsigned>((first + chances.between(1, joints - 1)) % joints);
        sim::LiveRobotOptions options;
        options.change_identity = [&](unsigned joint, firmware::ModuleIdentity& identity) {
          identity.node = joint == second_joint ? node(first) : identity.node;
        };
        return options;
      });
}

TEST_F(BusFaults, AModuleWithAForeignNodeIdIsPluggedInWhileSomebodyLooks) {
  expect_first("duplicate_node_id", [this](ExaminedBus& bus, Chances& chances) {
    const std::uint8_t twin = node(chances.joint());
    Sender& sender = bus.add_sender();
    bus.at(bus.now() + chances.between(0, second / 2), [&sender, twin] {
      sender.repeat(1'000'000 * millisecond, [twin](unsigned /*n*/) {
        return canopen::encode(canopen::Heartbeat{twin, canopen::NmtState::boot_up});
      });
    });
    return std::vector<std::uint8_t>{twin};
  });
}

TEST_F(BusFaults, TwoHosts) {
  expect_first("two_hosts", [](ExaminedBus& bus, Chances& chances) {
    EXPECT_TRUE(bus.drive());
    bus.run_for(chances.between(0, 100'000));
    bus.add_sender().repeat(100 * millisecond, [](unsigned /*n*/) {
      return canopen::encode(canopen::Heartbeat{canopen::host_node, canopen::NmtState::operational});
    });
    return std::vector<std::uint8_t>{};
  });
}

TEST_F(BusFaults, TwoProducersOfSync) {
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Chances chances(seed);
    ExaminedBus bus(scenario_);
    bus.run_for(100'000);
    ASSERT_TRUE(bus.drive());
    bus.run_for(chances.between(0, second));
    const auto first_tick = static_cast<std::uint32_t>(chances.between(0, 127));
    bus.add_sender().repeat(10 * millisecond,
                            [first_tick](unsigned n) { return canopen::encode_sync(first_tick + n); });
    const auto findings = findings_of(bus.examine());
    ASSERT_FALSE(findings.empty());
    EXPECT_EQ(findings.front().code, "two_sync_producers") << text_of(findings);
    EXPECT_EQ(findings.size(), 1U) << text_of(findings);
  }
}

TEST_F(BusFaults, NobodyProducesSync) {
  expect_first("sync_missing", [this](ExaminedBus& bus, Chances& chances) {
    EXPECT_TRUE(bus.drive());
    bus.run_for(chances.between(0, second));
    const host::BusObservations before = bus.examine();
    const auto producer =
        std::ranges::find_if(before.nodes, [](const host::ObservedNode& one) { return one.produces_sync; });
    EXPECT_NE(producer, before.nodes.end());
    std::vector<std::uint8_t> others;
    for (unsigned joint = 0; joint < joints; ++joint) {
      if (node(joint) == producer->node) {
        bus.bus().controller(bus.robot().module(joint).controller()).unplug();
      } else {
        others.push_back(node(joint));
      }
    }
    bus.end_host();
    bus.run_for(second);
    std::ranges::sort(others);
    return others;
  });
}

TEST_F(BusFaults, AModuleThatRestartsAgainAndAgain) {
  expect_first("restarting_module", [this](ExaminedBus& bus, Chances& chances) {
    const unsigned joint = chances.joint();
    const Microseconds period = chances.between(300'000, 1'200'000);
    for (Microseconds time = bus.now() + chances.between(0, period); time < bus.now() + 20 * second; time += period) {
      bus.at(time, [&bus, joint] { bus.robot().module(joint).power_on(bus.robot().now()); });
    }
    return std::vector<std::uint8_t>{node(joint)};
  });
}

TEST_F(BusFaults, AModuleWithoutANodeId) {
  expect_first(
      "module_without_node_id", [](ExaminedBus& /*bus*/, Chances& /*chances*/) { return std::vector<std::uint8_t>{}; },
      [](Chances& chances) {
        const unsigned fresh = chances.joint();
        sim::LiveRobotOptions options;
        options.change_identity = [fresh](unsigned joint, firmware::ModuleIdentity& identity) {
          identity.node = joint == fresh ? 0 : identity.node;
        };
        return options;
      });
}

TEST_F(BusFaults, AModuleThatWasStopped) {
  expect_first("stopped_module", [this](ExaminedBus& bus, Chances& chances) {
    const std::uint8_t stopped = node(chances.joint());
    EXPECT_TRUE(bus.adapter().send(canopen::encode(canopen::NmtRequest{canopen::NmtCommand::stop, stopped})));
    bus.run_for(100'000);
    return std::vector<std::uint8_t>{stopped};
  });
}

// The modules themselves.

TEST_F(BusFaults, AServoThatTookTooMuchCurrent) {
  expect_first("over_current", [this](ExaminedBus& bus, Chances& chances) {
    EXPECT_TRUE(bus.drive());
    bus.run_for(chances.between(0, second));
    const unsigned joint = chances.joint();
    bus.robot().plant().jam(joint, static_cast<std::uint32_t>(chances.between(2'500, 4'000)));
    bus.run_for(2 * second);
    EXPECT_EQ(bus.robot().module(joint).power(), canopen::PowerState::fault);
    return std::vector<std::uint8_t>{node(joint)};
  });
}

TEST_F(BusFaults, AModuleThatIsTooHot) {
  unsigned hot = 0;
  std::int8_t temperature = 25;
  expect_first(
      "over_temperature",
      [&](ExaminedBus& bus, Chances& chances) {
        const bool is_hot_at_the_start = chances.between(0, 1) == 1;
        temperature = is_hot_at_the_start ? 96 : 25;
        EXPECT_EQ(bus.drive(), !is_hot_at_the_start) << "the fault is what matters, not that the start fails";
        bus.run_for(chances.between(0, second));
        temperature = static_cast<std::int8_t>(chances.between(96, 110));
        bus.run_for(second);
        return std::vector<std::uint8_t>{node(hot)};
      },
      [&](Chances& chances) {
        hot = chances.joint();
        temperature = 25;
        sim::LiveRobotOptions options;
        options.make_module = [&](const sim::ModuleParts& parts) -> std::unique_ptr<sim::JointModule> {
          if (parts.joint != hot) {
            return nullptr;
          }
          return std::make_unique<sim::NativeModule>(parts.bus, parts.identity, parts.crystal, parts.sensors,
                                                     [take = parts.take_readings, &temperature] {
                                                       ServoReadings readings = take();
                                                       readings.temperature_c = temperature;
                                                       return readings;
                                                     });
        };
        return options;
      });
}

TEST_F(BusFaults, AModuleWithTooLittleVoltage) {
  expect_first("supply_low", [this](ExaminedBus& bus, Chances& chances) {
    EXPECT_TRUE(bus.drive());
    bus.run_for(chances.between(0, second));
    const unsigned joint = chances.joint();
    bus.robot().module(joint).set_supply(bus.robot().now(), 2'700);
    bus.run_for(100'000);
    EXPECT_EQ(bus.robot().module(joint).power(), canopen::PowerState::fault);
    return std::vector<std::uint8_t>{node(joint)};
  });
}

TEST_F(BusFaults, AModuleWithAnotherCore) {
  unsigned other = 0;
  expect_first(
      "other_core", [&](ExaminedBus& /*bus*/, Chances& /*chances*/) { return std::vector<std::uint8_t>{node(other)}; },
      [&other](Chances& chances) {
        other = chances.joint();
        sim::LiveRobotOptions options;
        options.change_identity = [&other](unsigned joint, firmware::ModuleIdentity& identity) {
          identity.core_fingerprint ^= joint == other ? 1U : 0U;
        };
        return options;
      });
}

TEST_F(BusFaults, AModuleThatItsWatchdogHasReset) {
  unsigned reset = 0;
  expect_first(
      "module_was_reset",
      [&](ExaminedBus& /*bus*/, Chances& /*chances*/) { return std::vector<std::uint8_t>{node(reset)}; },
      [&reset](Chances& chances) {
        reset = chances.joint();
        sim::LiveRobotOptions options;
        options.change_identity = [&reset](unsigned joint, firmware::ModuleIdentity& identity) {
          identity.reset_cause = joint == reset ? firmware::ResetCause::watchdog : identity.reset_cause;
        };
        return options;
      });
}

TEST_F(BusFaults, ARobotWhoseHostDied) {
  expect_first("quick_stop", [](ExaminedBus& bus, Chances& chances) {
    EXPECT_TRUE(bus.drive());
    bus.run_for(chances.between(0, second));
    bus.end_host();
    bus.run_for(second);
    return std::vector<std::uint8_t>{1, 2, 3, 4, 5};
  });
}

}  // namespace
}  // namespace proleg::test
