#include "sim/loop/verification.hpp"

#include <gtest/gtest.h>

#include <sqlite3.h>
#include <unistd.h>

#include <filesystem>

#include "shared/computer/errors/input_error.hpp"
#include "shipped.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/scenario/settings.hpp"

namespace proleg::sim {
namespace {

class Verifying : public testing::Test {
 protected:
  void SetUp() override {
    Scenario scenario = shipped("obstacle/reflex");
    apply_setting(scenario, "amplitude=33@120");
    apply_setting(scenario, "current_phase:J4=-140@0");
    const Losses losses(RandomLosses{7, 1U << 28U, 0, 1000});
    Simulation simulation(scenario, &losses);
    Recorder recorder(path_, scenario, "test", "build");
    while (simulation.tick() < ticks) {
      if (const Change* change = simulation.advance()) {
        recorder.record_change(*change);
      }
      recorder.record_tick(simulation.sample());
    }
    setpoint_hash_ = simulation.setpoint_hash().hex();
    servo_hash_ = simulation.servo_hash().hex();
    recorder.finish({});
  }
  void TearDown() override { std::filesystem::remove(path_); }

  void change(const char* sql) {
    sqlite3* database = nullptr;
    ASSERT_EQ(sqlite3_open(path_.c_str(), &database), SQLITE_OK);
    EXPECT_EQ(sqlite3_exec(database, sql, nullptr, nullptr, nullptr), SQLITE_OK) << sqlite3_errmsg(database);
    EXPECT_GT(sqlite3_changes(database), 0) << sql;
    sqlite3_close(database);
  }

  [[nodiscard]] Verification verified() const { return verify(Recording(path_)); }

  static constexpr std::uint32_t ticks = 600;
  std::string setpoint_hash_;
  std::string servo_hash_;
  std::filesystem::path path_ =
      std::filesystem::path(testing::TempDir()) / ("proleg-verify-" + std::to_string(::getpid()) + ".proleg");
};

TEST_F(Verifying, RecomputesEverySetpointAndServoCommandFromTheFileAlone) {
  const Verification result = verified();
  EXPECT_EQ(result.ticks, ticks);
  EXPECT_EQ(result.setpoints, 5U * ticks);
  EXPECT_EQ(result.differences, 0U);
  EXPECT_FALSE(result.first);
  EXPECT_EQ(result.setpoint_hash, setpoint_hash_);
  EXPECT_EQ(result.servo_hash, servo_hash_);
}

TEST_F(Verifying, NamesTheFirstSetpointThatDoesNotFollow) {
  change("UPDATE sample SET setpoint_raw = setpoint_raw + 1 WHERE tick = 123 AND joint = 2");
  const Verification result = verified();
  ASSERT_EQ(result.differences, 1U);
  EXPECT_EQ(result.first->kind, Difference::Kind::setpoint);
  EXPECT_EQ(result.first->tick, 123U);
  EXPECT_EQ(result.first->joint, 2U);
  EXPECT_EQ(*result.first->found, *result.first->expected + 1);
}

TEST_F(Verifying, NamesAServoCommandThatIsChangedMissingOrAdded) {
  change("UPDATE servo SET command = command + 1 WHERE time_us = 50000 AND joint = 0");
  EXPECT_EQ(verified().differences, 1U);
  change("DELETE FROM servo WHERE time_us = 60000 AND joint = 4");
  EXPECT_EQ(verified().differences, 2U);
  change("INSERT INTO servo VALUES(60001, 4, 18000)");
  const Verification result = verified();
  EXPECT_EQ(result.differences, 3U);
  EXPECT_EQ(result.first->tick, 5U);
  EXPECT_EQ(describe(*result.first, "J5").substr(0, 31), "servo command of J5 at tick 5: ");
}

// Every single contact is an input of the gait.
TEST_F(Verifying, FailsIfAContactIsNotTheRecordedOne) {
  change("UPDATE contact SET rear = 1 - rear, front = 1 - front WHERE tick BETWEEN 200 AND 260");
  EXPECT_GT(verified().differences, 0U);
}

// With oscillators whose phases still converge: losses do not change the reflex.
TEST_F(Verifying, FailsIfALossIsMissing) {
  const Scenario scenario = shipped("travelling_wave/coupled");
  const Losses losses({{20, 0, 0, 1}, {21, 3, 0, 2}});
  {
    Simulation simulation(scenario, &losses);
    Recorder recorder(path_, scenario, "test", "build");
    while (simulation.tick() < 100) {
      simulation.advance();
      recorder.record_tick(simulation.sample());
    }
    recorder.finish({});
  }
  EXPECT_EQ(verified().differences, 0U);
  change("DELETE FROM loss WHERE tick = 21");
  EXPECT_GT(verified().differences, 0U);
}

TEST_F(Verifying, NamesInternalValuesAndLastServoCommandsThatDoNotFollow) {
  change("UPDATE internal_value SET raw = raw + 1 WHERE tick = 50 AND slot = 0 AND joint = 1 AND value_index = 0");
  EXPECT_EQ(verified().differences, 1U);
  EXPECT_EQ(verified().first->kind, Difference::Kind::internal_value);
  change("UPDATE sample SET servo_command = 18000 WHERE tick = 40 AND joint = 2");
  EXPECT_EQ(verified().differences, 2U);
  EXPECT_EQ(verified().first->kind, Difference::Kind::last_servo_command);
  change("INSERT INTO servo VALUES(99999999999, 0, 18000)");
  EXPECT_EQ(verified().differences, 3U);
}

TEST_F(Verifying, FailsIfAChangeIsMissing) {
  change("DELETE FROM parameter WHERE origin = 'commit'");
  const Verification result = verified();
  EXPECT_GT(result.differences, 0U);
  EXPECT_EQ(result.first->tick, 120U);
}

TEST_F(Verifying, RejectsAnAlgorithmThatTheProgramDoesNotHave) {
  change("UPDATE slot SET algorithm = 'Teleport' WHERE slot = 0");
  try {
    (void)verified();
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("algorithm 'Teleport'"), std::string::npos) << error.what();
  }
}

TEST_F(Verifying, RejectsValuesThatNoKernelAccepts) {
  change("UPDATE parameter SET raw = -2000000000 WHERE name = 'amplitude' AND joint = 1");
  EXPECT_THROW((void)verified(), InputError);
  change("UPDATE joint SET lower_raw = 5, upper_raw = 4 WHERE joint = 0");
  EXPECT_THROW((void)verified(), InputError);
}

TEST_F(Verifying, RejectsAServoPeriodThatNoServoHas) {
  for (const char* period : {"0", "4294967296000", "-1", "x"}) {
    change(("UPDATE run SET value = '" + std::string(period) + "' WHERE key = 'servo_period_us'").c_str());
    EXPECT_THROW((void)verified(), InputError) << period;
  }
}

TEST_F(Verifying, RejectsARecordingThatDoesNotStartAtTick0) {
  change("DELETE FROM sample WHERE tick < 10");
  EXPECT_THROW((void)verified(), InputError);
}

}  // namespace
}  // namespace proleg::sim
