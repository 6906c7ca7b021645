#include "sim/optimize/evaluation/worker_pool.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <map>
#include <numeric>
#include <thread>

#include "small_experiment.hpp"

namespace proleg::optimize {
namespace {

using std::chrono::milliseconds;

/// Forks a process for each search, which calls search(number, its workers); returns their exit statuses. 100: an
/// exception.
std::vector<int> statuses_of(WorkerPool& pool, std::uint32_t searches,
                             const std::function<int(std::uint32_t, std::unique_ptr<Workers>)>& search) {
  std::vector<pid_t> processes;
  for (std::uint32_t i = 0; i < searches; ++i) {
    processes.push_back(fork());
    if (processes.back() == 0) {
      int status = 100;
      try {
        status = search(i, pool.workers_of(i));
      } catch (const std::runtime_error&) {
        status = 100;
      }
      _exit(status);
    }
  }
  pool.leave_to_searches();
  std::vector<int> statuses;
  for (const pid_t process : processes) {
    int status = 0;
    EXPECT_EQ(waitpid(process, &status, 0), process);
    statuses.push_back(WIFEXITED(status) ? WEXITSTATUS(status) : -1);
  }
  return statuses;
}

TrialResult result_of(Workers& workers, const Task& task) {
  start(workers, task.number, task);
  std::optional<Workers::Done> done;
  while (!done) {
    done = workers.wait(milliseconds(1000));
  }
  return done->result;
}

Experiment reduced_experiment() {
  Experiment experiment = small_experiment();
  experiment.scenario.environment.engine = sim::PhysicsEngine::reduced;
  return experiment;
}

/// In a worker: writes the size of its batch into a file, takes 20 ms, and makes results up.
RunTasks noting_batches(const std::filesystem::path& file) {
  return [file](const Experiment& experiment, std::span<const Task> tasks) {
    std::ofstream(file, std::ios::app) << tasks.size() << '\n';
    std::this_thread::sleep_for(milliseconds(20));
    return one_by_one(made_up_trial)(experiment, tasks);
  };
}

std::vector<std::size_t> noted_batches(const std::filesystem::path& file) {
  std::vector<std::size_t> sizes;
  std::ifstream stream(file);
  for (std::size_t size = 0; stream >> size;) {
    sizes.push_back(size);
  }
  return sizes;
}

TEST(WorkerPool, GivesEachSearchTheResultsThatRunTrialGives) {
  const Experiment noisy = noisy_experiment();
  WorkerPool pool(noisy, 2, 3);
  const std::vector<int> statuses =
      statuses_of(pool, 3, [&](std::uint32_t search, const std::unique_ptr<Workers>& workers) {
        int wrong = 0;
        for (std::uint32_t i = 0; i < 8; ++i) {
          const Task task{search, i, i % 2, {i % 5, search, (i + 1) % 4}, {}};
          wrong += exact(result_of(*workers, task)) == exact(run_trial(noisy, task)) ? 0 : 1;
        }
        return wrong;
      });
  EXPECT_EQ(statuses, std::vector<int>(3, 0));
}

TEST(WorkerPool, FillsBatchesWithTheTasksOfAllSearches) {
  const TemporaryFolder folder;
  const Experiment experiment = reduced_experiment();
  WorkerPool pool(experiment, 1, 8, noting_batches(folder / "batches"));
  const std::vector<int> statuses =
      statuses_of(pool, 8, [&](std::uint32_t search, const std::unique_ptr<Workers>& workers) {
        for (std::uint32_t i = 0; i < 20; ++i) {
          static_cast<void>(result_of(*workers, {search, i, 0, {i % 5, 0, 0}, {}}));
        }
        return 0;
      });
  EXPECT_EQ(statuses, std::vector<int>(8, 0));
  const std::vector<std::size_t> sizes = noted_batches(folder / "batches");
  EXPECT_EQ(std::accumulate(sizes.begin(), sizes.end(), std::size_t{0}), 160U);
  EXPECT_LT(sizes.size(), 80U) << "each search has one task at a time; together they are at least two in a batch";
  EXPECT_LE(*std::ranges::max_element(sizes), 8U);
}

TEST(WorkerPool, GivesTheLastSearchThePlacesOfThoseThatHaveEnded) {
  const TemporaryFolder folder;
  const Experiment experiment = reduced_experiment();
  WorkerPool pool(experiment, 1, 2, noting_batches(folder / "batches"));
  const std::vector<int> statuses =
      statuses_of(pool, 2, [&](std::uint32_t search, const std::unique_ptr<Workers>& workers) {
        int share = static_cast<int>(workers->most_at_once());
        if (search == 0 || share != 4) {
          return share;
        }
        for (std::uint32_t i = 0; share == 4 && i < 500; ++i) {
          static_cast<void>(result_of(*workers, {search, i, 0, {i % 5, 0, 0}, {}}));
          share = static_cast<int>(workers->most_at_once());
        }
        return share;
      });
  EXPECT_EQ(statuses, (std::vector<int>{4, 8}));
}

TEST(WorkerPool, WorksForTheOthersWhenASearchIsKilled) {
  const Experiment experiment = small_experiment();
  WorkerPool pool(experiment, 1, 2, one_by_one(made_up_trial));
  const std::vector<int> statuses =
      statuses_of(pool, 2, [&](std::uint32_t search, const std::unique_ptr<Workers>& workers) {
        if (search == 0) {
          start(*workers, 1, {0, 1, 0, {0, 0, 0}, {}});
          raise(SIGKILL);
        }
        for (std::uint32_t i = 0; i < 50; ++i) {
          const Task task{search, i, 0, {i % 5, 0, 0}, {}};
          if (exact(result_of(*workers, task)) != exact(made_up_trial(experiment, task))) {
            return 1;
          }
        }
        return 0;
      });
  EXPECT_EQ(statuses, (std::vector<int>{-1, 0}));
}

TEST(WorkerPool, GivesTheShareOfAKilledSearchToTheOthers) {
  const TemporaryFolder folder;
  const Experiment experiment = reduced_experiment();
  WorkerPool pool(experiment, 1, 2, noting_batches(folder / "batches"));
  const std::vector<int> statuses =
      statuses_of(pool, 2, [&](std::uint32_t search, const std::unique_ptr<Workers>& workers) {
        if (search == 0) {
          raise(SIGKILL);
        }
        int share = static_cast<int>(workers->most_at_once());
        for (std::uint32_t i = 0; share == 4 && i < 500; ++i) {
          static_cast<void>(result_of(*workers, {search, i, 0, {i % 5, 0, 0}, {}}));
          share = static_cast<int>(workers->most_at_once());
        }
        return share;
      });
  EXPECT_EQ(statuses, (std::vector<int>{-1, 8}));
}

TEST(WorkerPool, ReplacesAWorkerThatHangsWhileAnotherIsIdle) {
  const TemporaryFolder folder;
  const Experiment experiment = small_experiment();
  const RunTasks run = one_by_one([&](const Experiment& its, const Task& task) {
    if (!std::filesystem::exists(folder / "hung")) {
      std::ofstream(folder / "hung") << '.';
      std::this_thread::sleep_for(std::chrono::hours(1));
    }
    return made_up_trial(its, task);
  });
  WorkerPool pool(experiment, 2, 1, run, {.fixed = milliseconds(5000), .per_simulated_second = 0.0});
  const std::vector<int> statuses =
      statuses_of(pool, 1, [&](std::uint32_t /*search*/, const std::unique_ptr<Workers>& workers) {
        const Task task{0, 3, 0, {1, 0, 0}, {}};
        return exact(result_of(*workers, task)) == exact(made_up_trial(experiment, task)) ? 0 : 1;
      });
  EXPECT_EQ(statuses, (std::vector<int>{0}));
}

TEST(WorkerPool, RepeatsATaskWhoseWorkerDiedAndEndsWithOneThatCannotBeSimulated) {
  const TemporaryFolder folder;
  const Experiment experiment = small_experiment();
  const RunTasks run = one_by_one([&](const Experiment& its, const Task& task) {
    const bool first = !std::filesystem::exists(folder / "died");
    if (task.number == 17 || (task.number == 3 && first)) {
      std::ofstream(folder / "died") << '.';
      raise(SIGKILL);
    }
    return made_up_trial(its, task);
  });
  WorkerPool pool(experiment, 1, 1, run);
  const std::vector<int> statuses =
      statuses_of(pool, 1, [&](std::uint32_t /*search*/, const std::unique_ptr<Workers>& workers) {
        const Task repeated{0, 3, 0, {1, 0, 0}, {}};
        if (exact(result_of(*workers, repeated)) != exact(made_up_trial(experiment, repeated))) {
          return 1;
        }
        static_cast<void>(result_of(*workers, {0, 17, 0, {1, 0, 0}, {}}));
        return 2;
      });
  EXPECT_EQ(statuses, (std::vector<int>{100})) << "an exception, and not an endless wait";
}

}  // namespace
}  // namespace proleg::optimize
