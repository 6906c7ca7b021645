// Robots on virtual time with modules that do not start, or do not answer: each comes back, and the others are left
// alone.

#include "tools/proleg/flash/recovery.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>

#include "flashed_robot.hpp"
#include "live_transport.hpp"
#include "shared/canopen/declared_objects.hpp"

namespace proleg::test {
namespace {

using host::ModuleFaultKind;
using host::Remedy;
using tools::RecoveredModule;
using tools::Recovery;
using tools::RecoverySettings;
using tools::SupplyWait;
namespace flag = broadcast::module_flag;

constexpr unsigned joints = 5;

/// What goes over the bus while it exists.
class Traffic final : public host::BusUser {
 public:
  explicit Traffic(LiveBus& bus) : bus_(bus) { bus_.attach(*this); }
  ~Traffic() { bus_.detach(*this); }
  Traffic(const Traffic&) = delete;
  Traffic& operator=(const Traffic&) = delete;

  void receive(Microseconds /*now*/, const CanFrame& frame) override {
    const auto heartbeat = canopen::decode_heartbeat(frame);
    boot_ups[heartbeat ? heartbeat->node : 0] += heartbeat && heartbeat->state == canopen::NmtState::boot_up ? 1 : 0;
  }
  void requested(Microseconds /*now*/, const CanFrame& frame) override {
    using broadcast::Code;
    using canopen::lss::Service;
    const std::uint8_t first = frame.data[0];
    // Modules whose program runs ignore the request for every module.
    const bool is_transfer =
        frame.identifier == broadcast::host_identifier && frame != broadcast::enter_frame(broadcast::every_serial) &&
        (frame.length == CanFrame::max_length || first == static_cast<std::uint8_t>(Code::select) ||
         first == static_cast<std::uint8_t>(Code::install) || first == static_cast<std::uint8_t>(Code::enter));
    const bool is_numbering = frame.identifier == canopen::identifier::lss_request &&
                              (first == static_cast<std::uint8_t>(Service::configure_node_id) ||
                               first == static_cast<std::uint8_t>(Service::store_configuration));
    constexpr std::uint8_t sdo_command = 0xE0;
    constexpr std::uint8_t sdo_download = 0x20;
    const bool is_write = canopen::identifier::base_of(frame.identifier) == canopen::identifier::sdo_request &&
                          (first & sdo_command) == sdo_download;
    changes += is_transfer || is_numbering || is_write || frame.identifier == canopen::identifier::nmt ? 1U : 0U;
  }

  std::map<std::uint8_t, int> boot_ups;  ///< by node
  unsigned changes = 0;                  ///< requests that change a module

 private:
  LiveBus& bus_;
};

/// A person switches the supply of the robot off or on at this time.
class SupplySwitch final : public host::BusUser {
 public:
  SupplySwitch(FlashedRobot& robot, Microseconds at, bool on) : robot_(robot), at_(at), on_(on) {
    robot_.bus.attach(*this);
  }
  ~SupplySwitch() { robot_.bus.detach(*this); }
  SupplySwitch(const SupplySwitch&) = delete;
  SupplySwitch& operator=(const SupplySwitch&) = delete;

  void receive(Microseconds /*now*/, const CanFrame& /*frame*/) override {}
  void poll(Microseconds /*now*/) override {
    at_ = never;
    for (unsigned joint = 0; joint < robot_.size(); ++joint) {
      robot_.module(joint).set_supply(robot_.bus.robot().bus().now(), on_ ? 3'300 : 0);
    }
  }
  [[nodiscard]] Microseconds next_deadline() const override { return at_; }

 private:
  FlashedRobot& robot_;
  Microseconds at_;
  bool on_;
};

/// Joint j has the node id j + 1, unless it is given.
class SickRobot : public FlashedRobot {
 public:
  using Nodes = std::vector<std::uint8_t>;
  explicit SickRobot(const Nodes& nodes = {}) : FlashedRobot("travelling_wave/uniform", with(nodes)) {
    for (unsigned joint = 0; joint < joints; ++joint) {
      EXPECT_TRUE(program(joint).bootloader() == nullptr);
    }
  }

  /// The program 0.1.0 of the module does that from now on; others are good.
  void spoil(unsigned joint, sim::ProgramHealth health) {
    program(joint).set_health([health](const image::Header& header) {
      return header.version.minor == 1 ? health : sim::ProgramHealth::good;
    });
    power_cycle(joint);
  }
  /// All modules listen after power on. The program 0.1.0 of one is deaf from its next start on.
  void make_deaf(unsigned joint) {
    for (unsigned one = 0; one < joints; ++one) {
      module(one).set_start_time(sim::NativeProgram::start_time_us);
    }
    spoil(joint, sim::ProgramHealth::deaf);
    bus.run_for(second);
  }
  void take_program(unsigned joint) {
    program(joint).write_image({}, false);
    power_cycle(joint);
  }
  void give_newer_settings(unsigned joint) {
    module(joint).write_settings(known_schema + 1);
    power_cycle(joint);
  }
  [[nodiscard]] std::uint8_t node(unsigned joint) { return ask(joint).status.condition.node; }
  [[nodiscard]] bool runs(unsigned joint) {
    const host::ModuleProgram program = ask(joint);
    return program.has_answered && program.is(flag::runs_program) && program.is(flag::is_confirmed);
  }

  static constexpr std::uint8_t known_schema = firmware::BoardRecord::schema;

 private:
  static sim::LiveRobotOptions with(const Nodes& nodes) {
    sim::LiveRobotOptions options;
    options.change_identity = [nodes](unsigned joint, firmware::ModuleIdentity& identity) {
      identity.node = joint < nodes.size() ? nodes[joint] : static_cast<std::uint8_t>(joint + 1);
    };
    return options;
  }
};

host::ImageFile file_of(std::vector<std::uint8_t> bytes) { return {image::decode(bytes).header, std::move(bytes)}; }

RecoverySettings with_image(std::vector<std::uint8_t> bytes = new_image) {
  RecoverySettings settings;
  settings.image = file_of(std::move(bytes));
  return settings;
}

std::vector<std::uint8_t> image_with_schema(std::uint8_t schema) {
  std::vector<std::uint8_t> bytes = new_image;
  image::Header header = image::decode(bytes).header;
  header.settings_schema = schema;
  std::ranges::copy(image::encode(header), bytes.begin());
  return bytes;
}

bool begins(const SupplyWait& wait) { return wait.rest == wait.longest; }

/// What proleg recover does on the bus of a robot, and what it knows then.
class Recovered {
 public:
  explicit Recovered(SickRobot& robot, const RecoverySettings& settings = {}, bool only_examines = false)
      : robot_(robot),
        settings_(settings),
        access_([&robot](host::TransportListener& listener) {
          return std::make_unique<LiveTransport>(robot.bus, listener);
        }),
        recovery(access_, settings_) {
    recovery.examine();
    if (!only_examines) {
      recovery.recover();
    }
  }
  [[nodiscard]] const RecoveredModule& of(unsigned joint) const {
    const auto found = std::ranges::find_if(recovery.modules(), [&](const RecoveredModule& module) {
      return module.now.program.serial == robot_.serials[joint];
    });
    EXPECT_NE(found, recovery.modules().end()) << "joint " << joint;
    return *found;
  }
  /// Only these faults, of only this module.
  void expect_found(unsigned joint, const std::vector<ModuleFaultKind>& kinds) const {
    for (unsigned other = 0; other < joints; ++other) {
      SCOPED_TRACE("joint " + std::to_string(other));
      std::vector<ModuleFaultKind> found;
      for (const host::ModuleFault& fault : of(other).first_faults) {
        found.push_back(fault.kind);
      }
      EXPECT_EQ(found, other == joint ? kinds : std::vector<ModuleFaultKind>());
    }
  }
  void expect_well() const {
    for (const RecoveredModule& module : recovery.modules()) {
      EXPECT_TRUE(module.is_well()) << int{module.now.node} << ": "
                                    << (module.faults.empty() ? "" : module.faults.front().text) << "; "
                                    << module.problem;
    }
    EXPECT_EQ(recovery.modules().size(), joints);
    EXPECT_TRUE(recovery.are_all_well());
  }

 private:
  SickRobot& robot_;
  RecoverySettings settings_;
  tools::BusAccess access_;

 public:
  Recovery recovery;
};

TEST(RecoveryTest, ModulesThatAreWellAreLeftAlone) {
  SickRobot robot;
  Traffic traffic(robot.bus);
  const Recovered recovered(robot, with_image());
  recovered.expect_well();
  EXPECT_EQ(traffic.changes, 0U);
  for (unsigned joint = 0; joint < joints; ++joint) {
    EXPECT_EQ(robot.minor_version(joint), 1U);
    EXPECT_EQ(traffic.boot_ups[static_cast<std::uint8_t>(joint + 1)], 0);
  }
}

TEST(RecoveryTest, AModuleWithoutAProgramGetsTheImageAndNoOtherDoes) {
  SickRobot robot;
  robot.take_program(2);
  Traffic traffic(robot.bus);
  const Recovered recovered(robot, with_image());
  recovered.expect_found(2, {ModuleFaultKind::no_program});
  recovered.expect_well();
  for (unsigned joint = 0; joint < joints; ++joint) {
    EXPECT_EQ(robot.minor_version(joint), joint == 2 ? 2U : 1U);
    EXPECT_TRUE(joint == 2 || traffic.boot_ups[static_cast<std::uint8_t>(joint + 1)] == 0);
  }
}

TEST(RecoveryTest, WithoutAnImageAPersonReadsWhichCommandIsMissing) {
  SickRobot robot;
  robot.take_program(2);
  Traffic traffic(robot.bus);
  const Recovered recovered(robot);
  EXPECT_FALSE(recovered.recovery.are_all_well());
  ASSERT_EQ(recovered.of(2).faults.size(), 1U);
  EXPECT_EQ(recovered.of(2).faults[0].remedy, Remedy::by_hand);
  EXPECT_NE(recovered.of(2).faults[0].to_do.find("proleg recover IMAGE.pimg"), std::string::npos);
  EXPECT_EQ(traffic.changes, 0U);
}

TEST(RecoveryTest, AProgramThatHangsOrFaultsIsCaughtInItsBootloaderAtAnyMoment) {
  for (const sim::ProgramHealth health : {sim::ProgramHealth::hangs, sim::ProgramHealth::faults}) {
    // It starts five times, then waits in its bootloader for ten seconds: some 15 s in all.
    for (Microseconds moment = 0; moment <= 16 * second; moment += 2 * second) {
      SCOPED_TRACE(moment);
      SickRobot robot;
      robot.spoil(1, health);
      robot.bus.run_for(moment);
      const Recovered recovered(robot, with_image());
      recovered.expect_found(1, {ModuleFaultKind::starts_badly});
      recovered.expect_well();
      EXPECT_EQ(robot.minor_version(1), 2U);
      EXPECT_TRUE(robot.runs(1));
    }
  }
}

TEST(RecoveryTest, ModulesStayInTheirBootloadersUntilItIsTheirTurn) {
  SickRobot robot;
  unsigned starts = 0;
  robot.program(1).set_health([&starts](const image::Header& header) {
    starts += header.version.minor == 1 ? 1U : 0U;
    return header.version.minor == 1 ? sim::ProgramHealth::hangs : sim::ProgramHealth::good;
  });
  robot.power_cycle(1);
  RecoverySettings settings = with_image();
  settings.wait_us = 60 * second;
  Recovered(robot, settings).expect_well();
  EXPECT_EQ(starts, bootloader::max_bad_starts) << "not once more in a minute";
}

TEST(RecoveryTest, AProgramThatIsDeafIsReplacedWhenAPersonSwitchesTheSupplyOffAndOn) {
  for (const Microseconds off_for : {second / 10, 3 * second}) {
    SickRobot robot;
    robot.make_deaf(1);
    RecoverySettings settings = with_image();
    settings.wait_us = 10 * second;
    std::optional<SupplySwitch> off;
    std::optional<SupplySwitch> on;
    settings.on_wait = [&](const SupplyWait& wait) {
      if (begins(wait)) {
        off.emplace(robot, robot.bus.now() + second, false);
        on.emplace(robot, robot.bus.now() + second + off_for, true);
      }
    };
    const Recovered recovered(robot, settings);
    ASSERT_EQ(recovered.of(1).first_faults.size(), 1U);
    EXPECT_EQ(recovered.of(1).first_faults[0].kind, ModuleFaultKind::silent_program);
    recovered.expect_well();
    for (unsigned joint = 0; joint < joints; ++joint) {
      EXPECT_EQ(robot.minor_version(joint), joint == 1 ? 2U : 1U) << "the others only start again";
      EXPECT_TRUE(robot.runs(joint));
    }
  }
}

TEST(RecoveryTest, AModuleThatALookHasLeftInItsBootloaderIsReplacedWhenItsProgramIsDeaf) {
  for (const bool is_person_there : {true, false}) {
    SickRobot robot;
    robot.make_deaf(1);
    std::optional<SupplySwitch> off;
    std::optional<SupplySwitch> on;
    unsigned waits = 0;
    const auto switch_in_wait = [&](unsigned number) {
      RecoverySettings settings = with_image();
      waits = 0;
      settings.on_wait = [&, number](const SupplyWait& wait) {
        if (begins(wait) && ++waits == number) {
          off.emplace(robot, robot.bus.now() + second, false);
          on.emplace(robot, robot.bus.now() + 2 * second, true);
        }
      };
      return settings;
    };
    static_cast<void>(Recovered(robot, switch_in_wait(1), true));
    // In its first wait this one finds the module in its bootloader, as it finds one with a good program.
    const Recovered recovered(robot, switch_in_wait(is_person_there ? 2 : 0));
    EXPECT_EQ(waits, 2U);
    EXPECT_EQ(recovered.of(1).first_faults.front().kind, ModuleFaultKind::in_bootloader);
    EXPECT_EQ(recovered.of(1).is_present, is_person_there);
    EXPECT_EQ(recovered.recovery.are_all_well(), is_person_there);
    for (unsigned joint = 0; joint < joints; ++joint) {
      EXPECT_EQ(robot.minor_version(joint), is_person_there && joint == 1 ? 2U : 1U);
    }
  }
}

TEST(RecoveryTest, WithoutAPersonADeafProgramIsOutOfReachAndItsModuleIsMissing) {
  SickRobot robot;
  robot.make_deaf(1);
  RecoverySettings settings = with_image();
  settings.serials = {robot.serials[1]};
  const Recovered recovered(robot, settings);
  EXPECT_EQ(recovered.recovery.missing(), settings.serials);
  EXPECT_EQ(robot.minor_version(1), 1U);
}

TEST(RecoveryTest, ARobotWhoseSupplyComesOnlyThenKeepsItsProgramsUnlessAModuleIsNamed) {
  for (const bool names : {false, true}) {
    SickRobot robot;
    robot.make_deaf(1);
    RecoverySettings settings = with_image();
    settings.wait_us = 10 * second;
    const SupplySwitch off(robot, robot.bus.now(), false);
    std::optional<SupplySwitch> on;
    settings.on_wait = [&](const SupplyWait& wait) {
      if (begins(wait)) {
        on.emplace(robot, robot.bus.now() + second, true);
      }
    };
    if (names) {
      settings.serials = {robot.serials[1]};
    }
    const Recovered recovered(robot, settings);
    for (unsigned joint = 0; joint < joints; ++joint) {
      EXPECT_EQ(robot.minor_version(joint), names && joint == 1 ? 2U : 1U);
    }
    EXPECT_EQ(recovered.recovery.are_all_well(), names);
  }
}

TEST(RecoveryTest, AModuleThatNothingHelpsIsKnownInTheEndToo) {
  SickRobot robot;
  robot.spoil(1, sim::ProgramHealth::hangs);
  robot.take_program(2);
  // It has this program already, which hangs.
  const Recovered recovered(robot, with_image(sim::make_native_image(1, {0, 1, 0}, body_size)));
  EXPECT_TRUE(recovered.of(2).is_well());
  EXPECT_TRUE(recovered.of(1).is_present);
  ASSERT_EQ(recovered.of(1).faults.size(), 1U);
  EXPECT_EQ(recovered.of(1).faults[0].kind, ModuleFaultKind::starts_badly);
}

TEST(RecoveryTest, TheProgramThatDoesNotStartIsNotSentAgain) {
  SickRobot robot;
  robot.spoil(1, sim::ProgramHealth::faults);
  Traffic traffic(robot.bus);
  const Recovered recovered(robot, with_image(sim::make_native_image(1, {0, 1, 0}, body_size)));
  ASSERT_EQ(recovered.of(1).faults.size(), 1U);
  EXPECT_EQ(recovered.of(1).faults[0].remedy, Remedy::by_hand);
  EXPECT_EQ(traffic.changes, 0U);
}

TEST(RecoveryTest, AnImageThatDoesNotStartEitherIsNoSuccess) {
  SickRobot robot;
  robot.program(1).set_health([](const image::Header& /*header*/) { return sim::ProgramHealth::hangs; });
  robot.take_program(1);
  const Recovered recovered(robot, with_image());
  EXPECT_FALSE(recovered.of(1).is_well());
  EXPECT_FALSE(recovered.of(1).problem.empty());
  EXPECT_TRUE(recovered.of(0).is_well());
}

TEST(RecoveryTest, AProgramThatWaitsInTheBootloaderIsStartedWithoutAnImage) {
  SickRobot robot;
  ASSERT_TRUE(robot.bus.send(broadcast::enter_frame(robot.serials[3])));
  robot.bus.run_for(second);
  ASSERT_TRUE(robot.program(3).bootloader() != nullptr);
  const Recovered recovered(robot);
  recovered.expect_found(3, {ModuleFaultKind::in_bootloader});
  recovered.expect_well();
  EXPECT_TRUE(robot.runs(3));
}

TEST(RecoveryTest, AGoodProgramOnTrialIsStartedAndConfirmsItself) {
  SickRobot robot;
  robot.program(3).write_image(new_image, false);
  robot.program(3).enter_bootloader();
  robot.bus.run_for(second);
  ASSERT_TRUE(robot.program(3).bootloader() != nullptr);
  const Recovered recovered(robot, with_image(sim::make_native_image(1, {0, 3, 0}, body_size)));
  recovered.expect_found(3, {ModuleFaultKind::never_confirmed});
  recovered.expect_well();
  EXPECT_EQ(robot.minor_version(3), 2U) << "it needs no other one";
}

TEST(RecoveryTest, AProgramThatHasUsedUpItsTrialsIsReplaced) {
  SickRobot robot;
  robot.program(3).write_image(sim::make_native_image(1, {0, 1, 0}, body_size), false);
  robot.spoil(3, sim::ProgramHealth::hangs);
  const Recovered without(robot);
  without.expect_found(3, {ModuleFaultKind::never_confirmed});
  ASSERT_EQ(without.of(3).faults.size(), 1U);
  EXPECT_EQ(without.of(3).faults[0].remedy, Remedy::by_hand);
  const Recovered recovered(robot, with_image());
  recovered.expect_well();
  EXPECT_EQ(robot.minor_version(3), 2U);
}

TEST(RecoveryTest, AModuleWithoutANodeIdGetsAFreeOneAndKeepsIt) {
  SickRobot robot({1, 0, 3, 4, 5});
  const Recovered recovered(robot);
  recovered.expect_found(1, {ModuleFaultKind::no_node_id});
  recovered.expect_well();
  EXPECT_EQ(robot.node(1), 2);
  robot.power_cycle(1);
  robot.bus.run_for(second);
  EXPECT_EQ(robot.node(1), 2);
}

TEST(RecoveryTest, AModuleWithoutProgramAndNodeIdGetsBoth) {
  SickRobot robot({1, 2, 3, 0, 5});
  robot.take_program(3);
  const Recovered recovered(robot, with_image());
  recovered.expect_found(3, {ModuleFaultKind::no_program, ModuleFaultKind::no_node_id});
  recovered.expect_well();
  EXPECT_EQ(robot.minor_version(3), 2U);
  EXPECT_EQ(robot.node(3), 4);
}

TEST(RecoveryTest, OfModulesWithOneNodeIdOneKeepsItAndTheOthersGetFreeOnes) {
  for (const SickRobot::Nodes& nodes : {SickRobot::Nodes{1, 2, 3, 4, 2}, SickRobot::Nodes{2, 2, 3, 4, 2}}) {
    SickRobot robot(nodes);
    Traffic traffic(robot.bus);
    const Recovered recovered(robot);
    recovered.expect_well();
    std::vector<std::uint8_t> ids;
    for (unsigned joint = 0; joint < joints; ++joint) {
      robot.power_cycle(joint);
    }
    EXPECT_EQ(traffic.boot_ups[3], 0) << "the others did not restart";
    EXPECT_EQ(traffic.boot_ups[4], 0);
    robot.bus.run_for(second);
    for (unsigned joint = 0; joint < joints; ++joint) {
      ids.push_back(robot.node(joint));
    }
    std::ranges::sort(ids);
    EXPECT_EQ(ids, (std::vector<std::uint8_t>{1, 2, 3, 4, 5}));
  }
}

TEST(RecoveryTest, ModulesThatHaveOneNodeIdAndHangComeBack) {
  SickRobot robot({1, 2, 3, 4, 2});
  robot.spoil(1, sim::ProgramHealth::hangs);
  robot.spoil(4, sim::ProgramHealth::hangs);
  {
    const Recovered without(robot);
    EXPECT_NE(without.of(1).now.node, without.of(4).now.node) << "that needs no image";
    EXPECT_FALSE(without.of(1).is_well());
  }
  const Recovered recovered(robot, with_image());
  recovered.expect_well();
  EXPECT_NE(robot.node(1), robot.node(4));
}

TEST(RecoveryTest, AStoppedModuleIsRestarted) {
  SickRobot robot;
  ASSERT_TRUE(robot.bus.send(canopen::encode(canopen::NmtRequest{canopen::NmtCommand::stop, 4})));
  robot.bus.run_for(second / 2);
  const Recovered recovered(robot);
  recovered.expect_found(3, {ModuleFaultKind::stopped});
  recovered.expect_well();
}

TEST(RecoveryTest, SettingsThatTheProgramDoesNotKnowAreResetOnlyOnRequest) {
  SickRobot robot;
  robot.give_newer_settings(2);
  robot.bus.run_for(second);
  {
    const Recovered without(robot);
    without.expect_found(2, {ModuleFaultKind::newer_settings});
    EXPECT_FALSE(without.of(2).is_well());
    EXPECT_TRUE(robot.ask(2).is(flag::has_newer_settings));
  }
  RecoverySettings settings;
  settings.resets_settings = true;
  const Recovered recovered(robot, settings);
  recovered.expect_well();
  robot.power_cycle(2);
  robot.bus.run_for(second);
  EXPECT_FALSE(robot.ask(2).is(flag::has_newer_settings));
  EXPECT_EQ(robot.node(2), 3) << "the node id stays";
}

TEST(RecoveryTest, AProgramThatKnowsTheSettingsIsFlashed) {
  SickRobot robot;
  robot.give_newer_settings(2);
  robot.bus.run_for(second);
  // Every native program is this one. It knows what is written in its own schema.
  robot.program(2).set_health([&robot](const image::Header& header) {
    if (header.settings_schema > SickRobot::known_schema) {
      robot.module(2).write_settings(SickRobot::known_schema);
    }
    return sim::ProgramHealth::good;
  });
  {
    const Recovered same(robot, with_image(image_with_schema(SickRobot::known_schema)));
    EXPECT_EQ(robot.minor_version(2), 1U) << "an image that does not know them is not flashed";
    EXPECT_FALSE(same.of(2).is_well());
  }
  const Recovered recovered(robot, with_image(image_with_schema(SickRobot::known_schema + 1)));
  recovered.expect_well();
  EXPECT_EQ(robot.minor_version(2), 2U);
}

TEST(RecoveryTest, AProgramWithAHigherSchemaThatDoesNotKnowThemEitherIsNoSuccess) {
  SickRobot robot;
  robot.give_newer_settings(2);
  robot.bus.run_for(second);
  const Recovered recovered(robot, with_image(image_with_schema(SickRobot::known_schema + 1)));
  EXPECT_EQ(robot.minor_version(2), 2U);
  EXPECT_FALSE(recovered.recovery.are_all_well());
  EXPECT_TRUE(recovered.of(0).is_well());
}

TEST(RecoveryTest, AnExaminationChangesNothing) {
  SickRobot robot({1, 2, 3, 0, 2});
  robot.take_program(2);
  robot.spoil(0, sim::ProgramHealth::hangs);
  Traffic traffic(robot.bus);
  const Recovered examined(robot, with_image(), true);
  EXPECT_EQ(traffic.changes, 0U);
  EXPECT_FALSE(examined.recovery.are_all_well());
  EXPECT_EQ(examined.of(0).faults.front().kind, ModuleFaultKind::starts_badly);
  EXPECT_EQ(examined.of(2).faults.front().kind, ModuleFaultKind::no_program);
  EXPECT_EQ(examined.of(3).faults.front().kind, ModuleFaultKind::no_node_id);
  EXPECT_EQ(examined.of(4).faults.front().kind, ModuleFaultKind::duplicate_node_id);
}

TEST(RecoveryTest, TheWaitEndsWhenTheNamedModulesWereSeen) {
  SickRobot robot;
  RecoverySettings settings;
  settings.wait_us = 60 * second;
  settings.serials = {robot.serials[0], robot.serials[4]};
  const Microseconds begin = robot.bus.now();
  Recovered(robot, settings).expect_well();
  EXPECT_LT(robot.bus.now() - begin, 10 * second);

  robot.spoil(4, sim::ProgramHealth::hangs);
  settings.image = file_of(new_image);
  Recovered(robot, settings).expect_well();
  EXPECT_LT(robot.bus.now() - begin, 40 * second);
}

TEST(RecoveryTest, ANamedModuleThatIsNotSeenIsMissing) {
  SickRobot robot;
  robot.module(4).set_supply(robot.bus.robot().bus().now(), 0);
  RecoverySettings settings;
  settings.serials = {robot.serials[0], robot.serials[4]};
  const Recovered recovered(robot, settings);
  EXPECT_EQ(recovered.recovery.missing(), std::vector<std::uint32_t>{robot.serials[4]});
  EXPECT_FALSE(recovered.recovery.are_all_well());
}

TEST(RecoveryTest, SucceedsAlthoughATenthOfTheFramesIsLost) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    SickRobot robot({1, 2, 3, 0, 2});
    robot.take_program(2);
    robot.spoil(0, sim::ProgramHealth::hangs);
    robot.give_newer_settings(1);
    robot.bus.lose(0.1, seed);
    // The module that hangs is away for 5.5 s, then on the bus for 10 s, and so on.
    constexpr Microseconds later_each_time = 1'100'000;
    robot.bus.run_for(static_cast<Microseconds>(seed) * later_each_time);
    RecoverySettings settings = with_image();
    settings.resets_settings = true;
    const Recovered recovered(robot, settings);
    recovered.expect_well();
  }
}

TEST(RecoveryTest, ABusWithoutAModuleIsAnError) {
  SickRobot robot;
  for (unsigned joint = 0; joint < joints; ++joint) {
    robot.module(joint).set_supply(robot.bus.robot().bus().now(), 0);
  }
  EXPECT_THROW(Recovered{robot}, std::runtime_error);
}

}  // namespace
}  // namespace proleg::test
