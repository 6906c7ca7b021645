#include "tools/proleg/ui/recorded_session.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/sqlite/sqlite.hpp"
#include "shipped.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tools/proleg/ui/live_simulation.hpp"

namespace proleg::tools {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class RunComparisonTest : public ::testing::Test {
 protected:
  /// A run in which a word of --set takes effect at tick 200.
  fs::path record(const std::string& name, unsigned ticks, const std::string& word = "",
                  const std::string& scenario = "travelling_wave/uniform") {
    LiveSimulation live(sim::shipped(scenario), {}, nullptr);
    const fs::path path = folder_ / name;
    EXPECT_TRUE(live.record(path, "simulate", "test", [] { return true; }));
    for (unsigned tick = 0; tick < ticks; ++tick) {
      if (tick == 200 && !word.empty()) {
        live.set({word}, std::nullopt);
      }
      live.advance();
    }
    live.end_recording();
    return path;
  }
  static json compared(const fs::path& one, const fs::path& other) {
    RecordedRun run(one);
    RecordedRun second(other);
    RunComparison comparison(run, second);
    while (comparison.compare_some()) {
    }
    return comparison.document();
  }
  static std::string refusal(const fs::path& one, const fs::path& other) {
    return message_of<InputError>([&] { compared(one, other); });
  }
  static void change(const fs::path& path, const char* sql) { Database(path, SQLITE_OPEN_READWRITE).execute(sql); }
  /// The first tick at which set-points differ, as SQLite finds it.
  static std::uint32_t first_difference(const fs::path& one, const fs::path& other) {
    Database database(one, SQLITE_OPEN_READWRITE);
    database.execute(("ATTACH '" + other.string() + "' AS other").c_str());
    Statement query(database,
                    "SELECT min(tick) FROM main.sample AS a JOIN other.sample AS b USING (tick, joint) "
                    "WHERE a.setpoint_raw <> b.setpoint_raw");
    EXPECT_TRUE(query.step());
    return static_cast<std::uint32_t>(query.integer(0));
  }

  TemporaryFolder folder_;
};

TEST_F(RunComparisonTest, TheSameRunHasNoDifference) {
  const json document = compared(record("a.proleg", 400), record("b.proleg", 400));
  EXPECT_TRUE(document["difference"].is_null());
  EXPECT_EQ(document["compared"], 400);
  EXPECT_EQ(document["last_tick"], 399);
  EXPECT_TRUE(document["head_m"][0].is_number());
  EXPECT_EQ(document["head_m"][0], document["head_m"][1]);
}

TEST_F(RunComparisonTest, FindsWhereAChangeTookEffect) {
  const fs::path one = record("a.proleg", 400);
  const fs::path other = record("b.proleg", 400, "amplitude:J2=30");
  const json document = compared(one, other);
  ASSERT_FALSE(document["difference"].is_null());
  EXPECT_EQ(document["difference"]["tick"], first_difference(one, other));
  EXPECT_EQ(document["difference"]["joint"], "J2");
  EXPECT_GE(document["difference"]["tick"].get<int>(), 200);
  EXPECT_NE(document["head_m"][0], document["head_m"][1]);
}

TEST_F(RunComparisonTest, FindsWhereTheMotionDepartsAlthoughAllSetPointsAreTheSame) {
  const fs::path one = record("a.proleg", 400);
  const fs::path other = record("b.proleg", 400);
  EXPECT_TRUE(compared(one, other)["motion"]["difference"].is_null());
  change(other, "UPDATE pose SET y_m = y_m + 1e-15 WHERE tick >= 170 AND link = 4");
  const json document = compared(one, other);
  EXPECT_TRUE(document["difference"].is_null());
  EXPECT_EQ(document["compared"], 400);
  EXPECT_EQ(document["motion"]["difference"]["tick"], 170);
  EXPECT_EQ(document["motion"]["difference"]["part"].get<std::string>().substr(0, 6), "link '");
}

TEST_F(RunComparisonTest, ARealRobotHasNoMotionToCompare) {
  const fs::path one = record("a.proleg", 100);
  const fs::path other = record("b.proleg", 100);
  change(other, "UPDATE run SET value = 'drive' WHERE key = 'program'");
  const json document = compared(one, other);
  EXPECT_TRUE(document["motion"].is_null());
  EXPECT_EQ(document["compared"], 100);
}

TEST_F(RunComparisonTest, ComparesTheTicksThatBothHave) {
  const json document = compared(record("short.proleg", 150), record("long.proleg", 400, "amplitude=30"));
  EXPECT_TRUE(document["difference"].is_null());
  EXPECT_EQ(document["compared"], 150);
  EXPECT_EQ(document["last_tick"], 149);
}

TEST_F(RunComparisonTest, RefusesRunsThatHaveNoCommonTicks) {
  const fs::path one = record("a.proleg", 10);
  EXPECT_EQ(refusal(one, record("long.proleg", 10, "", "long_chain/twenty")),
            "long.proleg: found 20 joints, expected 5, as in a.proleg");
  const fs::path slow = record("slow.proleg", 10);
  change(slow, "UPDATE run SET value = '20000' WHERE key = 'tick_us'");
  EXPECT_EQ(refusal(one, slow), "slow.proleg: found 20000 microseconds in a tick, expected 10000, as in a.proleg");
  const fs::path late = record("late.proleg", 30);
  change(late, "DELETE FROM sample WHERE tick < 20");
  EXPECT_EQ(refusal(one, late), "late.proleg: found ticks 20 to 29, expected some of the ticks 0 to 9 of a.proleg");
}

TEST_F(RunComparisonTest, AMoveByHandIsNoWayOfTheRobot) {
  const fs::path one = record("a.proleg", 10);
  change(one, "INSERT INTO move(tick, x_m, y_m, z_m, turn_deg) VALUES(5, 1.0, 0.0, 0.1, 0.0)");
  const json document = compared(one, record("b.proleg", 10));
  EXPECT_TRUE(document["head_m"][0].is_null());
  EXPECT_TRUE(document["head_m"][1].is_number());
}

TEST_F(RunComparisonTest, ADamagedFileThrowsAndIsNotReadAgain) {
  const fs::path one = record("a.proleg", 300);
  const fs::path other = record("b.proleg", 300);
  change(other, "DELETE FROM sample WHERE tick = 250");
  RecordedRun run(one);
  RecordedRun second(other);
  RunComparison comparison(run, second);
  EXPECT_THROW(while (comparison.compare_some()){}, InputError);
  comparison.end("a gap");
  EXPECT_FALSE(comparison.compare_some());
  EXPECT_EQ(comparison.document()["damage"], "a gap");
  EXPECT_LE(comparison.document()["compared"].get<int>(), 250);
}

}  // namespace
}  // namespace proleg::tools
