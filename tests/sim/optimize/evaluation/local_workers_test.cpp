#include "sim/optimize/evaluation/local_workers.hpp"

#include <gtest/gtest.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <fstream>
#include <map>
#include <set>
#include <thread>

#include "small_experiment.hpp"

namespace proleg::optimize {
namespace {

using std::chrono::milliseconds;

/// In a worker: how often the function was called in this test, over all processes, from 1.
int count_call(const std::filesystem::path& file) {
  std::ofstream(file, std::ios::app) << '.';
  return static_cast<int>(std::filesystem::file_size(file));
}

/// Waits for a result for as long as it takes.
Workers::Done next(Workers& workers) {
  std::optional<Workers::Done> done;
  while (!done) {
    done = workers.wait(milliseconds(1000));
  }
  return *done;
}

class LocalWorkersTest : public testing::Test {
 protected:
  /// Calls `misfortune` first at the first call for evaluation 17; then made_up_trial.
  [[nodiscard]] RunTasks once(const std::function<void()>& misfortune) const {
    return one_by_one([this, misfortune](const Experiment& experiment, const Task& task) {
      if (task.number == 17 && count_call(folder_ / "calls") == 1) {
        misfortune();
      }
      return made_up_trial(experiment, task);
    });
  }

  TemporaryFolder folder_;
  Experiment experiment_ = small_experiment();
  Task task_{0, 17, 0, {3, 1, 2}, {}};
};

TEST_F(LocalWorkersTest, GiveTheResultsThatRunTrialGives) {
  const Experiment noisy = noisy_experiment();
  LocalWorkers workers(noisy, 2);
  EXPECT_EQ(workers.count(), 2U);
  std::vector<Task> tasks;
  for (std::uint32_t i = 0; i < 6; ++i) {
    tasks.push_back({0, i, i % 2, {i, i % 4, (i + 1) % 4}, {}});
  }
  std::map<std::uint64_t, TrialResult> results;
  for (std::size_t given = 0; results.size() < tasks.size();) {
    while (given < tasks.size() && workers.idle() > 0) {
      start(workers, given, tasks[given]);
      ++given;
    }
    Workers::Done done = next(workers);
    EXPECT_LT(done.worker, 2U);
    EXPECT_TRUE(results.emplace(done.ticket, done.result).second);
  }
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    EXPECT_EQ(exact(results.at(i)), exact(run_trial(noisy, tasks[i])));
  }
  EXPECT_EQ(workers.idle(), 2U);
  EXPECT_TRUE(workers.messages().empty());
}

/// Tasks of evaluations 15 to 19, with tickets that are ten times as high.
std::vector<TicketedTask> five_tasks() {
  std::vector<TicketedTask> batch;
  for (std::uint32_t number = 15; number < 20; ++number) {
    batch.push_back({10 * number, {0, number, 0, {number % 6, 1, 2}, {}}});
  }
  return batch;
}

/// Expects a result of each of the five tasks.
void expect_five_results(const Experiment& experiment, Workers& workers) {
  std::map<std::uint64_t, std::string> results;
  for (int i = 0; i < 5; ++i) {
    const Workers::Done done = next(workers);
    EXPECT_TRUE(results.emplace(done.ticket, exact(done.result)).second) << done.ticket;
  }
  for (const TicketedTask& each : five_tasks()) {
    EXPECT_EQ(results[each.ticket], exact(made_up_trial(experiment, each.task))) << each.ticket;
  }
  EXPECT_EQ(workers.idle(), workers.count());
}

TEST_F(LocalWorkersTest, GiveAResultForEachTaskOfABatch) {
  LocalWorkers workers(experiment_, 2, one_by_one(made_up_trial));
  workers.start(five_tasks());
  EXPECT_EQ(workers.idle(), 1U);
  expect_five_results(experiment_, workers);
  EXPECT_TRUE(workers.messages().empty());
}

TEST_F(LocalWorkersTest, TakeTheLargestBatch) {
  LocalWorkers workers(experiment_, 1, one_by_one([](const Experiment&, const Task& task) {
                         TrialResult result;
                         result.simulated_s = task.candidate.back();
                         return result;
                       }));
  std::vector<TicketedTask> batch;
  for (std::uint32_t i = 0; i < 64; ++i) {
    batch.push_back({i, {0, i, 0, Candidate(1000, i), {}}});  // no space has more dimensions
  }
  workers.start(batch);
  for (std::uint32_t i = 0; i < 64; ++i) {
    EXPECT_EQ(next(workers).result.simulated_s, i);
  }
  EXPECT_TRUE(workers.messages().empty());
}

TEST_F(LocalWorkersTest, RepeatTheTasksOfABatchOneByOneAfterADeath) {
  for (const std::function<void()>& misfortune :
       {std::function<void()>([] { raise(SIGKILL); }), {[] { throw std::bad_alloc(); }}}) {
    for (const std::uint32_t count : {1U, 2U}) {
      std::filesystem::remove(folder_ / "calls");
      LocalWorkers workers(experiment_, count, once(misfortune));
      workers.start(five_tasks());
      expect_five_results(experiment_, workers);
      const std::vector<std::string> messages = workers.messages();
      ASSERT_EQ(messages.size(), 1U);
      EXPECT_NE(messages[0].find("in a batch of 5 tasks from evaluation 15 of run 0 on; started again, its tasks "
                                 "repeated one by one"),
                std::string::npos)
          << messages[0];
    }
  }
}

TEST_F(LocalWorkersTest, NameTheTaskOfABatchThatEndsThreeWorkersAlone) {
  for (const std::uint32_t count : {1U, 2U}) {
    LocalWorkers workers(experiment_, count, one_by_one([](const Experiment& experiment, const Task& task) {
                           if (task.number == 17) {
                             raise(SIGKILL);
                           }
                           return made_up_trial(experiment, task);
                         }));
    workers.start(five_tasks());
    std::set<std::uint64_t> survivors;
    try {
      while (true) {
        survivors.insert(next(workers).ticket);
      }
    } catch (const std::runtime_error& error) {
      EXPECT_EQ(std::string(error.what()).find("evaluation 17 of run 0 ended 3 workers"), 0U) << error.what();
    }
    if (count == 1) {
      // The task is repeated after all others.
      EXPECT_EQ(survivors, (std::set<std::uint64_t>{150, 160, 180, 190}));
    } else {
      // The second worker may still have another task.
      EXPECT_FALSE(survivors.contains(170));
    }
  }
}

TEST_F(LocalWorkersTest, HaveTheTimeOfAllTheirTasks) {
  // Each task takes less than its limit, together they take more than one.
  LocalWorkers workers(experiment_, 1, one_by_one([](const Experiment& experiment, const Task& task) {
                         usleep(700'000);
                         return made_up_trial(experiment, task);
                       }),
                       {milliseconds(3000), 0.0});
  workers.start(five_tasks());
  expect_five_results(experiment_, workers);
  EXPECT_TRUE(workers.messages().empty());
}

TEST_F(LocalWorkersTest, GiveABatchUpThatHangs) {
  LocalWorkers workers(experiment_, 1, once([] {
                         while (true) {
                           pause();
                         }
                       }),
                       {milliseconds(2000), 0.0});
  workers.start(five_tasks());
  expect_five_results(experiment_, workers);
  const std::vector<std::string> messages = workers.messages();
  ASSERT_EQ(messages.size(), 1U);
  EXPECT_NE(messages[0].find("did not answer"), std::string::npos) << messages[0];
}

TEST_F(LocalWorkersTest, ReplaceOneThatGivesTooFewResults) {
  LocalWorkers workers(experiment_, 1, [](const Experiment& experiment, std::span<const Task> tasks) {
    return std::vector<TrialResult>{made_up_trial(experiment, tasks.front())};
  });
  workers.start(five_tasks());
  expect_five_results(experiment_, workers);
  EXPECT_NE(workers.messages().at(0).find("wrong number of results"), std::string::npos);
}

TEST_F(LocalWorkersTest, WithoutATaskHaveNoResult) {
  LocalWorkers workers(experiment_, 1);
  EXPECT_FALSE(workers.wait(milliseconds(0)));
}

TEST_F(LocalWorkersTest, RepeatTheTaskOfAWorkerThatIsKilled) {
  LocalWorkers workers(experiment_, 1, once([] { raise(SIGKILL); }));
  start(workers, 5, task_);
  const Workers::Done done = next(workers);
  EXPECT_EQ(done.ticket, 5U);
  EXPECT_EQ(exact(done.result), exact(made_up_trial(experiment_, task_)));
  const std::vector<std::string> messages = workers.messages();
  ASSERT_EQ(messages.size(), 1U);
  std::string message = messages[0];
  const std::size_t process = message.find("process ") + 8;
  message.erase(process, message.find(')') - process);
  EXPECT_EQ(message,
            "worker 0 (process ) was killed by signal 9 in evaluation 17 of run 0; started again, evaluation repeated");
  EXPECT_TRUE(workers.messages().empty());
  EXPECT_EQ(workers.idle(), 1U);
}

TEST_F(LocalWorkersTest, RepeatTheTaskOfAWorkerThatEndsOrThrows) {
  for (const auto& [misfortune, what] :
       {std::pair<std::function<void()>, std::string>{[] { _exit(3); }, "ended with exit status 3"},
        {[] { throw std::bad_alloc(); }, "failed (std::bad_alloc)"}}) {
    std::filesystem::remove(folder_ / "calls");
    LocalWorkers workers(experiment_, 1, once(misfortune));
    start(workers, 1, task_);
    EXPECT_EQ(exact(next(workers).result), exact(made_up_trial(experiment_, task_)));
    const std::vector<std::string> messages = workers.messages();
    ASSERT_EQ(messages.size(), 1U);
    EXPECT_NE(messages[0].find(what), std::string::npos) << messages[0];
  }
}

TEST_F(LocalWorkersTest, ReplaceOneThatDiesWithoutATask) {
  const RunTask report_process = [](const Experiment&, const Task&) {
    TrialResult result;
    result.simulated_s = getpid();
    return result;
  };
  LocalWorkers workers(experiment_, 1, one_by_one(report_process));
  start(workers, 1, task_);
  const auto process = static_cast<pid_t>(next(workers).result.simulated_s);
  ASSERT_NE(process, getpid());
  kill(process, SIGKILL);
  std::vector<std::string> messages;
  while (messages.empty()) {
    EXPECT_FALSE(workers.wait(milliseconds(10)));
    messages = workers.messages();
  }
  EXPECT_NE(messages[0].find("was killed by signal 9 without a task; started again"), std::string::npos);
  start(workers, 2, task_);
  EXPECT_NE(static_cast<pid_t>(next(workers).result.simulated_s), process);
}

TEST_F(LocalWorkersTest, EndTheSearchIfThreeWorkersDieInATask) {
  const RunTask deadly = [this](const Experiment& experiment, const Task& task) {
    if (task.number == 17) {
      count_call(folder_ / "calls");
      raise(SIGSEGV);
    }
    return made_up_trial(experiment, task);
  };
  // The sanitizers would report the signal at length.
  std::signal(SIGSEGV, SIG_DFL);
  LocalWorkers workers(experiment_, 2, one_by_one(deadly));
  start(workers, 1, task_);
  start(workers, 2, {0, 18, 0, {0, 0, 0}, {}});
  try {
    while (true) {
      if (const std::optional<Workers::Done> done = workers.wait(milliseconds(1000))) {
        EXPECT_EQ(done->ticket, 2U);
      }
    }
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("evaluation 17 of run 0"), std::string::npos) << error.what();
  }
  EXPECT_EQ(count_call(folder_ / "calls"), 4);
}

TEST_F(LocalWorkersTest, ReplaceOneThatHangs) {
  LocalWorkers workers(experiment_, 1, once([] {
                         while (true) {
                           pause();
                         }
                       }),
                       {milliseconds(5000), 0.0});
  start(workers, 1, task_);
  EXPECT_EQ(exact(next(workers).result), exact(made_up_trial(experiment_, task_)));
  const std::vector<std::string> messages = workers.messages();
  ASSERT_EQ(messages.size(), 1U);
  EXPECT_NE(messages[0].find("did not answer"), std::string::npos) << messages[0];
}

TEST_F(LocalWorkersTest, NameAndThenReplaceOneThatIsStopped) {
  LocalWorkers workers(experiment_, 1, once([] { std::raise(SIGSTOP); }), {.resting = milliseconds(400)});
  workers.start(std::vector{TicketedTask{1, task_}});
  const Workers::Done done = next(workers);
  EXPECT_EQ(exact(done.result), exact(made_up_trial(experiment_, task_)));
  const std::vector<std::string> messages = workers.messages();
  ASSERT_EQ(messages.size(), 2U);
  EXPECT_NE(messages[0].find("has computed nothing for 0 s in evaluation 17 of run 0: is it stopped?"),
            std::string::npos)
      << messages[0];
  EXPECT_NE(messages[1].find("computed nothing for 1 s in evaluation 17 of run 0; started again, evaluation repeated"),
            std::string::npos)
      << messages[1];
}

TEST_F(LocalWorkersTest, NameAndThenReplaceOneThatComputesMuchLongerThanTheOthers) {
  // A loop without a pause would not let the virtual time pass.
  LocalWorkers workers(experiment_, 1, once([] {
                         for (std::atomic<unsigned> turns = 0;; ++turns) {
                           if (turns % 100'000 == 0) {
                             std::this_thread::sleep_for(milliseconds(10));
                           }
                         }
                       }),
                       {.fixed = milliseconds(3000), .per_simulated_second = 0.0, .resting = milliseconds(400)});
  start(workers, 1, {0, 16, 0, {3, 1, 2}, {}});
  next(workers);
  workers.start(std::vector{TicketedTask{1, task_}});
  EXPECT_EQ(exact(next(workers).result), exact(made_up_trial(experiment_, task_)));
  const std::vector<std::string> messages = workers.messages();
  ASSERT_EQ(messages.size(), 2U);
  EXPECT_NE(messages[0].find(" in evaluation 17 of run 0, much longer than usual: an endless loop? It is replaced "
                             "after 3 s"),
            std::string::npos)
      << messages[0];
  EXPECT_NE(messages[1].find("did not answer"), std::string::npos) << messages[1];
}

TEST_F(LocalWorkersTest, IgnoreTheSignalsThatAreForTheirParent) {
  const RunTask asked_to_end = [](const Experiment& experiment, const Task& task) {
    raise(SIGINT);
    raise(SIGTERM);
    raise(SIGHUP);
    return made_up_trial(experiment, task);
  };
  LocalWorkers workers(experiment_, 1, one_by_one(asked_to_end));
  start(workers, 1, task_);
  next(workers);
  EXPECT_TRUE(workers.messages().empty());
}

TEST_F(LocalWorkersTest, HoldNoDescriptorOfTheirParent) {
  const RunTask count_descriptors = [](const Experiment&, const Task&) {
    TrialResult result;
    for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
      result.simulated_s += 1.0;
    }
    return result;
  };
  std::ifstream open_file("/dev/zero");
  LocalWorkers workers(experiment_, 3, one_by_one(count_descriptors));
  for (std::uint64_t i = 0; i < 3; ++i) {
    start(workers, i, task_);
  }
  for (int i = 0; i < 3; ++i) {
    // Standard input, output and error, the socket, and that of the listing.
    EXPECT_EQ(next(workers).result.simulated_s, 5.0);
  }
}

TEST_F(LocalWorkersTest, WaitReturnsWhenASignalComes) {
  std::signal(SIGALRM, [](int) {});
  {
    // Virtual time stands still while the worker works. One signal may come before wait() does.
    LocalWorkers workers(experiment_, 1, [](const Experiment&, std::span<const Task>) -> std::vector<TrialResult> {
      while (true) {
        kill(getppid(), SIGALRM);
        sched_yield();
      }
    });
    start(workers, 1, task_);
    EXPECT_FALSE(workers.wait(milliseconds(100'000)));  // or the test takes longer than it may
  }
  std::signal(SIGALRM, SIG_DFL);
}

TEST_F(LocalWorkersTest, EndWithTheirParentEvenIfItIsKilled) {
  // A process without its parent becomes a child of this process, which can then wait for its end.
  prctl(PR_SET_CHILD_SUBREAPER, 1);
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  const pid_t parent = fork();
  if (parent == 0) {
    LocalWorkers workers(experiment_, 2, [this](const Experiment&, std::span<const Task>) -> std::vector<TrialResult> {
      count_call(folder_ / "calls");
      while (true) {
        pause();
      }
    });
    start(workers, 1, task_);
    while (!std::filesystem::exists(folder_ / "calls")) {
      static_cast<void>(workers.wait(milliseconds(1)));
    }
    if (write(ends[1], "x", 1) != 1) {
      _exit(1);
    }
    while (true) {
      pause();
    }
  }
  char ready = 0;
  ASSERT_EQ(read(ends[0], &ready, 1), 1);
  kill(parent, SIGKILL);
  // One worker has a task, the other has none.
  int gone = 0;
  for (pid_t process = wait(nullptr); process > 0; process = wait(nullptr)) {
    ++gone;
  }
  EXPECT_EQ(gone, 3);
  prctl(PR_SET_CHILD_SUBREAPER, 0);
  close(ends[0]);
  close(ends[1]);
}

/// Descriptors represent any scarce resource: a worker needs one, and two while it is made.
class ScarceSystem : public LocalWorkersTest {
 protected:
  ScarceSystem() { getrlimit(RLIMIT_NOFILE, &before_); }
  ~ScarceSystem() override { setrlimit(RLIMIT_NOFILE, &before_); }

  void leave_descriptors(rlim_t count) const {
    const int next = dup(STDERR_FILENO);
    close(next);
    const rlimit limit{static_cast<rlim_t>(next) + count, before_.rlim_max};
    ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &limit), 0);
  }

  rlimit before_{};
};

TEST_F(ScarceSystem, GivesFewerWorkers) {
  leave_descriptors(3);
  LocalWorkers workers(experiment_, 5, one_by_one(made_up_trial));
  setrlimit(RLIMIT_NOFILE, &before_);
  EXPECT_EQ(workers.count(), 2U);
  const std::vector<std::string> messages = workers.messages();
  ASSERT_EQ(messages.size(), 1U);
  EXPECT_NE(messages[0].find("2 of 5 workers"), std::string::npos) << messages[0];
  start(workers, 1, task_);
  EXPECT_EQ(next(workers).ticket, 1U);
}

TEST_F(ScarceSystem, WithoutAnyWorkerIsAnError) {
  leave_descriptors(1);
  EXPECT_THROW(LocalWorkers(experiment_, 5, one_by_one(made_up_trial)), std::runtime_error);
}

TEST_F(ScarceSystem, ThatCannotReplaceAWorkerGivesItsTaskToAnother) {
  LocalWorkers workers(experiment_, 2, once([] { raise(SIGKILL); }));
  leave_descriptors(0);
  start(workers, 1, task_);
  start(workers, 2, {0, 18, 0, {0, 0, 0}, {}});
  // The dead worker's descriptor is free again, but two are needed for a new one.
  std::map<std::uint64_t, TrialResult> results;
  while (results.size() < 2) {
    const Workers::Done done = next(workers);
    results[done.ticket] = done.result;
  }
  setrlimit(RLIMIT_NOFILE, &before_);
  EXPECT_EQ(exact(results.at(1)), exact(made_up_trial(experiment_, task_)));
  EXPECT_EQ(workers.count(), 1U);
  EXPECT_EQ(workers.idle(), 1U);
  const std::vector<std::string> messages = workers.messages();
  ASSERT_EQ(messages.size(), 1U);
  EXPECT_NE(messages[0].find("not started again"), std::string::npos) << messages[0];
}

}  // namespace
}  // namespace proleg::optimize
