#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <fstream>
#include <optional>
#include <random>
#include <thread>

#include "shared/computer/sqlite/sqlite.hpp"
#include "sim/optimize/evaluation/store.hpp"
#include "sim/optimize/evaluation/store_summary.hpp"
#include "sim/scenario/overrides.hpp"
#include "sim/scenario/sources.hpp"
#include "small_experiment.hpp"
#include "tests/support/files.hpp"

namespace proleg::optimize {
namespace {

class StoreFile : public testing::Test {
 protected:
  std::unique_ptr<Store> open(Store::Opening opening, const Experiment& experiment,
                              const std::string& key = "key 1") const {
    return std::make_unique<Store>(path_, experiment, key, opening);
  }
  /// The message of the error.
  [[nodiscard]] std::string refused(Store::Opening opening, const Experiment& experiment,
                                    const std::string& key = "key 1") const {
    try {
      open(opening, experiment, key);
      return "nothing";
    } catch (const StoreError& error) {
      const std::string what = error.what();
      EXPECT_EQ(what.find('\n'), std::string::npos) << what;
      EXPECT_EQ(what.rfind(path_.string() + ": ", 0), 0U) << what;
      return what.substr(std::min(what.size(), path_.string().size() + 2));
    }
  }
  [[nodiscard]] std::string not_resumed() const { return refused(Store::Opening::resume, experiment_); }

  void make() const { open(Store::Opening::fresh, experiment_); }
  void write_file(const std::string& text) const { std::ofstream(path_) << text; }
  void execute(const char* sql) const {
    Database database(path_, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE);
    database.execute(sql);
  }

  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_ / "store.sqlite";
  Experiment experiment_ = small_experiment();
};

TEST_F(StoreFile, ThatExistsIsNotMadeAgain) {
  make();
  EXPECT_NE(refused(Store::Opening::fresh, experiment_).find("exists already"), std::string::npos);
  std::filesystem::remove(path_);
  write_file("");
  EXPECT_NE(refused(Store::Opening::fresh, experiment_).find("exists already"), std::string::npos);
  EXPECT_EQ(std::filesystem::file_size(path_), 0U);
}

TEST_F(StoreFile, ThatDoesNotExistIsNotResumed) {
  EXPECT_NE(not_resumed().find("does not exist"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(path_));
}

TEST_F(StoreFile, OfAnotherKindIsNotResumed) {
  write_file("not a database at all, but long enough to be one: " + std::string(200, 'x'));
  EXPECT_EQ(not_resumed(), "is not the store of an experiment");
  std::filesystem::remove(path_);
  write_file("");
  EXPECT_EQ(not_resumed(), "is not the store of an experiment");
  std::filesystem::remove(path_);
  execute("CREATE TABLE experiment(key, value)");
  EXPECT_EQ(not_resumed(), "is not the store of an experiment");
  std::filesystem::remove(path_);
  std::filesystem::create_directory(path_);
  EXPECT_NE(not_resumed().find("is not a file"), std::string::npos);
}

TEST_F(StoreFile, OfAnotherFormatIsNotResumed) {
  make();
  execute("PRAGMA user_version = 77");
  EXPECT_NE(not_resumed().find("has format 77"), std::string::npos);
}

TEST_F(StoreFile, ThatIsDamagedIsNotResumed) {
  make();
  std::filesystem::resize_file(path_, std::filesystem::file_size(path_) - 4096);
  EXPECT_NE(not_resumed(), "nothing");
}

TEST_F(StoreFile, OfAProgramWithOtherResultsIsNotResumed) {
  open(Store::Opening::fresh, experiment_)->save_search(7, "of a day");
  const std::string what = refused(Store::Opening::resume, experiment_, "key 2");
  EXPECT_NE(what.find("other sources, compiler or libraries (build of a day)"), std::string::npos) << what;
}

TEST_F(StoreFile, GivesItsExperimentAgainWithTheOptionsOfTheCommandLine) {
  const auto same = [&](const Experiment& made) {
    const Experiment read = read_experiment_of(path_);
    EXPECT_EQ(read.fingerprint(), made.fingerprint());
    EXPECT_EQ(read.evaluations, made.evaluations);
    std::filesystem::remove(path_);
  };
  sim::DiskFiles files;
  const std::filesystem::path file = source_path("/sim/scenarios/travelling_wave/cma_es.optimise.xml");
  Experiment made = read_experiment(file, files);
  open(Store::Opening::fresh, made);
  same(made);
  made.seed = 5;
  sim::OverrideWords words;
  words.engine = "reduced";
  made.scenario.overrides = sim::read_overrides(words);
  sim::apply_overrides(made.scenario.overrides, made.scenario.environment);
  set_trials(made, 3);
  open(Store::Opening::fresh, made)->save_search(made.evaluations, "a build", 3);
  same(made);
}

TEST_F(StoreFile, IsLookedAtWhileAnotherProgramWritesIt) {
  const std::unique_ptr<Store> writer = open(Store::Opening::fresh, experiment_);
  std::mt19937 random(3);
  std::vector<Evaluation> made;
  const auto add = [&](std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      const Candidate candidate = random_candidate(experiment_, random);
      const TrialResult result = made_up_trial(experiment_, {0, made.size(), 0, candidate, {}});
      made.push_back(rate(experiment_, 0, made.size(), candidate, {&result, 1}));
      writer->save(made.back());
    }
  };
  add(20);
  const std::unique_ptr<Store> reader = open(Store::Opening::look, experiment_);
  EXPECT_EQ(reader->evaluation_count(0), 20U);
  add(5);
  const std::vector<Evaluation> newest = reader->evaluations(0, 20, 3);
  ASSERT_EQ(newest.size(), 3U);
  EXPECT_EQ(newest.front().number, 20U);
  EXPECT_EQ(newest.front().candidate, made[20].candidate);
  EXPECT_EQ(newest.back().scores, made[22].scores);
  EXPECT_EQ(reader->evaluations(0, 25).size(), 0U);
  EXPECT_FALSE(reader->ending(0));
  EXPECT_THROW(reader->save(made.front()), StoreError) << "it only looks";
  EXPECT_EQ(refused(Store::Opening::look, experiment_, "another key"), "nothing");
}

TEST_F(StoreFile, SaysWhatAListOfSearchesShows) {
  experiment_.evaluations = 60;
  const std::unique_ptr<Store> writer = open(Store::Opening::fresh, experiment_);
  writer->save_search(60, "a build");
  StoreSummary before = read_store_summary(path_);
  EXPECT_EQ(before.made, 0U);
  EXPECT_EQ(before.planned, 60U);
  EXPECT_EQ(before.runs, 1U);
  EXPECT_EQ(before.objective, "distance");
  EXPECT_EQ(before.unit, "m");
  EXPECT_TRUE(before.maximises);
  EXPECT_FALSE(before.best);
  EXPECT_FALSE(before.ending);
  EXPECT_EQ(before.started.size(), std::string("2026-11-27T23:40:00Z").size());
  std::mt19937 random(4);
  std::optional<Evaluation> best;
  for (std::uint64_t number = 0; number < 60; ++number) {
    const Candidate candidate = random_candidate(experiment_, random);
    const TrialResult result = made_up_trial(experiment_, {0, number, 0, candidate, {}});
    const Evaluation evaluation = rate(experiment_, 0, number, candidate, {&result, 1});
    writer->save(evaluation);
    if (is_better(experiment_, evaluation, best ? &*best : nullptr)) {
      best = evaluation;
    }
    const StoreSummary now = read_store_summary(path_, number % 7 == 0 ? &before : nullptr);
    EXPECT_EQ(now.made, number + 1);
    EXPECT_EQ(now.best.has_value(), best.has_value());
    if (best) {
      EXPECT_EQ(now.best, best->number) << "with and without what was read before";
      EXPECT_EQ(now.best_score, best->scores.front());
    }
    before = now;
  }
  writer->finish_run(0, "converged");
  EXPECT_EQ(read_store_summary(path_, &before).ending, "converged");
  EXPECT_THROW(static_cast<void>(read_store_summary(path_ / "nothing")), StoreError);
}

TEST_F(StoreFile, ItsWriterIsAskedToStop) {
  EXPECT_FALSE(is_being_written(path_));
  EXPECT_THROW(request_stop(path_), StoreError) << "there is none";
  {
    const std::unique_ptr<Store> writer = open(Store::Opening::fresh, experiment_);
    EXPECT_TRUE(is_being_written(path_));
    EXPECT_FALSE(writer->is_stop_requested());
    request_stop(path_);
    EXPECT_TRUE(is_stop_requested(path_));
    while (!writer->is_stop_requested()) {  // it looks five times a second
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }
  EXPECT_FALSE(is_being_written(path_));
  EXPECT_FALSE(is_stop_requested(path_)) << "it is done";
  std::ofstream(path_.string() + ".stop").close();  // the writer was killed before it had stopped
  EXPECT_FALSE(open(Store::Opening::resume, experiment_)->is_stop_requested());
}

TEST_F(StoreFile, CanBeOpenedWhileOthersLookWhetherItIsWritten) {
  make();
  std::atomic<bool> ends = false;
  std::thread looker([&] {
    while (!ends) {
      static_cast<void>(is_being_written(path_));
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  });
  for (int i = 0; i < 200; ++i) {
    EXPECT_EQ(not_resumed(), "nothing");
  }
  ends = true;
  looker.join();
}

TEST_F(StoreFile, HasAllThatIsNeededToReadItsExperimentAgain) {
  experiment_.seed = 18'446'744'073'709'551'615U;
  experiment_.evaluations = 20;
  make();
  const StoredExperiment stored = read_stored_experiment(path_);
  EXPECT_EQ(stored.path, experiment_.path);
  EXPECT_EQ(stored.scenario, experiment_.scenario.path);
  EXPECT_EQ(stored.seed, experiment_.seed);
  EXPECT_EQ(stored.evaluations, 20U);
  ASSERT_EQ(stored.sources.size(), experiment_.sources.size());
  for (std::size_t i = 0; i < stored.sources.size(); ++i) {
    EXPECT_EQ(stored.sources[i].path, experiment_.sources[i].path);
    EXPECT_EQ(stored.sources[i].text, experiment_.sources[i].text);
  }
  open(Store::Opening::resume, experiment_)->save_search(40, "a build");
  EXPECT_EQ(read_stored_experiment(path_).evaluations, 40U);
  EXPECT_THROW(static_cast<void>(read_stored_experiment(path_ / "nothing")), StoreError);
}

TEST_F(StoreFile, OfAnotherExperimentIsNotResumedAndTheMessageNamesTheDifferences) {
  make();
  const auto differs = [this](const std::function<void(Experiment&)>& change) {
    Experiment other = small_experiment();
    change(other);
    const std::string what = refused(Store::Opening::resume, other);
    const std::string intro = "differences: ";
    const std::size_t start = what.find(intro);
    EXPECT_NE(what.find("another experiment"), std::string::npos) << what;
    return start == std::string::npos ? what : what.substr(start + intro.size());
  };
  EXPECT_EQ(differs([](Experiment& other) { other.seed = 2; }), "seed");
  EXPECT_EQ(differs([](Experiment& other) { other.space.dimensions[0].values.pop_back(); }), "search space");
  EXPECT_EQ(differs([](Experiment& other) { other.trials.count = 3; }), "trials");
  EXPECT_EQ(differs([](Experiment& other) { other.racing.after = 0.5; }), "racing");
  EXPECT_EQ(differs([](Experiment& other) { other.reuse = false; }), "reuse");
  EXPECT_EQ(differs([](Experiment& other) { other.objectives[0].terms[0].weight = 2.0; }), "fitness");
  EXPECT_EQ(differs([](Experiment& other) { other.method = GeneticSettings{}; }), "method");
  EXPECT_EQ(differs([](Experiment& other) { std::get<GreatDelugeSettings>(other.method).rain = 0.02; }), "method");
  EXPECT_EQ(differs([](Experiment& other) {
              other.scenario.sources.back().text = other.scenario.sources.back().text.str() + " ";
            }),
            "file " + std::filesystem::path(experiment_.scenario.sources.back().path).filename().string());
}

TEST_F(StoreFile, OfAnotherSimulatedRobotIsNotResumed) {
  put_on_robot(experiment_, "sim:a.simulation.xml");
  make();
  EXPECT_EQ(read_stored_experiment(path_).simulated_robot, "sim:a.simulation.xml");
  EXPECT_EQ(not_resumed(), "nothing");
  for (const char* other : {"sim:b.simulation.xml", ""}) {
    Experiment experiment = small_experiment();
    put_on_robot(experiment, other);
    const std::string what = refused(Store::Opening::resume, experiment);
    EXPECT_TRUE(what.ends_with("differences: simulated robot")) << what;
  }
}

TEST_F(StoreFile, ThatIsCutShortIsADamagedDatabase) {
  make();
  std::filesystem::resize_file(path_, std::filesystem::file_size(path_) / 2);
  const std::string what = not_resumed();
  EXPECT_TRUE(what.starts_with("found a damaged database (")) << what;
  EXPECT_TRUE(what.ends_with("), expected the store of a search")) << what;
}

TEST_F(StoreFile, IsResumedWithAnotherBudgetAndFromAnotherFolder) {
  make();
  experiment_.evaluations = 5;
  experiment_.path = "elsewhere/small.optimise.xml";
  EXPECT_EQ(not_resumed(), "nothing");
}

TEST_F(StoreFile, AllowsOneWriterAtATime) {
  {
    const std::unique_ptr<Store> first = open(Store::Opening::fresh, experiment_);
    EXPECT_NE(not_resumed().find("another program is writing to it"), std::string::npos);
    first->save(Task{}, 1, {}, 0);  // the refusal took no lock away
    EXPECT_NE(not_resumed().find("another program is writing to it"), std::string::npos);
  }
  EXPECT_EQ(not_resumed(), "nothing");
}

TEST_F(StoreFile, HasNoLockOfOursOnTheFileThatSqliteLocks) {
  const std::unique_ptr<Store> store = open(Store::Opening::fresh, experiment_);
  const int file = ::open(path_.c_str(), O_RDWR | O_CLOEXEC);
  ASSERT_GE(file, 0);
  EXPECT_EQ(flock(file, LOCK_EX | LOCK_NB), 0) << "on a network file system this would be SQLite's own kind of lock";
  close(file);
}

TEST_F(StoreFile, InAFolderThatCannotBeWrittenIsRefused) {
  path_ = folder_ / "none/store.sqlite";
  EXPECT_NE(refused(Store::Opening::fresh, experiment_).find("cannot be created: No such file"), std::string::npos);
  if (geteuid() == 0) {
    GTEST_SKIP() << "root may write everywhere";
  }
  std::filesystem::create_directory(folder_ / "none");
  std::filesystem::permissions(folder_ / "none",
                               std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  EXPECT_NE(refused(Store::Opening::fresh, experiment_).find("cannot be created: Permission denied"),
            std::string::npos);
}

TEST_F(StoreFile, OfAProcessKilledWhileItWasMadeIsMadeAgain) {
  std::ofstream(path_.string() + ".new") << "SQLite format 3, and then the process was killed";
  make();
  EXPECT_EQ(not_resumed(), "nothing");
  EXPECT_FALSE(std::filesystem::exists(path_.string() + ".new"));
}

/// A child process that saves trials until it is stopped, and reports each one that it has saved.
class StoreOfAnotherProcess : public StoreFile {
 protected:
  /// prepare: runs in the child. Returns how many were saved; kills the child after `enough` of them. outcome: the last
  /// message of the child.
  std::uint32_t save(const std::function<void()>& prepare, std::uint32_t enough, std::string& outcome) {
    int ends[2];
    if (pipe(ends) != 0) {
      throw std::runtime_error("no pipe");
    }
    const pid_t child = fork();
    if (child == 0) {
      std::string what;
      try {
        const std::unique_ptr<Store> store = open(Store::Opening::fresh, experiment_);
        prepare();
        for (std::uint32_t i = 0; write(ends[1], "+", 1) == 1; ++i) {
          TrialResult result;
          result.simulated_s = i;
          store->save({0, i, 0, {1, 2, 3}, {}}, i, result, 0);
          store->save(Evaluation{0, i, {1, 2, 3}, {1.0}, {}, 0, 0, false, false, false, ""});
        }
      } catch (const StoreError& error) {
        what = error.what();
      }
      _exit(write(ends[1], what.data(), what.size()) == static_cast<ssize_t>(what.size()) ? 0 : 1);
    }
    close(ends[1]);
    std::uint32_t begun = 0;
    for (char c = 0; read(ends[0], &c, 1) == 1;) {
      if (c == '+') {
        if (++begun == enough) {
          kill(child, SIGKILL);
        }
      } else {
        outcome += c;
      }
    }
    close(ends[0]);
    waitpid(child, nullptr, 0);
    return begun - 1;
  }

  void expect_trials(std::uint32_t count) {
    const std::unique_ptr<Store> store = open(Store::Opening::resume, experiment_);
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::optional<TrialResult> found = store->find({0, i, 0, {1, 2, 3}, {}});
      ASSERT_TRUE(found) << i;
      EXPECT_EQ(found->simulated_s, i);
    }
    const std::size_t evaluations = store->evaluations(0).size();
    EXPECT_GE(evaluations, count);
    EXPECT_LE(evaluations, count + 1);
    // More can be saved.
    store->save({0, count + 1, 0, {1, 2, 3}, {}}, 1, {}, 0);
    EXPECT_TRUE(store->find({0, count + 1, 0, {1, 2, 3}, {}}));
  }
};

TEST_F(StoreOfAnotherProcess, ThatIsKilledHasAllThatWasSaved) {
  std::random_device device;
  const std::uint32_t enough = 20 + device() % 300;
  std::printf("killed after %u\n", enough);
  std::string outcome;
  const std::uint32_t saved = save([] {}, enough, outcome);
  EXPECT_EQ(outcome, "");
  EXPECT_GE(saved + 1, enough);
  expect_trials(saved);
}

TEST_F(StoreOfAnotherProcess, OnAFullDiskKeepsWhatWasSaved) {
  std::string outcome;
  const std::uint32_t saved = save(
      [] {
        std::signal(SIGXFSZ, SIG_IGN);
        const rlimit limit{300'000, 300'000};
        setrlimit(RLIMIT_FSIZE, &limit);
      },
      1'000'000, outcome);
  EXPECT_EQ(outcome, path_.string() + ": no space left on the disk; all evaluations until now are kept");
  EXPECT_GT(saved, 10U);
  expect_trials(saved);
}

}  // namespace
}  // namespace proleg::optimize
