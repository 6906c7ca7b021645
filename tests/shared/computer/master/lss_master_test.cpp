// The LSS master with slaves that are written for the test, on the simulated bus. tests/sim/loop has the same tests
// with modules.

#include "shared/computer/master/lss_master.hpp"

#include <gtest/gtest.h>

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <random>
#include <vector>

#include "lss_slave_node.hpp"
#include "sim/bus/candump_log.hpp"
#include "tests/support/lines_of.hpp"

namespace proleg::canopen {
namespace {

using sim::BusTime;

constexpr std::uint32_t vendor = 0x50524F4C;
constexpr std::uint32_t revision = 0x00010000;

class LssMasterTest : public testing::Test, sim::BusListener {
 protected:
  static constexpr BusTime us = 1'000;

  LssMasterTest() : controller_(bus.attach(*this)) {}

  SlaveNode& add(const LssAddress& address) {
    slaves.push_back(std::make_unique<SlaveNode>(bus, address));
    return *slaves.back();
  }
  /// Adds entries for node ids 1 to count.
  void list(unsigned count) {
    for (unsigned i = 1; i <= count; ++i) {
      modules.push_back({static_cast<std::uint8_t>(i)});
    }
  }
  /// Runs until the master has ended. It must end within `longest`.
  void run(const LssMasterOptions& options = {}, BusTime longest = 60'000'000 * us) {
    master = std::make_unique<LssMaster>(controller_, modules, options);
    const BusTime begin = bus.now();
    master->start(begin / us);
    while (master->state() == LssMaster::State::working) {
      const BusTime next = std::min(bus.next_event(), master->next_deadline() * us);
      ASSERT_LE(next - begin, longest) << "a wait without an end";
      bus.advance_to(next);
      master->poll(bus.now() / us);
    }
    bus.advance_to(bus.now() + 1'000 * us);
    duration = bus.now() - begin;
  }
  /// Loses answers to the master with this probability.
  void lose(double probability, std::uint64_t seed) {
    loss_ = probability;
    random_.seed(seed);
  }
  void expect_problem(LssProblem problem, unsigned detail = 0) const {
    EXPECT_EQ(master->state(), LssMaster::State::failed);
    EXPECT_EQ(describe(master->problem()), describe(problem));
    EXPECT_EQ(master->problem_detail(), detail);
    EXPECT_EQ(master->next_deadline(), never);
  }

  sim::Bus bus;
  std::vector<std::unique_ptr<SlaveNode>> slaves;
  std::vector<LssModule> modules;
  std::unique_ptr<LssMaster> master;
  BusTime duration = 0;

 private:
  void received(BusTime time, const CanFrame& frame) override {
    if (!std::bernoulli_distribution(loss_)(random_)) {
      master->receive(time / us, frame);
    }
  }
  void transmitted(BusTime time, const CanFrame& frame) override { master->transmitted(time / us, frame); }

  sim::Controller& controller_;
  double loss_ = 0;
  std::mt19937_64 random_;
};

TEST_F(LssMasterTest, WithoutModulesThatHaveNoNodeIdIsDone) {
  list(1);
  add({vendor, 1, revision, 7}).node = 5;
  run();
  EXPECT_EQ(master->state(), LssMaster::State::done);
  EXPECT_EQ(master->assigned(), 0U);
  EXPECT_FALSE(modules[0].has_booted);
  EXPECT_LT(duration, 20'000 * us);
}

TEST_F(LssMasterTest, GivesAModuleItsNodeIdAndStoresIt) {
  list(1);
  modules[0].node = 42;
  SlaveNode& slave = add({vendor, 1, revision, 0x89ABCDEF});
  run();
  EXPECT_EQ(master->state(), LssMaster::State::done);
  EXPECT_EQ(slave.node, 42);
  EXPECT_EQ(slave.stored, std::vector<std::uint8_t>{42});
  EXPECT_TRUE(modules[0].has_booted);
  EXPECT_EQ(modules[0].address, slave.address);
  EXPECT_EQ(master->assigned(), 1U);
}

TEST_F(LssMasterTest, DoesNotStoreIfNotAskedTo) {
  list(1);
  SlaveNode& slave = add({vendor, 1, revision, 7});
  LssMasterOptions options;
  options.stores = false;
  run(options);
  EXPECT_EQ(slave.node, 1);
  EXPECT_TRUE(slave.stored.empty());
}

TEST_F(LssMasterTest, FindsModulesOfAnyIdentity) {
  constexpr unsigned seed = 305;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  const auto word = [&random] {
    constexpr std::array<std::uint32_t, 4> special{0, ~0U, 1, 1U << 31U};
    return random() % 4 == 0 ? special.at(random() % 4) : static_cast<std::uint32_t>(random());
  };
  list(40);
  for (unsigned i = 0; i < 40; ++i) {
    // Some addresses differ from another one in a single bit.
    LssAddress address{word(), word(), word(), word()};
    if (i % 2 != 0) {
      address = slaves.back()->address;
      address.at(random() % 4) ^= 1U << random() % 32;
    }
    add(address);
  }
  run();
  EXPECT_EQ(master->state(), LssMaster::State::done) << describe(master->problem());
  EXPECT_EQ(master->assigned(), 40U);
  std::vector<unsigned> nodes;
  for (const auto& slave : slaves) {
    nodes.push_back(slave->node);
    EXPECT_EQ(modules.at(slave->node - 1U).address, slave->address);
  }
  std::ranges::sort(nodes);
  EXPECT_EQ(std::ranges::adjacent_find(nodes), nodes.end()) << "each has its own";
}

TEST_F(LssMasterTest, TheListSaysWhichSerialNumberHasWhichNodeId) {
  list(3);
  modules[0].serial = 300;
  modules[2].serial = 100;
  add({vendor, 1, revision, 100});
  add({vendor, 1, revision, 200});
  add({vendor, 1, revision, 300});
  run();
  EXPECT_EQ(master->state(), LssMaster::State::done);
  EXPECT_EQ(slaves[0]->node, 3);
  EXPECT_EQ(slaves[1]->node, 2);
  EXPECT_EQ(slaves[2]->node, 1);
}

TEST_F(LssMasterTest, AUsualNumberSavesMostOfTheTime) {
  list(20);
  for (std::uint32_t i = 0; i < 20; ++i) {
    add({vendor, 1, revision, 0x1234'5678 * (i + 1)});
  }
  LssMasterOptions options;
  options.usual = {};
  run(options);
  EXPECT_EQ(master->assigned(), 20U);
  const BusTime unknown = duration;
  for (std::size_t i = 0; i < slaves.size(); ++i) {
    slaves[i]->power_on();
    modules[i].has_booted = false;
  }
  options.usual = {vendor, 1, revision, 0};
  run(options);
  EXPECT_EQ(master->assigned(), 20U);
  EXPECT_LT(duration * 2, unknown);
  std::cout << "20 modules: " << static_cast<double>(duration) * 1e-9 << " s; without usual numbers "
            << static_cast<double>(unknown) * 1e-9 << " s\n";
}

TEST_F(LssMasterTest, EveryModuleGetsItsNodeIdAlthoughOneFrameInTenIsLost) {
  constexpr unsigned seed = 306;
  SCOPED_TRACE("seed " + std::to_string(seed));
  list(3);
  for (std::uint32_t i = 1; i <= 3; ++i) {
    add({vendor, 1, revision, 0x89ABCDEF * i});
  }
  LssMasterOptions options;
  options.attempts = 4;
  lose(0.1, seed);
  // A boot-up that is lost ends the master: a second run finds the modules that are left.
  unsigned assigned = 0;
  for (unsigned runs = 0; runs < 5 && assigned < 3; ++runs) {
    run(options);
    assigned = 0;
    for (const auto& slave : slaves) {
      assigned += slave->node != 0 ? 1U : 0U;
    }
  }
  EXPECT_EQ(assigned, 3U);
}

TEST_F(LssMasterTest, AModuleThatIsNotInTheListEndsItAndStaysWithoutANodeId) {
  list(1);
  modules[0].serial = 8;
  SlaveNode& slave = add({vendor, 1, revision, 7});
  run();
  expect_problem(LssProblem::unexpected_module);
  EXPECT_EQ(master->found(), slave.address);
  EXPECT_EQ(slave.node, 0);
  // The module is not selected any more.
  modules[0].serial = 7;
  run();
  EXPECT_EQ(slave.node, 1);
}

TEST_F(LssMasterTest, WithoutAnotherNodeNoFrameIsAcknowledged) {
  list(1);
  run({}, 2'000'000 * us);
  expect_problem(LssProblem::not_sent);
}

TEST_F(LssMasterTest, AModuleThatLeavesDuringTheScanEndsItAfterSomeAttempts) {
  list(1);
  add({vendor, 1, revision, 7}).answers_left = 4;  // begin, vendor, and 2 bits of the product
  SlaveNode& other = add({vendor, 1, revision, 7});
  other.answers_left = 20;
  run();
  // The second scan finds no module.
  EXPECT_EQ(master->state(), LssMaster::State::done);
  EXPECT_EQ(master->assigned(), 0U);
}

TEST_F(LssMasterTest, AModuleThatAnswersTheFirstRequestOnlyEndsIt) {
  list(1);
  class Beginner final : public sim::BusListener {
   public:
    explicit Beginner(sim::Bus& bus) : controller_(bus.attach(*this)) {}

   private:
    void received(BusTime /*time*/, const CanFrame& frame) override {
      if (frame.data[5] == 0x80) {
        EXPECT_TRUE(controller_.send({0x7E4, 8, {0x4F}}));
      }
    }
    void transmitted(BusTime /*time*/, const CanFrame& /*frame*/) override {}
    sim::Controller& controller_;
  } beginner(bus);
  run();
  expect_problem(LssProblem::scan_failed, 0);
  EXPECT_LT(duration, 2'000'000 * us);
}

TEST_F(LssMasterTest, RefusalsAreReportedWithTheirCode) {
  list(1);
  SlaveNode& slave = add({vendor, 1, revision, 7});
  slave.refuses_service = 0x11;
  run();
  expect_problem(LssProblem::node_refused, 1);
  slave.power_on();
  slave.refuses_service = 0;
  slave.store_result = {2, 0};
  run();
  expect_problem(LssProblem::store_refused, 2);
}

TEST_F(LssMasterTest, AModuleThatDoesNotAnswerOrBootIsReported) {
  list(1);
  add({vendor, 1, revision, 7}).ignores = lss::Service::configure_node_id;
  run();
  expect_problem(LssProblem::no_answer, 0x11);
}

TEST_F(LssMasterTest, AModuleThatDoesNotStoreIsWaitedForAndReported) {
  list(1);
  add({vendor, 1, revision, 7}).ignores = lss::Service::store_configuration;
  run();
  expect_problem(LssProblem::no_answer, 0x17);
  EXPECT_GT(duration, 1'500'000 * us) << "it may erase its flash";
}

TEST_F(LssMasterTest, AModuleThatDoesNotBootIsReported) {
  list(1);
  modules[0].node = 9;
  add({vendor, 1, revision, 7}).boots = false;
  run();
  expect_problem(LssProblem::no_boot_up, 9);
}

/// The lines that tshark prints for a log.
std::vector<std::string> dissect(const std::filesystem::path& log, const std::string& options) {
  return test::lines_of(std::string(PROLEG_TSHARK) + " -r " + log.string() + " -d can.subdissector,canopen " + options +
                        " 2>/dev/null");
}

TEST_F(LssMasterTest, TsharkKnowsEveryFrameAndFindsNoneMalformed) {
  const std::filesystem::path path =
      std::filesystem::path(testing::TempDir()) / ("lss_master_test." + std::to_string(getpid()) + ".log");
  {
    sim::CandumpLog log(path);
    bus.set_frame_listener([&log](const sim::Transmission& sent) { log.write(sent.end, sent.frame); });
    list(3);
    for (std::uint32_t i = 1; i <= 3; ++i) {
      add({vendor, i, revision, 0x89ABCDEF * i});
    }
    run();
    bus.set_frame_listener({});
    log.finish();
  }
  EXPECT_EQ(master->assigned(), 3U);
  const std::vector<std::string> lines = dissect(path, "");
  EXPECT_GT(lines.size(), 200U);
  const std::array<std::string, 8> kinds{
      "LSS (Master): LSS Fastscan protocol\n",
      "LSS (Slave): Identify slave protocol\n",
      "LSS (Master): Configure node-ID protocol: 0x02\n",
      "LSS (Slave): Configure node-ID protocol\n",
      "LSS (Master): Store configuration protocol\n",
      "LSS (Slave): Store configuration protocol\n",
      "LSS (Master): Switch state global protocol: Waiting state\n",
      "NMT Error Control: Boot-up [0x2]\n",
  };
  for (const std::string& kind : kinds) {
    EXPECT_TRUE(std::ranges::any_of(lines, [&](const std::string& line) { return line.ends_with(kind); })) << kind;
  }
  EXPECT_EQ(dissect(path, "-Y '_ws.malformed || _ws.expert'"), std::vector<std::string>{});
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace proleg::canopen
