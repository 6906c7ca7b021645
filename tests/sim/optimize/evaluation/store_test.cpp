#include "sim/optimize/evaluation/store.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <thread>

#include "shared/computer/sqlite/sqlite.hpp"
#include "small_experiment.hpp"
#include "tests/support/files.hpp"
#include "tests/support/message_of.hpp"

namespace proleg::optimize {
namespace {

/// Any number but a negative zero, which run_trial never gives.
double any_number(std::mt19937& random) {
  const std::uint64_t high = random();
  const auto value = std::bit_cast<double>(high << 32U | random());
  return std::isnan(value) ? std::numeric_limits<double>::quiet_NaN() : value + 0.0;
}

TrialResult any_result(std::mt19937& random) {
  TrialResult result;
  for (double& value : result.measures.all()) {
    value = any_number(random);
  }
  result.measures[sim::Measure::slip] = std::numeric_limits<double>::quiet_NaN();
  result.measures[sim::Measure::distance] = 3.0;  // SQLite keeps whole numbers in another way
  result.simulated_s = 0.1 + 0.2;
  result.wall_s = 1.0 / 3.0;
  result.given_up = random() % 2 == 0;
  result.failure = random() % 2 == 0 ? "it's \"gone\"\n\xC3\xA4" : "";
  return result;
}

class StoreTest : public testing::Test {
 protected:
  [[nodiscard]] std::unique_ptr<Store> open(Store::Opening opening) {
    return std::make_unique<Store>(path_, experiment_, "build", opening);
  }
  [[nodiscard]] std::unique_ptr<Store> fresh() { return open(Store::Opening::fresh); }
  [[nodiscard]] std::unique_ptr<Store> resumed() { return open(Store::Opening::resume); }

  /// The one value of a query, as another program reads it from the file.
  [[nodiscard]] std::string ask(const std::string& sql) const {
    Database database(path_, SQLITE_OPEN_READONLY);
    Statement statement(database, sql);
    return statement.step() ? statement.text(0) : "nothing";
  }

  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_ / "store.sqlite";
  Experiment experiment_ = small_experiment();
  std::mt19937 random_{3};
};

TEST_F(StoreTest, TakesWhatAnotherStoreOfTheSameExperimentHas) {
  const std::filesystem::path other_path = folder_ / "other.sqlite";
  const Task ours{0, 3, 0, {1, 1, 1}, {}};
  const Task theirs{1, 5, 0, {2, 2, 2}, {}};
  const Task both{2, 0, 0, {3, 3, 3}, {}};
  const TrialResult of_theirs = any_result(random_);
  const TrialResult of_both = any_result(random_);
  {
    Store other(other_path, experiment_, "build", Store::Opening::fresh);
    other.save(theirs, 1, of_theirs, 0);
    other.save(both, 1, of_both, 0);
    other.finish_run(1, "converged");
  }
  const std::unique_ptr<Store> store = fresh();
  store->save(ours, 1, any_result(random_), 0);
  store->save(both, 1, any_result(random_), 0);
  store->add(other_path);
  EXPECT_TRUE(store->find(ours));
  ASSERT_TRUE(store->find(theirs));
  EXPECT_EQ(exact(*store->find(theirs)), exact(of_theirs));
  EXPECT_EQ(exact(*store->find(both)), exact(of_both)) << "its rows replace ours";
  EXPECT_EQ(store->ending(1), "converged");
  store->add(other_path);
  EXPECT_EQ(ask("SELECT count(*) FROM trial"), "3") << "once more changes nothing";
}

TEST_F(StoreTest, TakesWhatAnotherStoreHasOfOneRun) {
  const std::filesystem::path other_path = folder_ / "other.sqlite";
  const Task first{1, 5, 0, {2, 2, 2}, {}};
  const Task second{2, 0, 0, {3, 3, 3}, {}};
  {
    Store other(other_path, experiment_, "build", Store::Opening::fresh);
    other.save(first, 1, any_result(random_), 0);
    other.save(second, 1, any_result(random_), 0);
    other.finish_run(1, "converged");
    other.finish_run(2, "no credit left");
  }
  const std::unique_ptr<Store> store = fresh();
  store->add(other_path, 2);
  EXPECT_FALSE(store->find(first));
  EXPECT_TRUE(store->find(second));
  EXPECT_FALSE(store->ending(1));
  EXPECT_EQ(store->ending(2), "no credit left");
}

TEST_F(StoreTest, TakesNothingFromAStoreThatIsOpenOrOfAnotherExperiment) {
  const std::filesystem::path other_path = folder_ / "other.sqlite";
  const std::unique_ptr<Store> store = fresh();
  {
    const Store other(other_path, experiment_, "build", Store::Opening::fresh);
    EXPECT_THROW(store->add(other_path), StoreError);
  }
  std::filesystem::remove(other_path);
  Experiment another = small_experiment();
  another.seed = 99;
  { const Store other(other_path, another, "build", Store::Opening::fresh); }
  EXPECT_THROW(store->add(other_path), StoreError);
  EXPECT_THROW(store->add(folder_ / "none.sqlite"), StoreError);
  store->save(Task{0, 0, 0, {1, 1, 1}, {}}, 1, any_result(random_), 0);
  EXPECT_EQ(ask("SELECT count(*) FROM trial"), "1") << "it still works";
}

TEST_F(StoreTest, GivesTrialsBackToTheLastBit) {
  std::vector<std::pair<Task, TrialResult>> saved;
  {
    const std::unique_ptr<Store> store = fresh();
    for (std::uint32_t i = 0; i < 200; ++i) {
      const Task task{
          i % 3, i / 3, i % 2, {i % 6, i % 4, i % 4}, i % 5 == 0 ? std::nullopt : std::optional(any_number(random_))};
      if (task.hopeless_below && std::isnan(*task.hopeless_below)) {
        continue;
      }
      saved.emplace_back(task, any_result(random_));
      store->save(task, 0xFFFFFFFFFFFFFFFFU - i, saved.back().second, i);
      const std::optional<TrialResult> found = store->find(task);
      ASSERT_TRUE(found);
      EXPECT_EQ(exact(*found), exact(saved.back().second));
    }
  }
  const std::unique_ptr<Store> store = resumed();
  for (const auto& [task, result] : saved) {
    const std::optional<TrialResult> found = store->find(task);
    ASSERT_TRUE(found);
    EXPECT_EQ(exact(*found), exact(result));
    EXPECT_EQ(found->wall_s, result.wall_s);
  }
  EXPECT_EQ(ask("SELECT seed FROM trial WHERE run = 0 AND number = 0"), "18446744073709551615");
}

TEST_F(StoreTest, FindsExactlyThatTask) {
  const std::unique_ptr<Store> store = fresh();
  const Task task{1, 5, 2, {1, 2, 3}, 0.5};
  store->save(task, 1, any_result(random_), 0);
  EXPECT_TRUE(store->find(task));
  for (const Task& other : {Task{0, 5, 2, {1, 2, 3}, 0.5}, Task{1, 4, 2, {1, 2, 3}, 0.5}, Task{1, 6, 2, {1, 2, 3}, 0.5},
                            Task{1, 5, 1, {1, 2, 3}, 0.5}, Task{1, 5, 2, {1, 2, 2}, 0.5}, Task{1, 5, 2, {1, 2}, 0.5},
                            Task{1, 5, 2, {1, 2, 3}, 0.25}, Task{1, 5, 2, {1, 2, 3}, {}}}) {
    EXPECT_FALSE(store->find(other));
  }
}

TEST_F(StoreTest, ReplacesAWrongPrediction) {
  const std::unique_ptr<Store> store = fresh();
  const Task wrong{0, 5, 0, {1, 2, 3}, {}};
  const Task right{0, 5, 0, {3, 2, 1}, {}};
  store->save(wrong, 1, any_result(random_), 0);
  store->save(right, 1, any_result(random_), 0);
  EXPECT_FALSE(store->find(wrong));
  EXPECT_TRUE(store->find(right));
  EXPECT_EQ(ask("SELECT count(*) FROM trial"), "1");
}

TEST_F(StoreTest, GivesEvaluationsBackToTheLastBit) {
  experiment_.objectives.push_back({"economy", {{sim::Measure::cost_of_transport, -2.0}}, Goal::minimise, 1e6});
  std::vector<Evaluation> saved;
  const std::unique_ptr<Store> store = fresh();
  for (std::uint32_t i = 0; i < 50; ++i) {
    const TrialResult any = any_result(random_);
    Evaluation evaluation{
        1,          i,     {i % 6, 1, 2}, {0.1 * i, -1e300}, any.measures, any.wall_s, any.simulated_s, any.given_up,
        i % 7 == 0, false, any.failure};
    store->save(evaluation);
    store->save(evaluation);
    saved.push_back(evaluation);
  }
  const std::vector<Evaluation> read = store->evaluations(1);
  ASSERT_EQ(read.size(), saved.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_EQ(exact(read[i]), exact(saved[i]));
    EXPECT_EQ(read[i].wall_s, saved[i].wall_s);
  }
  EXPECT_TRUE(store->evaluations(0).empty());
}

TEST_F(StoreTest, IsReadableForAPersonWhileItIsOpen) {
  experiment_.objectives.push_back({"economy", {{sim::Measure::cost_of_transport, 0.5}}, Goal::minimise, 1e6});
  const std::unique_ptr<Store> store = fresh();
  Evaluation evaluation{0, 7, {4, 2, 1}, {1.5, 2.5}, {}, 0.3, 30.0, false, false, false, ""};
  evaluation.measures[sim::Measure::distance] = 1.25;
  store->save(evaluation);
  EXPECT_EQ(ask("SELECT \"amplitude\" || ' ' || frequency || ' ' || phase_difference FROM evaluation"),
            "50.0 1.5 50.0");
  EXPECT_EQ(ask("SELECT \"score distance\" || ' ' || \"score economy\" || ' ' || distance FROM evaluation"),
            "1.5 2.5 1.25");
  EXPECT_EQ(ask("SELECT slip IS NULL FROM evaluation"), "1");
  EXPECT_EQ(ask("SELECT seed FROM evaluation"), std::to_string(trial_seed(experiment_.seed, 0, 0, 0)));
  EXPECT_EQ(ask("SELECT value FROM experiment WHERE key = 'fingerprint'"), experiment_.fingerprint());
  EXPECT_EQ(ask("SELECT value FROM experiment WHERE key = 'result_key'"), "build");
  EXPECT_EQ(ask("SELECT text FROM source WHERE position = 1"), "<optimise/>");
  EXPECT_EQ(ask("SELECT group_concat(name || ' [' || unit || ']', ', ') FROM dimension"),
            "amplitude [deg], frequency [Hz], phase_difference [deg]");
  EXPECT_EQ(ask("SELECT terms || ' ' || goal FROM objective WHERE name = 'economy'"),
            "0.5 * cost_of_transport minimise");
  EXPECT_EQ(ask("SELECT number FROM best"), "7");
  EXPECT_NE(ask("SELECT sql FROM sqlite_schema WHERE name = 'evaluation'").find("-- What the search used"),
            std::string::npos);
}

TEST_F(StoreTest, IsNotBlockedByASlowReader) {
  const std::unique_ptr<Store> store = fresh();
  Database reader(path_, SQLITE_OPEN_READONLY);
  reader.execute("BEGIN; SELECT count(*) FROM trial");
  for (std::uint32_t i = 0; i < 100; ++i) {
    store->save({0, i, 0, {1, 2, 3}, {}}, 1, any_result(random_), 0);
  }
  EXPECT_TRUE(store->find({0, 99, 0, {1, 2, 3}, {}}));
}

TEST_F(StoreTest, IfItsFileIsRenamedSavesNoMoreAndLeavesAllUntilThenInIt) {
  const std::filesystem::path renamed = folder_ / "renamed.sqlite";
  std::unique_ptr<Store> store = fresh();
  store->save({0, 0, 0, {1, 2, 3}, {}}, 1, any_result(random_), 0);
  std::filesystem::rename(path_, renamed);
  const std::string message = message_of<StoreError>([&] { store->finish_run(0, "converged"); });
  EXPECT_EQ(message.find(path_.string() + ": another program removed, renamed or replaced the file"), 0U) << message;
  store.reset();
  std::filesystem::rename(renamed, path_);
  EXPECT_EQ(ask("SELECT count(*) FROM trial"), "1");
  EXPECT_EQ(ask("PRAGMA integrity_check"), "ok");
}

TEST_F(StoreTest, ReportsThatItsFileOrItsLogIsRemovedOrReplaced) {
  const std::filesystem::path log = path_.string() + "-wal";
  const std::filesystem::path copy = folder_ / "copy";
  const std::vector<std::function<void()>> changes{
      [&] { std::filesystem::remove(path_); },
      [&] {
        std::filesystem::copy_file(path_, copy);
        std::filesystem::rename(copy, path_);
      },
      [&] { std::filesystem::remove(log); },
  };
  for (const auto& change : changes) {
    const std::unique_ptr<Store> store = fresh();
    store->save({0, 0, 0, {1, 2, 3}, {}}, 1, any_result(random_), 0);
    change();
    EXPECT_NE(message_of<StoreError>([&] {
                store->save({0, 1, 0, {1, 2, 3}, {}}, 1, any_result(random_), 0);
              }).find("removed, renamed or replaced"),
              std::string::npos);
    std::filesystem::remove(path_);
  }
}

TEST_F(StoreTest, ReportsThatItsFileOrItsLogIsShortenedOrOverwrittenAndWritesNothingIntoIt) {
  const std::string other(200'000, 'x');
  const std::vector<std::pair<std::string, std::string>> changes{
      {path_.string(), ""}, {path_.string(), other}, {path_.string() + "-wal", ""}};
  for (const auto& [file, contents] : changes) {
    std::unique_ptr<Store> store = fresh();
    store->save({0, 0, 0, {1, 2, 3}, {}}, 1, any_result(random_), 0);
    std::ofstream(file, std::ios::binary) << contents;
    EXPECT_NE(message_of<StoreError>([&] {
                store->save({0, 1, 0, {1, 2, 3}, {}}, 1, any_result(random_), 0);
              }).find("shortened or overwrote"),
              std::string::npos);
    store.reset();
    EXPECT_EQ(file_contents(file), contents);
    std::filesystem::remove(path_);
    std::filesystem::remove(path_.string() + "-wal");
  }
}

TEST_F(StoreTest, ReportsThatAnotherStoreIsCopiedOverIt) {
  std::unique_ptr<Store> store = fresh();
  for (std::uint64_t number = 0; number < 200; ++number) {  // larger than the one below
    store->save({0, number, 0, {1, 2, 3}, {}}, 1, any_result(random_), 0);
  }
  store.reset();
  const std::string other = file_contents(path_);
  std::filesystem::remove(path_);

  store = fresh();
  store->save({0, 0, 0, {1, 2, 3}, {}}, 1, any_result(random_), 0);
  Database(path_, SQLITE_OPEN_READWRITE).execute("PRAGMA wal_checkpoint(PASSIVE)");  // as a long search does by itself
  std::fstream(path_, std::ios::binary | std::ios::in | std::ios::out) << other;
  EXPECT_NE(message_of<StoreError>([&] {
              store->save({0, 1, 0, {1, 2, 3}, {}}, 1, any_result(random_), 0);
            }).find("shortened or overwrote"),
            std::string::npos);
  store.reset();
  EXPECT_EQ(file_contents(path_), other);
}

TEST_F(StoreTest, AllowsAnotherProgramToEmptyTheLogInTheWayOfSqlite) {
  const std::unique_ptr<Store> store = fresh();
  store->save({0, 0, 0, {1, 2, 3}, {}}, 1, any_result(random_), 0);
  Database(path_, SQLITE_OPEN_READWRITE).execute("PRAGMA wal_checkpoint(TRUNCATE)");
  store->save({0, 1, 0, {1, 2, 3}, {}}, 1, any_result(random_), 0);
  EXPECT_EQ(ask("SELECT count(*) FROM trial"), "2");
}

TEST_F(StoreTest, WaitsForAnotherProgramThatWrites) {
  const std::unique_ptr<Store> store = fresh();
  Database other(path_, SQLITE_OPEN_READWRITE);
  other.execute("BEGIN IMMEDIATE");
  std::thread end([&] {
    std::this_thread::sleep_for(std::chrono::seconds(4));
    other.execute("COMMIT");
  });
  EXPECT_NO_THROW(store->finish_run(0, "converged"));
  end.join();
}

TEST_F(StoreTest, KnowsWhyARunEnded) {
  const std::unique_ptr<Store> store = fresh();
  EXPECT_EQ(store->ending(0), std::nullopt);
  store->finish_run(0, "first");
  store->finish_run(0, "no credit left");
  EXPECT_EQ(store->ending(0), "no credit left");
  EXPECT_EQ(store->ending(1), std::nullopt);
}

TEST_F(StoreTest, AcceptsNamesThatSqlReservesOrThatOccurTwice) {
  const std::vector<std::string> names{"distance", "Run", "select", "a\"b", "score distance", "A\"B"};
  experiment_.space.dimensions.resize(names.size(), experiment_.space.dimensions[0]);
  for (std::size_t i = 0; i < names.size(); ++i) {
    experiment_.space.dimensions[i].name = names[i];
  }
  const std::unique_ptr<Store> store = fresh();
  store->save(Evaluation{0, 0, {0, 1, 2, 3, 4, 5}, {1.0}, {}, 0, 0, false, false, false, ""});
  ASSERT_EQ(store->evaluations(0).size(), 1U);
  EXPECT_EQ(ask("SELECT group_concat(column_name, ' ') FROM dimension"),
            "distance_ Run_ select a\"b score distance_ A\"B_");
  EXPECT_EQ(ask("SELECT \"A\"\"B_\" FROM evaluation"), "60.0");
}

TEST_F(StoreTest, AcceptsMoreDimensionsThanATableHasColumns) {
  experiment_.space.dimensions.resize(3000, experiment_.space.dimensions[0]);
  for (std::size_t i = 0; i < 3000; ++i) {
    experiment_.space.dimensions[i].name = "parameter " + std::to_string(i);
  }
  const std::unique_ptr<Store> store = fresh();
  Candidate candidate(3000, 1);
  candidate.back() = 5;
  store->save(Evaluation{0, 0, candidate, {1.0}, {}, 0, 0, false, false, false, ""});
  EXPECT_EQ(store->evaluations(0).at(0).candidate, candidate);
}

}  // namespace
}  // namespace proleg::optimize
