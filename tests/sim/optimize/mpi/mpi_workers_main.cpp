// Run by mpirun with the name of a test; rank 0 prints "passed", or what went wrong.

#include "sim/optimize/mpi/mpi_workers.hpp"

#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <fstream>
#include <set>

#include "sim/optimize/evaluation/evaluator.hpp"
#include "sim/optimize/evaluation/task.hpp"
#include "small_experiment.hpp"

namespace {

using namespace proleg::optimize;
using proleg::TemporaryFolder;

constexpr const char* build = "test";

bool is_rank_0() { return mpi_rank().value().rank == 0; }

/// Throws unless it holds.
void expect(bool holds, const std::string& what) {
  if (!holds) {
    throw std::runtime_error("expected " + what);
  }
}

/// Evaluates candidates that depend on the scores so far, with predictions of which half are right, and compares each
/// outcome.
void search_and_compare(const Experiment& experiment, Workers& workers) {
  std::set<std::uint32_t> used;
  Evaluator evaluator(experiment, 0, workers, nullptr, {}, {});
  std::mt19937 random(8);
  std::uint32_t pick = 0;
  for (std::uint64_t number = 0; number < 24; ++number) {
    const Candidate candidate{pick % 6, pick % 4, pick / 4 % 4};
    std::vector<Candidate> next{candidate};
    while (next.size() < evaluator.lookahead()) {
      next.push_back(random_candidate(experiment, random));
    }
    if (number % 2 == 0) {
      evaluator.expect(next);
    }
    const std::vector<double> scores = evaluator.fitness(candidate);
    const std::vector<TrialResult> trials{run_trial(experiment, {0, number, 0, candidate, {}})};
    expect(scores == rate(experiment, 0, number, candidate, trials).scores,
           "the scores of evaluation " + std::to_string(number));
    pick = static_cast<std::uint32_t>(scores.front() * 1e9);
  }
}

/// A batch for each worker.
void compare_batches(const Experiment& experiment, Workers& workers) {
  std::mt19937 random(3);
  std::vector<Task> tasks;
  for (std::uint64_t worker = 0; worker < 4; ++worker) {
    std::vector<TicketedTask> batch;
    for (std::uint64_t i = 0; i < 3 + worker; ++i) {
      tasks.push_back({0, tasks.size(), 0, random_candidate(experiment, random), {}});
      batch.push_back({100 + tasks.back().number, tasks.back()});
    }
    workers.start(batch);
  }
  expect(workers.idle() == 0, "no idle worker");
  std::set<std::uint64_t> tickets;
  while (tickets.size() < tasks.size()) {
    if (const auto done = workers.wait(std::chrono::milliseconds(100))) {
      expect(tickets.insert(done->ticket).second, "one result of each task");
      expect(exact(done->result) == exact(run_trial(experiment, tasks.at(done->ticket - 100))),
             "the result of task " + std::to_string(done->ticket - 100));
    }
  }
  expect(workers.idle() == 4, "4 idle workers");
}

void equals_local_workers(bool in_batches) {
  Experiment experiment = noisy_experiment(1, 0.1);
  if (in_batches) {
    experiment.scenario.environment.engine = proleg::sim::PhysicsEngine::reduced;
  }
  if (!is_rank_0()) {
    expect(serve_mpi(experiment, build), "that all have the same experiment");
    return;
  }
  MpiWorkers workers(experiment, build);
  expect(workers.count() == 4, "4 workers");
  expect(workers.idle() == 4, "4 idle workers");
  search_and_compare(experiment, workers);
  // Each of them gets tasks and has its own number.
  while (workers.wait(std::chrono::milliseconds(100)) || workers.idle() < 4) {
  }
  for (std::uint64_t ticket = 0; ticket < 4; ++ticket) {
    start(workers, ticket, {0, ticket, 0, {1, 1, 1}, {}});
  }
  expect(workers.idle() == 0, "no idle worker");
  std::set<std::uint32_t> numbers;
  while (numbers.size() < 4) {
    if (const auto done = workers.wait(std::chrono::milliseconds(100))) {
      expect(numbers.insert(done->worker).second, "that each worker has one task");
      expect(exact(done->result) == exact(run_trial(experiment, {0, done->ticket, 0, {1, 1, 1}, {}})),
             "the result of ticket " + std::to_string(done->ticket));
    }
  }
  if (in_batches) {
    compare_batches(experiment, workers);
  }
  expect(workers.messages().empty(), "no messages");
}

void ends_in_the_middle_of_tasks() {
  const Experiment experiment = small_experiment();
  const RunTask hang = [](const Experiment&, const Task&) -> TrialResult {
    while (true) {
      pause();
    }
  };
  if (!is_rank_0()) {
    static_cast<void>(serve_mpi(experiment, build, one_by_one(hang)));
    return;
  }
  MpiWorkers workers(experiment, build, one_by_one(hang));
  for (std::uint64_t ticket = 0; ticket < 4; ++ticket) {
    start(workers, ticket, {});
  }
  expect(!workers.wait(std::chrono::milliseconds(50)), "no result");
}

void repeats_the_task_of_a_killed_worker() {
  const Experiment experiment = noisy_experiment();
  const TemporaryFolder folder;
  // In each rank the first worker dies at its first task.
  const RunTask first_dies = [&folder](const Experiment& its, const Task& task) {
    const std::filesystem::path died = folder / "died";
    if (!std::filesystem::exists(died)) {
      std::filesystem::create_directory(died);
      raise(SIGKILL);
    }
    return made_up_trial(its, task);
  };
  if (!is_rank_0()) {
    static_cast<void>(serve_mpi(experiment, build, one_by_one(first_dies)));
    return;
  }
  MpiWorkers workers(experiment, build, one_by_one(first_dies));
  for (std::uint64_t ticket = 0; ticket < 4; ++ticket) {
    start(workers, ticket, {0, ticket, 0, {1, 1, 1}, {}});
  }
  for (int results = 0; results < 4;) {
    if (const auto done = workers.wait(std::chrono::milliseconds(100))) {
      expect(exact(done->result) == exact(made_up_trial(experiment, {0, done->ticket, 0, {1, 1, 1}, {}})),
             "the result of ticket " + std::to_string(done->ticket));
      ++results;
    }
  }
  std::size_t from_others = 0;
  const std::vector<std::string> messages = workers.messages();
  for (const std::string& message : messages) {
    expect(message.find("was killed by signal 9") != std::string::npos, message);
    from_others += message.rfind("rank ", 0) == 0 ? 1U : 0U;
  }
  expect(messages.size() == 4 && from_others == 3, "four messages, one of each rank");
}

/// Lets a stopped process run again at the end, also after a failed expectation: it must answer stop, too.
class ContinuedAtTheEnd {
 public:
  explicit ContinuedAtTheEnd(std::filesystem::path pid_file) : pid_file_(std::move(pid_file)) {}
  ~ContinuedAtTheEnd() {
    pid_t stopped = 0;
    if (std::ifstream(pid_file_) >> stopped) {
      kill(stopped, SIGCONT);
    }
    std::error_code ignored;
    std::filesystem::remove(pid_file_, ignored);
  }
  ContinuedAtTheEnd(const ContinuedAtTheEnd&) = delete;
  ContinuedAtTheEnd& operator=(const ContinuedAtTheEnd&) = delete;

 private:
  std::filesystem::path pid_file_;
};

void continues_without_a_rank_that_stopped() {
  const Experiment experiment = noisy_experiment();
  const TaskLimit limit{std::chrono::milliseconds(1000), 0.0};
  // Known to all ranks: mpirun is the parent of each.
  const std::filesystem::path pid_file =
      std::filesystem::temp_directory_path() / ("proleg-mpi-" + std::to_string(getppid()));
  // The worker of rank 2 stops its rank, its parent, in the first task: not earlier, since all ranks wait for each
  // other while MPI starts. Only time within wait() of rank 0 counts.
  const bool stops_its_rank = !is_rank_0() && mpi_rank().value().rank == 2;
  const RunTask slow = [pid_file, stops_its_rank](const Experiment& its, const Task& task) {
    usleep(10'000);
    if (stops_its_rank && !std::filesystem::exists(pid_file)) {
      std::ofstream(pid_file) << getppid();
      kill(getppid(), SIGSTOP);
    }
    return made_up_trial(its, task);
  };
  if (!is_rank_0()) {
    static_cast<void>(serve_mpi(experiment, build, one_by_one(slow), limit));
    return;
  }
  MpiWorkers workers(experiment, build, one_by_one(slow), limit);
  const ContinuedAtTheEnd continued(pid_file);
  bool lost_rank_2 = false;
  std::uint32_t lost = 0;
  std::set<std::uint64_t> open;
  const auto receive = [&] {
    if (const auto done = workers.wait(std::chrono::milliseconds(20))) {
      expect(open.erase(done->ticket) == 1, "one result of each task");
    }
    // A busy computer may have reason for other messages, of a worker that was too slow.
    for (const std::string& message : workers.messages()) {
      lost += message.find("has not answered") != std::string::npos ? 1U : 0U;
      lost_rank_2 = lost_rank_2 || message.find("rank 2 has not answered") == 0;
    }
  };
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(300);
  std::uint64_t ticket = 0;
  while (!lost_rank_2) {
    expect(std::chrono::steady_clock::now() < end, "a message within 300 s");
    for (; workers.idle() > 0; ++ticket) {
      start(workers, ticket, {0, ticket, 0, {1, 1, 1}, {}});
      open.insert(ticket);
    }
    receive();
  }
  while (!open.empty()) {
    expect(std::chrono::steady_clock::now() < end, "all results within 300 s");
    receive();
  }
  expect(workers.count() == 4 - lost, "the workers that were not lost");
}

void rejects_another_experiment() {
  Experiment experiment = small_experiment();
  if (mpi_rank().value().rank == 2) {
    experiment.seed = 2;
  }
  if (!is_rank_0()) {
    expect(!serve_mpi(experiment, build), "an experiment that differs");
    return;
  }
  try {
    const MpiWorkers workers(experiment, build);
  } catch (const std::runtime_error& error) {
    expect(std::string(error.what()).find("rank 2 has experiment") == 0, error.what());
    return;
  }
  expect(false, "an error");
}

void reports_a_task_that_cannot_be_done() {
  const Experiment experiment = small_experiment();
  const RunTask deadly = [](const Experiment& its, const Task& task) {
    if (task.number == 17) {
      raise(SIGKILL);
    }
    return made_up_trial(its, task);
  };
  if (!is_rank_0()) {
    static_cast<void>(serve_mpi(experiment, build, one_by_one(deadly)));
    return;
  }
  MpiWorkers workers(experiment, build, one_by_one(deadly));
  start(workers, 0, {0, 17, 0, {}, {}});  // ranks above 0 get tasks first
  try {
    while (!workers.wait(std::chrono::milliseconds(100))) {
    }
  } catch (const std::runtime_error& error) {
    expect(std::string(error.what()).find("rank 1: evaluation 17 of run 0") == 0, error.what());
    return;
  }
  expect(false, "an error");
}

}  // namespace

int main(int argc, char** argv) {
  const std::string subject = argc == 2 ? argv[1] : "";
  try {
    if (subject == "EqualsLocalWorkers") {
      equals_local_workers(false);
    } else if (subject == "EqualsLocalWorkersInBatches") {
      equals_local_workers(true);
    } else if (subject == "EndsInTheMiddleOfTasks") {
      ends_in_the_middle_of_tasks();
    } else if (subject == "RepeatsTheTaskOfAKilledWorker") {
      repeats_the_task_of_a_killed_worker();
    } else if (subject == "ContinuesWithoutARankThatStopped") {
      continues_without_a_rank_that_stopped();
    } else if (subject == "RejectsAnotherExperiment") {
      rejects_another_experiment();
    } else if (subject == "ReportsATaskThatCannotBeDone") {
      reports_a_task_that_cannot_be_done();
    } else {
      throw std::runtime_error("there is no test '" + subject + "'");
    }
  } catch (const std::exception& error) {
    std::printf("failed: %s\n", error.what());
    return 1;
  }
  if (is_rank_0()) {
    std::printf("passed\n");
  }
  return 0;
}
