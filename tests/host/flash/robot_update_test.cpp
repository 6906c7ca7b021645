// An image goes to the modules of a robot, and each runs it in the end, or the one before.

#include "host/flash/robot_update.hpp"

#include "examined_bus.hpp"
#include "flashed_robot.hpp"

namespace proleg::test {
namespace {

using host::ModuleProgram;
using host::RobotUpdate;
using host::UpdatedModule;
using host::UpdateOutcome;
namespace flag = broadcast::module_flag;

/// Another node on the bus, whose frames go before those of the transfer.
class OtherNode final : public host::BusUser {
 public:
  OtherNode(LiveBus& bus, sim::BusTime period) : sender_(bus.robot().bus()) {
    sender_.repeat(period, [](unsigned /*n*/) { return CanFrame{0x050, 8, {1, 2, 3, 4, 5, 6, 7, 8}}; });
  }

  void receive(Microseconds /*now*/, const CanFrame& /*frame*/) override {}
  void poll(Microseconds now) override { sender_.advance_to(now * 1'000); }
  [[nodiscard]] Microseconds next_deadline() const override { return sender_.next_event() / 1'000; }

 private:
  Sender sender_;
};

double seconds(Microseconds time) { return static_cast<double>(time) / 1e6; }

TEST(RobotUpdate, AllModulesRunTheImageAndKeepTheOneBeforeAsTheirBackup) {
  FlashedRobot robot;
  const auto update = robot.update(robot.size());
  for (unsigned joint = 0; joint < robot.size(); ++joint) {
    const UpdatedModule& module = update->modules()[joint];
    EXPECT_EQ(module.outcome, UpdateOutcome::runs) << describe(module.outcome, module.detail);
    EXPECT_EQ(module.serial, robot.serials[joint]);
    EXPECT_TRUE(std::ranges::equal(robot.program(joint).image(), new_image));
    EXPECT_EQ(image::decode(robot.program(joint).backup()).header.version, (image::Version{0, 1, 0}));
    EXPECT_NE(robot.module(joint).node(), 0);
  }
}

TEST(RobotUpdate, TwelveModulesWithMixedOldProgramsTakeLittleMoreTimeThanOne) {
  double of_one = 0;
  for (const std::size_t count : {std::size_t{1}, std::size_t{12}}) {
    FlashedRobot robot("long_chain/twenty");
    for (std::uint16_t joint = 1; joint < count; ++joint) {  // they run different programs
      const std::size_t size = 20'000U + 3'600U * joint;
      robot.program(joint).write_image(sim::make_native_image(1, {0, 1, joint}, size), true);
    }
    const auto update = robot.update(count);
    ASSERT_TRUE(std::ranges::all_of(update->modules(),
                                    [](const UpdatedModule& module) { return module.outcome == UpdateOutcome::runs; }));
    using Step = RobotUpdate::Step;
    const double transfer = seconds(update->duration(Step::transfer));
    const double installation = seconds(update->duration(Step::installation));
    const double all = transfer + installation + seconds(update->duration(Step::restart));
    std::printf(
        "%2zu modules, %zu bytes: transfer %.3f s (%.1f kB/s), installation %.3f s, restart, confirmation "
        "%.3f s, all %.3f s\n",
        count, new_image.size(), transfer, static_cast<double>(new_image.size()) / transfer / 1e3, installation,
        all - transfer - installation, all);
    EXPECT_LT(all, 5.0);
    of_one = count == 1 ? all : of_one;
    EXPECT_LT(all, 1.15 * of_one);
  }
}

TEST(RobotUpdate, SucceedsAlthoughATenthOfTheFramesIsLost) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE(seed);
    FlashedRobot robot;
    robot.bus.lose(0.1, seed);
    const auto update = robot.update(robot.size());
    for (const UpdatedModule& module : update->modules()) {
      EXPECT_EQ(module.outcome, UpdateOutcome::runs) << describe(module.outcome, module.detail);
    }
  }
}

TEST(RobotUpdate, AnAdapterThatConfirmsFramesBeforeTheyAreOnTheBusIsNotFlooded) {
  for (const bool has_traffic : {false, true}) {
    FlashedRobot robot;
    constexpr std::size_t room = 128;
    robot.bus.confirm_at_once(room);
    OtherNode other(robot.bus, 1'000'000);  // an eighth of the bus
    if (has_traffic) {
      robot.bus.attach(other);
    }
    const auto update = robot.update(robot.size());
    for (const UpdatedModule& module : update->modules()) {
      EXPECT_EQ(module.outcome, UpdateOutcome::runs) << describe(module.outcome, module.detail);
    }
    EXPECT_EQ(robot.bus.dropped_frames(), 0U);
    const double rate = static_cast<double>(new_image.size()) / seconds(update->duration(RobotUpdate::Step::transfer));
    std::printf("an adapter with room for %zu frames, %s: %.1f kB/s\n", room,
                has_traffic ? "an eighth of the bus in use" : "an idle bus", rate / 1e3);
    EXPECT_GT(rate, has_traffic ? 45e3 : 50e3);
  }
}

/// Modules that know no checksums of blocks, and an adapter that drops frames from the middle of one block to the
/// middle of the next: the modules take symbols of the one for those of the other.
class DamagedTransfer {
 public:
  /// The first `times` images do not arrive whole at the first `modules` modules.
  DamagedTransfer(FlashedRobot& robot, unsigned modules, unsigned times) {
    robot.bus.robot().bus().set_loss_rule([=, this](const CanFrame& frame, std::size_t receiver) {
      if (frame.identifier != broadcast::host_identifier) {
        return false;
      }
      constexpr auto begin = static_cast<unsigned>(broadcast::Code::begin);
      constexpr auto check = static_cast<unsigned>(broadcast::Code::check);
      const unsigned code = frame.length < CanFrame::max_length ? frame.data[0] : 0U;
      if (receiver == 0) {
        count_ = code == begin ? 0 : count_ + 1;
        images_ += code == begin && !was_begin_ ? 1U : 0U;
        was_begin_ = code == begin;
      }
      constexpr unsigned first_lost = 150;
      constexpr unsigned lost = broadcast::block_symbols + 8;  // and the frames that begin the next block
      return code == check ||
             (receiver < modules && images_ <= times && count_ >= first_lost && count_ < first_lost + lost);
    });
  }
  [[nodiscard]] unsigned images() const { return images_; }

 private:
  unsigned count_ = 0;
  unsigned images_ = 0;
  bool was_begin_ = false;
};

TEST(RobotUpdate, AnImageThatWasDamagedOnTheWayIsSentAgain) {
  for (const unsigned modules : {1U, 2U}) {
    FlashedRobot robot;
    const DamagedTransfer transfer(robot, modules, 2);
    const auto update = robot.update(2, new_image, {.session = 254});
    for (const UpdatedModule& module : update->modules()) {
      EXPECT_EQ(module.outcome, UpdateOutcome::runs) << describe(module.outcome, module.detail);
    }
    EXPECT_EQ(transfer.images(), 3U);
  }
}

TEST(RobotUpdate, AModuleToWhichNoImageComesWholeIsNamedAndRunsOn) {
  FlashedRobot robot;
  const DamagedTransfer transfer(robot, 1, 10);
  const auto update = robot.update(2);
  EXPECT_EQ(transfer.images(), 3U);
  EXPECT_EQ(update->modules()[0].outcome, UpdateOutcome::refused);
  EXPECT_EQ(static_cast<image::Error>(update->modules()[0].detail), image::Error::damaged_body);
  EXPECT_EQ(update->modules()[1].outcome, UpdateOutcome::runs);
  robot.bus.run_for(second);
  EXPECT_TRUE(robot.ask(0).is(flag::runs_program));
  EXPECT_EQ(robot.minor_version(0), 1U);
}

TEST(RobotUpdate, ABootloaderWithoutAProgramAndAModuleWithoutANodeIdTakePart) {
  sim::LiveRobotOptions options;
  options.change_identity = [](unsigned joint, firmware::ModuleIdentity& identity) {
    identity.node = joint == 1 ? 0 : identity.node;
  };
  FlashedRobot robot("travelling_wave/uniform", std::move(options));
  robot.program(0).write_image({}, false);
  robot.power_cycle(0);
  robot.bus.run_for(100'000);
  EXPECT_EQ(robot.ask(0).status.condition.flags, flag::has_bootloader);
  EXPECT_EQ(robot.ask(1).status.condition.node, 0);
  const auto update = robot.update(3);
  for (const UpdatedModule& module : update->modules()) {
    EXPECT_EQ(module.outcome, UpdateOutcome::runs) << describe(module.outcome, module.detail);
  }
}

TEST(RobotUpdate, AModuleThatVanishesIsLeftBehindAndTheOthersRunTheImage) {
  for (const Microseconds time : {Microseconds{300'000}, Microseconds{1'500'000}}) {
    FlashedRobot robot;
    RobotUpdate update(robot.bus, new_image, robot.serials, {});
    robot.bus.attach(update);
    update.start(robot.bus.now());
    robot.bus.run_for(time);
    robot.module(2).set_supply(robot.bus.robot().bus().now(), 0);
    EXPECT_TRUE(robot.bus.run_until(robot.bus.now() + 120 * second, [&] { return update.is_done(); }));
    robot.bus.detach(update);
    for (unsigned joint = 0; joint < robot.size(); ++joint) {
      EXPECT_EQ(update.modules()[joint].outcome, joint == 2 ? UpdateOutcome::vanished : UpdateOutcome::runs) << joint;
    }
    robot.module(2).set_supply(robot.bus.robot().bus().now(), 3'300);
    robot.bus.run_for(15 * second);
    EXPECT_TRUE(robot.ask(2).is(flag::runs_program)) << "it is not bricked";
  }
}

TEST(RobotUpdate, AModuleThatRestartsDuringTheTransferGetsTheImageAgain) {
  FlashedRobot robot;
  RobotUpdate update(robot.bus, new_image, robot.serials, {});
  robot.bus.attach(update);
  update.start(robot.bus.now());
  robot.bus.run_for(500'000);
  robot.power_cycle(2);
  EXPECT_TRUE(robot.bus.run_until(robot.bus.now() + 120 * second, [&] { return update.is_done(); }));
  robot.bus.detach(update);
  for (const UpdatedModule& module : update.modules()) {
    EXPECT_EQ(module.outcome, UpdateOutcome::runs) << describe(module.outcome, module.detail);
  }
}

TEST(RobotUpdate, AnImageForWhichModulesHaveNoRoomIsRefusedAtOnce) {
  FlashedRobot robot;
  const auto update = robot.update(2, sim::make_native_image(1, {0, 2, 0}, 100'000));
  for (const UpdatedModule& module : update->modules()) {
    EXPECT_EQ(module.outcome, UpdateOutcome::refused);
    EXPECT_EQ(module.detail, broadcast::refused_size);
  }
  EXPECT_TRUE(robot.ask(0).is(flag::runs_program));
}

TEST(RobotUpdate, AModuleThatRestartsAgainAndAgainIsLeftBehind) {
  FlashedRobot robot;
  RobotUpdate update(robot.bus, new_image, robot.serials, {});
  robot.bus.attach(update);
  update.start(robot.bus.now());
  Microseconds restart = robot.bus.now();
  EXPECT_TRUE(robot.bus.run_until(robot.bus.now() + 120 * second, [&] {
    if (update.step() == RobotUpdate::Step::transfer && robot.bus.now() >= restart) {
      restart = robot.bus.now() + 300'000;
      robot.power_cycle(2);
    }
    return update.is_done();
  }));
  robot.bus.detach(update);
  for (unsigned joint = 0; joint < robot.size(); ++joint) {
    const UpdatedModule& module = update.modules()[joint];
    EXPECT_TRUE(module.outcome == UpdateOutcome::runs || joint == 2) << describe(module.outcome, module.detail);
  }
}

TEST(RobotUpdate, AnInterruptedTransferIsNotTheFaultOfTheProgram) {
  FlashedRobot robot;
  RobotUpdate update(robot.bus, new_image, robot.serials, {});
  robot.bus.attach(update);
  update.start(robot.bus.now());
  robot.bus.run_for(500'000);
  robot.bus.lose(1.0, 1);
  robot.bus.run_for(12 * second);
  robot.bus.lose(0.0, 1);
  EXPECT_TRUE(robot.bus.run_until(robot.bus.now() + 120 * second, [&] { return update.is_done(); }));
  robot.bus.detach(update);
  for (const UpdatedModule& module : update.modules()) {
    EXPECT_EQ(module.outcome, UpdateOutcome::not_transferred) << describe(module.outcome, module.detail);
  }
}

TEST(RobotUpdate, AModuleThatRefusesTheImageSaysWhyAndRunsOn) {
  FlashedRobot robot;
  const auto update = robot.update(2, sim::make_native_image(7, {0, 2, 0}, 1'000));
  for (const UpdatedModule& module : update->modules()) {
    EXPECT_EQ(module.outcome, UpdateOutcome::refused);
    EXPECT_EQ(static_cast<image::Error>(module.detail), image::Error::other_board);
    EXPECT_NE(describe(module.outcome, module.detail).find("board"), std::string::npos);
  }
  robot.bus.run_for(second);
  EXPECT_TRUE(robot.ask(0).is(flag::runs_program));
  EXPECT_EQ(robot.minor_version(0), 1U);
}

TEST(RobotUpdate, AProgramThatDoesNotStartGivesWayToTheOneBeforeAndThatIsNoSuccess) {
  FlashedRobot robot;
  robot.program(1).set_health([](const image::Header& header) {
    return header.version.minor == 2 ? sim::ProgramHealth::hangs : sim::ProgramHealth::good;
  });
  const auto update = robot.update(2);
  EXPECT_EQ(update->modules()[0].outcome, UpdateOutcome::runs);
  EXPECT_EQ(update->modules()[1].outcome, UpdateOutcome::old_program_runs);
  EXPECT_EQ(robot.minor_version(1), 1U);
}

TEST(RobotUpdate, AModuleOfAnotherHostIsLeftToIt) {
  FlashedRobot robot;
  RobotUpdate first(robot.bus, new_image, {robot.serials[0], robot.serials[1]}, {.session = 1});
  robot.bus.attach(first);
  first.start(robot.bus.now());
  robot.bus.run_for(200'000);
  robot.bus.detach(first);  // it is slow
  const auto other = robot.update(2, new_image, {.session = 2});
  EXPECT_EQ(other->modules()[0].outcome, UpdateOutcome::belongs_to_other);
  EXPECT_EQ(other->modules()[1].outcome, UpdateOutcome::belongs_to_other);
  robot.bus.attach(first);
  EXPECT_TRUE(robot.bus.run_until(robot.bus.now() + 120 * second, [&] { return first.is_done(); }));
  robot.bus.detach(first);
  EXPECT_EQ(first.modules()[0].outcome, UpdateOutcome::runs);
  EXPECT_EQ(first.modules()[1].outcome, UpdateOutcome::runs);
}

TEST(RobotUpdate, AHostThatIsKilledAnywhereLeavesModulesThatTheNextRunFlashes) {
  FlashedRobot measured;
  const std::uint64_t before = measured.bus.sent_frames();
  static_cast<void>(measured.update(2));
  const std::uint64_t frames = measured.bus.sent_frames() - before;
  for (unsigned percent = 0; percent <= 100; percent += 5) {
    SCOPED_TRACE(percent);
    FlashedRobot robot;
    {
      RobotUpdate killed(robot.bus, new_image, {robot.serials[0], robot.serials[1]}, {.session = 1});
      robot.bus.attach(killed);
      const std::uint64_t start = robot.bus.sent_frames();
      killed.start(robot.bus.now());
      robot.bus.run_until(robot.bus.now() + 120 * second, [&] {
        return killed.is_done() || robot.bus.sent_frames() - start >= frames * percent / 100;
      });
      robot.bus.detach(killed);
    }
    robot.bus.run_for(broadcast::ImageReceiver::session_timeout_us + 100'000);
    const auto update = robot.update(2, new_image, {.session = 2});
    for (const UpdatedModule& module : update->modules()) {
      EXPECT_EQ(module.outcome, UpdateOutcome::runs) << describe(module.outcome, module.detail);
    }
  }
}

TEST(RobotUpdate, ReadsTheWholeHeaderAsLongAsSomeOfItArrives) {
  FlashedRobot robot;
  robot.bus.lose(0.25, 1);
  for (unsigned i = 0; i < 20 * robot.size(); ++i) {
    const ModuleProgram program = robot.ask(i % robot.size());
    EXPECT_TRUE(program.image) << i << ": " << program.missing_words << " words are missing";
  }
  robot.bus.lose(1.0, 1);
  EXPECT_FALSE(robot.ask(0).has_answered);
}

TEST(RobotUpdate, ReadsTheWholeHeaderOfWhatRuns) {
  FlashedRobot robot;
  for (const double loss : {0.0, 0.1}) {
    robot.bus.lose(loss, 5);
    const ModuleProgram program = robot.ask(3);
    ASSERT_TRUE(program.image);
    EXPECT_EQ(program.image->version, (image::Version{0, 1, 0}));
    EXPECT_EQ(*program.image, image::decode(sim::make_native_image(1, {0, 1, 0}, body_size)).header);
    EXPECT_EQ(program.status.condition.flags,
              flag::runs_program | flag::has_image | flag::is_confirmed | flag::has_bootloader);
  }
  host::ModuleQuery query(robot.bus);
  robot.bus.attach(query);
  query.start(robot.bus.now(), {robot.serials[0] + 1, robot.serials[1]});
  EXPECT_TRUE(robot.bus.run_until(robot.bus.now() + 10 * second, [&] { return query.is_done(); }));
  robot.bus.detach(query);
  EXPECT_FALSE(query.modules()[0].has_answered) << "nobody has this serial number";
  EXPECT_TRUE(query.modules()[1].has_answered);
}

}  // namespace
}  // namespace proleg::test
