// Modules get other node ids, on the simulated bus. tests/host/robot has the same tests with the program of the
// modules.

#include "shared/computer/master/lss_renumbering.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "lss_slave_node.hpp"

namespace proleg::canopen {
namespace {

using sim::BusTime;

class LssRenumberingTest : public testing::Test, sim::BusListener {
 protected:
  using State = LssRenumbering::State;
  static constexpr BusTime us = 1'000;

  static constexpr LssAddress address_of(std::uint32_t serial) { return {0x50524F4C, 1, 0x00010000, serial}; }

  LssRenumberingTest() : controller_(bus.attach(*this)) {}

  SlaveNode& add(std::uint32_t serial, std::uint8_t node) {
    slaves.push_back(std::make_unique<SlaveNode>(bus, address_of(serial)));
    slaves.back()->node = node;
    return *slaves.back();
  }
  /// Runs until it has ended. It must end within a minute.
  void run() {
    constexpr BusTime longest = 60'000'000 * us;
    renumbering = std::make_unique<LssRenumbering>(controller_, modules, options);
    const BusTime begin = bus.now();
    renumbering->start(begin / us);
    while (renumbering->state() == State::working) {
      const BusTime next = std::min(bus.next_event(), renumbering->next_deadline() * us);
      ASSERT_LE(next - begin, longest) << "a wait without an end";
      bus.advance_to(next);
      renumbering->poll(bus.now() / us);
    }
    bus.advance_to(bus.now() + 1'000 * us);
  }
  void expect_problem(LssProblem problem, std::size_t module, unsigned detail) const {
    EXPECT_EQ(renumbering->state(), State::failed);
    EXPECT_EQ(describe(renumbering->problem()), describe(problem));
    EXPECT_EQ(renumbering->problem_module(), module);
    EXPECT_EQ(renumbering->problem_detail(), detail);
    EXPECT_EQ(renumbering->next_deadline(), never);
  }

  sim::Bus bus;
  std::vector<std::unique_ptr<SlaveNode>> slaves;
  std::vector<RenumberedModule> modules;
  LssRenumberingOptions options;
  unsigned lost_boot_ups = 0;  ///< number of boot-ups from now on that the master does not receive
  std::unique_ptr<LssRenumbering> renumbering;

 private:
  void received(BusTime time, const CanFrame& frame) override {
    if (decode_heartbeat(frame) && lost_boot_ups > 0) {
      --lost_boot_ups;
      return;
    }
    renumbering->receive(time / us, frame);
  }
  void transmitted(BusTime time, const CanFrame& frame) override { renumbering->transmitted(time / us, frame); }

  sim::Controller& controller_;
};

TEST_F(LssRenumberingTest, ModulesTakeEachOthersNodeIds) {
  const SlaveNode& first = add(100, 1);
  const SlaveNode& second = add(200, 2);
  const SlaveNode& third = add(300, 3);
  modules = {{address_of(100), 2}, {address_of(200), 1}};
  run();
  EXPECT_EQ(renumbering->state(), State::done);
  EXPECT_EQ(first.node, 2);
  EXPECT_EQ(second.node, 1);
  EXPECT_EQ(third.node, 3);
  EXPECT_EQ(first.stored, std::vector<std::uint8_t>{2});
  EXPECT_TRUE(third.stored.empty()) << "it was not selected";
  EXPECT_TRUE(modules[0].has_stored && modules[1].has_booted);
}

TEST_F(LssRenumberingTest, AModuleThatIsListedTwiceHasTheLastNodeId) {
  const SlaveNode& first = add(100, 1);
  const SlaveNode& second = add(200, 2);
  modules = {{address_of(100), 9}, {address_of(200), 1}, {address_of(100), 2}};
  run();
  EXPECT_EQ(renumbering->state(), State::done);
  EXPECT_EQ(first.node, 2);
  EXPECT_EQ(second.node, 1);
  EXPECT_EQ(first.stored, (std::vector<std::uint8_t>{9, 2}));
}

TEST_F(LssRenumberingTest, OfModulesWithOneNodeIdEachGetsItsOwnAndNoOtherModuleRestarts) {
  const SlaveNode& first = add(100, 2);
  const SlaveNode& second = add(200, 2);
  const SlaveNode& other = add(300, 3);
  modules = {{address_of(100), 2}, {address_of(200), 5}};
  options.reset_node = 2;
  run();
  EXPECT_EQ(renumbering->state(), State::done);
  EXPECT_EQ(first.node, 2);
  EXPECT_EQ(second.node, 5);
  EXPECT_EQ(first.resets, 1U);
  EXPECT_EQ(other.resets, 0U);
}

TEST_F(LssRenumberingTest, ALostBootUpOfAModuleWithItsNewNodeIdIsMadeUpFor) {
  add(100, 2);
  add(200, 2);
  modules = {{address_of(100), 2}, {address_of(200), 5}};
  options.reset_node = 2;
  lost_boot_ups = 2;
  run();
  EXPECT_EQ(renumbering->state(), State::done);
}

TEST_F(LssRenumberingTest, AModuleThatIsNotAwaitedNeedNotBoot) {
  SlaveNode& module = add(100, 1);
  module.boots = false;
  modules = {{address_of(100), 2, false}};
  run();
  EXPECT_EQ(renumbering->state(), State::done);
  EXPECT_EQ(module.stored, std::vector<std::uint8_t>{2});
}

TEST_F(LssRenumberingTest, WithoutModulesItIsDoneAndSendsNothing) {
  unsigned frames = 0;
  bus.set_frame_listener([&frames](const sim::Transmission&) { ++frames; });
  run();
  EXPECT_EQ(renumbering->state(), State::done);
  EXPECT_EQ(frames, 0U);
  bus.set_frame_listener({});
}

TEST_F(LssRenumberingTest, AModuleThatIsNotThereIsNamed) {
  add(100, 1);
  modules = {{address_of(100), 2}, {address_of(999), 1}};
  run();
  expect_problem(LssProblem::no_answer, 1, 0x43);
  EXPECT_TRUE(modules[0].has_stored);
  EXPECT_FALSE(modules[1].has_stored);
}

TEST_F(LssRenumberingTest, RefusalsAreNamed) {
  SlaveNode& module = add(100, 1);
  modules = {{address_of(100), 2}};
  module.refuses_service = 0x11;
  run();
  expect_problem(LssProblem::node_refused, 0, 1);
  module.refuses_service = 0;
  module.store_result = {2, 0};
  run();
  expect_problem(LssProblem::store_refused, 0, 2);
  module.store_result = {};
  module.boots = false;
  run();
  expect_problem(LssProblem::no_boot_up, 0, 2);
}

TEST_F(LssRenumberingTest, WithoutAnotherNodeNoFrameIsAcknowledged) {
  modules = {{address_of(100), 2}};
  run();
  expect_problem(LssProblem::not_sent, 0, 0);
}

}  // namespace
}  // namespace proleg::canopen
