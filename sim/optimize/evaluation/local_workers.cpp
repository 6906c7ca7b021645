#include "sim/optimize/evaluation/local_workers.hpp"

#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <deque>
#include <stdexcept>
#include <system_error>
#include <utility>

namespace proleg::optimize {
namespace {

using Clock = std::chrono::steady_clock;

/// The search ends after this number of workers that died in one task. A worker that died this often without a task
/// is not replaced.
constexpr unsigned max_deaths = 3;

std::string name_of(const Task& task) {
  return "evaluation " + std::to_string(task.number) + " of run " + std::to_string(task.run);
}

std::string name_of(std::span<const TicketedTask> batch) {
  const std::string first = name_of(batch.front().task);
  return batch.size() == 1 ? first : "a batch of " + std::to_string(batch.size()) + " tasks from " + first + " on";
}

std::string joined(std::initializer_list<std::string> parts) {
  std::string text;
  for (const std::string& part : parts) {
    text += part;
  }
  return text;
}

}  // namespace

class LocalWorkers::Implementation {
 public:
  Implementation(const Experiment& experiment, std::uint32_t count, RunTasks run, TaskLimit limit)
      : experiment_(experiment),
        run_(std::move(run)),
        limit_(limit.fixed + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(
                                 limit.per_simulated_second * experiment.scenario.duration_s))),
        resting_limit_(limit.resting) {
    workers_.resize(count);
    for (std::uint32_t i = 0; i < count; ++i) {
      if (std::string reason = fork_worker(workers_[i]); !reason.empty()) {
        messages_.push_back(joined({"the system cannot start another process (", reason, "): ", std::to_string(i),
                                    " of ", std::to_string(count), " workers"}));
        require_worker(reason);
        break;
      }
    }
  }

  [[nodiscard]] std::uint32_t count() const {
    return static_cast<std::uint32_t>(
        std::ranges::count_if(workers_, [](const Worker& worker) { return worker.process != nullptr; }));
  }

  [[nodiscard]] std::uint32_t idle() const {
    return static_cast<std::uint32_t>(std::ranges::count_if(workers_, is_idle));
  }

  void start(std::span<const TicketedTask> batch) {
    const auto worker = std::ranges::find_if(workers_, is_idle);
    if (worker == workers_.end()) {
      throw std::logic_error("start() without an idle worker");
    }
    assign(*worker, {{batch.begin(), batch.end()}, 0});
  }

  std::optional<Done> wait(std::chrono::milliseconds timeout) {
    const Clock::time_point end = Clock::now() + timeout;
    while (true) {
      if (!finished_.empty()) {
        Done done = std::move(finished_.front());
        finished_.pop_front();
        return done;
      }
      const std::optional<int> ready = poll_workers(std::min(timeout, max_poll_time));
      if (!ready) {
        return std::nullopt;  // a signal: the caller may have to stop
      }
      for (std::uint32_t i = 0; *ready > 0 && i < workers_.size(); ++i) {
        if (workers_[i].readable) {
          receive(i);
        }
      }
      replace_hung();
      replace_resting();
      const Clock::time_point now = Clock::now();
      if (now >= end && finished_.empty()) {
        return std::nullopt;
      }
      timeout = std::chrono::ceil<std::chrono::milliseconds>(end - now);
    }
  }

  std::vector<std::string> messages() { return std::exchange(messages_, {}); }

 private:
  struct Assignment {
    std::vector<TicketedTask> batch;
    unsigned deaths;  ///< number of workers that died with the task
  };
  struct Worker {
    std::unique_ptr<WorkerProcess> process;  ///< null: not replaced
    std::optional<Assignment> assignment;
    Clock::duration busy{};    ///< with its tasks; of the time between two calls of wait() at most a second
    Clock::duration looked{};  ///< value of `busy` when its processor time was read
    std::chrono::nanoseconds processor_time{};
    unsigned resting = 0;      ///< looks at which that had not grown
    unsigned computing = 0;    ///< looks at which it had grown
    bool is_named = false;     ///< as one whose task takes long
    unsigned idle_deaths = 0;  ///< since its last result
    bool readable = false;
  };
  static constexpr std::chrono::milliseconds max_poll_time{1000};

  static bool is_idle(const Worker& worker) { return worker.process != nullptr && !worker.assignment; }

  /// Returns the reason if it failed, else an empty text.
  std::string fork_worker(Worker& worker) const {
    try {
      worker.process = std::make_unique<WorkerProcess>(experiment_, run_);
      return {};
    } catch (const std::system_error& error) {
      return error.what();
    }
  }

  void require_worker(const std::string& reason) const {
    if (count() == 0) {
      throw std::runtime_error("no worker is left: " + reason);
    }
  }

  static void assign(Worker& worker, Assignment assignment) {
    std::vector<Task> tasks;
    for (const TicketedTask& each : assignment.batch) {
      tasks.push_back(each.task);
    }
    worker.process->send(tasks);
    worker.assignment = std::move(assignment);
    worker.busy = {};
    worker.looked = {};
    worker.resting = 0;
    worker.computing = 0;
    worker.is_named = false;
  }

  /// Waits until a worker has sent something; returns the number of such workers, or nothing after a signal.
  std::optional<int> poll_workers(std::chrono::milliseconds timeout) {
    std::vector<pollfd> sockets;
    for (const Worker& worker : workers_) {
      sockets.push_back({worker.process != nullptr ? worker.process->socket() : -1, POLLIN, 0});
    }
    const int ready = poll(sockets.data(), sockets.size(), static_cast<int>(timeout.count()));
    if (ready < 0) {
      if (errno != EINTR) {
        throw std::system_error(errno, std::generic_category(), "waiting for workers");
      }
      return std::nullopt;
    }
    // A second at most: a program that was stopped (Ctrl-Z) and continued keeps its workers.
    const Clock::time_point now = Clock::now();
    const auto passed = std::min<Clock::duration>(now - last_poll_, max_poll_time);
    last_poll_ = now;
    for (std::size_t i = 0; i < workers_.size(); ++i) {
      workers_[i].readable = sockets[i].revents != 0;
      workers_[i].busy += passed;
    }
    return ready;
  }

  void receive(std::uint32_t number) {
    Worker& worker = workers_[number];
    worker.readable = false;
    WorkerProcess::Reply reply = worker.process->receive();
    if (const auto* failed = std::get_if<WorkerProcess::Failed>(&reply)) {
      replace(number, "failed (" + failed->what + ")");
      return;
    }
    if (std::holds_alternative<WorkerProcess::Gone>(reply) || !worker.assignment) {
      replace(number, {});
      return;
    }
    auto& results = std::get<std::vector<TrialResult>>(reply);
    if (results.size() != worker.assignment->batch.size()) {
      replace(number, "failed (it sent a wrong number of results)");
      return;
    }
    for (std::size_t i = 0; i < results.size(); ++i) {
      finished_.push_back({worker.assignment->batch[i].ticket, std::move(results[i]), number});
    }
    longest_ = std::max(longest_, worker.busy / static_cast<int>(results.size()));
    worker.assignment.reset();
    worker.idle_deaths = 0;
    assign_orphaned();
  }

  [[nodiscard]] Clock::duration time_limit(const Assignment& assignment) const {
    return limit_ * static_cast<int>(assignment.batch.size());
  }

  /// Names and then replaces workers whose tasks take too long.
  void replace_hung() {
    constexpr int unusual = 10;
    for (std::uint32_t i = 0; i < workers_.size(); ++i) {
      Worker& worker = workers_[i];
      if (!worker.assignment) {
        continue;
      }
      const Clock::duration limit = time_limit(*worker.assignment);
      const Clock::duration usual = longest_ * static_cast<int>(worker.assignment->batch.size());
      const Clock::duration suspicious = longest_ == Clock::duration{} ? limit / unusual : usual * unusual;
      if (worker.busy > limit) {
        replace(i, "did not answer for " + seconds_text(worker.busy));
      } else if (!worker.is_named && worker.computing > 1 && worker.busy > std::max(suspicious, resting_limit_)) {
        worker.is_named = true;
        messages_.push_back(
            joined({"worker ", std::to_string(i), " (process ", std::to_string(worker.process->id()),
                    ") has computed for ", seconds_text(worker.busy), " in ", name_of(worker.assignment->batch),
                    ", much longer than usual: an endless loop? It is replaced after ", seconds_text(limit)}));
      }
    }
  }

  /// Names and then replaces workers that use no processor time. Not each look at a busy worker reads that.
  void replace_resting() {
    constexpr unsigned looks = 4;  // in the time after which a worker is named
    for (std::uint32_t i = 0; i < workers_.size(); ++i) {
      Worker& worker = workers_[i];
      if (!worker.assignment || worker.busy < worker.looked + resting_limit_ / looks) {
        continue;
      }
      worker.looked = worker.busy;
      const std::chrono::nanoseconds before = std::exchange(worker.processor_time, worker.process->processor_time());
      const bool rests = worker.processor_time == before;
      worker.resting = rests ? worker.resting + 1 : 0;
      worker.computing = rests ? 0 : worker.computing + 1;
      if (worker.resting == looks) {
        messages_.push_back(joined({"worker ", std::to_string(i), " (process ", std::to_string(worker.process->id()),
                                    ") has computed nothing for ", seconds_text(resting_limit_), " in ",
                                    name_of(worker.assignment->batch), ": is it stopped? It is replaced after ",
                                    seconds_text(3 * resting_limit_)}));
      } else if (worker.resting >= 3 * looks) {
        replace(i, "computed nothing for " + seconds_text(3 * resting_limit_));
      }
    }
  }

  static std::string seconds_text(Clock::duration time) {
    return std::to_string(std::chrono::duration_cast<std::chrono::seconds>(time).count()) + " s";
  }

  /// Replaces a worker that failed, hung or died. what: what it did; empty: its exit status says it.
  void replace(std::uint32_t number, std::string what) {
    Worker& worker = workers_[number];
    const std::string process = std::to_string(worker.process->id());
    const std::string end = worker.process->end();
    worker.process.reset();
    what = joined({"worker ", std::to_string(number), " (process ", process, ") ", what.empty() ? end : what});
    std::optional<Assignment> assignment = std::exchange(worker.assignment, std::nullopt);
    if (assignment && ++assignment->deaths >= max_deaths) {
      throw std::runtime_error(joined({name_of(assignment->batch), " ended ", std::to_string(max_deaths),
                                       " workers, so it cannot be simulated: ", what}));
    }
    what += assignment ? " in " + name_of(assignment->batch) : " without a task";
    const std::string repeated = !assignment                     ? ""
                                 : assignment->batch.size() == 1 ? "evaluation repeated"
                                                                 : "its tasks repeated one by one";
    std::string reason = "it ended " + std::to_string(max_deaths) + " times";
    if (assignment || ++worker.idle_deaths < max_deaths) {
      reason = fork_worker(worker);
    }
    if (!reason.empty()) {
      messages_.push_back(joined({what, "; not started again: ", reason, assignment ? "; " : "", repeated}));
      require_worker(reason);
    } else {
      messages_.push_back(joined({what, "; started again", assignment ? ", " : "", repeated}));
    }
    if (assignment) {
      repeat(std::move(*assignment));
    }
  }

  /// Which task of a batch ended the worker is not known. Alone, each has its own number of deaths.
  void repeat(Assignment assignment) {
    if (assignment.batch.size() == 1) {
      orphaned_.push_back(std::move(assignment));
    } else {
      for (TicketedTask& each : assignment.batch) {
        orphaned_.push_back({{std::move(each)}, 0});
      }
    }
    assign_orphaned();
  }

  void assign_orphaned() {
    for (Worker& worker : workers_) {
      if (!orphaned_.empty() && is_idle(worker)) {
        assign(worker, std::move(orphaned_.front()));
        orphaned_.pop_front();
      }
    }
  }

  const Experiment& experiment_;
  RunTasks run_;
  Clock::duration limit_;
  Clock::duration resting_limit_;
  Clock::duration longest_{};  ///< that a worker needed for a task
  std::vector<Worker> workers_;
  Clock::time_point last_poll_ = Clock::now();
  std::deque<Assignment> orphaned_;  ///< tasks whose worker died, until one is idle
  std::deque<Done> finished_;        ///< results that wait() has not given yet
  std::vector<std::string> messages_;
};

LocalWorkers::LocalWorkers(const Experiment& experiment, std::uint32_t count, RunTasks run, TaskLimit limit)
    : implementation_(std::make_unique<Implementation>(experiment, count, std::move(run), limit)) {}
LocalWorkers::~LocalWorkers() = default;
std::uint32_t LocalWorkers::count() const { return implementation_->count(); }
std::uint32_t LocalWorkers::idle() const { return implementation_->idle(); }
void LocalWorkers::start(std::span<const TicketedTask> batch) { implementation_->start(batch); }
std::optional<Workers::Done> LocalWorkers::wait(std::chrono::milliseconds timeout) {
  return implementation_->wait(timeout);
}
std::vector<std::string> LocalWorkers::messages() { return implementation_->messages(); }

}  // namespace proleg::optimize
