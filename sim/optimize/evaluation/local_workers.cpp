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

/// Deaths by one task that end the search; also of a worker without a task, before it is given up.
constexpr unsigned most_deaths = 3;

std::string place_of(const Task& task) {
  return "evaluation " + std::to_string(task.number) + " of run " + std::to_string(task.run);
}

std::string sentence(std::initializer_list<std::string> parts) {
  std::string text;
  for (const std::string& part : parts) {
    text += part;
  }
  return text;
}

}  // namespace

class LocalWorkers::Implementation {
 public:
  Implementation(const Experiment& experiment, std::uint32_t count, RunTask run, TaskLimit limit)
      : experiment_(experiment),
        run_(std::move(run)),
        limit_(limit.fixed + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(
                                 limit.per_simulated_second * experiment.scenario.duration_s))) {
    workers_.resize(count);
    for (std::uint32_t i = 0; i < count; ++i) {
      if (std::string refusal = fork_worker(workers_[i]); !refusal.empty()) {
        messages_.push_back(sentence({"the system refuses a process (", refusal, "): ", std::to_string(i), " of ",
                                      std::to_string(count), " workers"}));
        require_worker(refusal);
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

  void start(std::uint64_t ticket, const Task& task) {
    const auto worker = std::ranges::find_if(workers_, is_idle);
    if (worker == workers_.end()) {
      throw std::logic_error("a task for workers of which none is idle");
    }
    give(*worker, {ticket, task, 0});
  }

  std::optional<Done> wait(std::chrono::milliseconds timeout) {
    const Clock::time_point end = Clock::now() + timeout;
    while (true) {
      const std::optional<int> ready = look(std::min(timeout, longest_look));
      if (!ready) {
        return std::nullopt;  // a signal: the caller may want to stop
      }
      for (std::uint32_t i = 0; *ready > 0 && i < workers_.size(); ++i) {
        if (workers_[i].readable) {
          if (std::optional<Done> done = receive(i)) {
            return done;
          }
        }
      }
      kill_hung();
      const Clock::time_point now = Clock::now();
      if (now >= end) {
        return std::nullopt;
      }
      timeout = std::chrono::ceil<std::chrono::milliseconds>(end - now);
    }
  }

  std::vector<std::string> messages() { return std::exchange(messages_, {}); }

 private:
  struct Assignment {
    std::uint64_t ticket;
    Task task;
    unsigned deaths;  ///< of workers that had it
  };
  struct Worker {
    std::unique_ptr<WorkerProcess> process;  ///< null: given up
    std::optional<Assignment> assignment;
    Clock::duration busy{};    ///< with the task, while somebody waited
    unsigned idle_deaths = 0;  ///< in a row
    bool readable = false;
  };
  static constexpr std::chrono::milliseconds longest_look{1000};

  static bool is_idle(const Worker& worker) { return worker.process != nullptr && !worker.assignment; }

  /// Empty if it worked, else why not.
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
      throw std::runtime_error("no process is left that could simulate: " + reason);
    }
  }

  static void give(Worker& worker, Assignment assignment) {
    worker.process->send(assignment.task);
    worker.assignment = std::move(assignment);
    worker.busy = {};
  }

  /// Waits until a worker has something to say; nothing if a signal came.
  std::optional<int> look(std::chrono::milliseconds timeout) {
    std::vector<pollfd> sockets;
    for (const Worker& worker : workers_) {
      sockets.push_back({worker.process != nullptr ? worker.process->socket() : -1, POLLIN, 0});
    }
    const Clock::time_point start = Clock::now();
    const int ready = poll(sockets.data(), sockets.size(), static_cast<int>(timeout.count()));
    if (ready < 0) {
      if (errno != EINTR) {
        throw std::system_error(errno, std::generic_category(), "waiting for workers");
      }
      return std::nullopt;
    }
    const auto passed = std::min<Clock::duration>(Clock::now() - start, longest_look);
    for (std::size_t i = 0; i < workers_.size(); ++i) {
      workers_[i].readable = sockets[i].revents != 0;
      workers_[i].busy += passed;
    }
    return ready;
  }

  std::optional<Done> receive(std::uint32_t number) {
    Worker& worker = workers_[number];
    worker.readable = false;
    const WorkerProcess::Reply reply = worker.process->receive();
    if (const auto* failed = std::get_if<WorkerProcess::Failed>(&reply)) {
      replace(number, "failed (" + failed->what + ")");
      return std::nullopt;
    }
    if (std::holds_alternative<WorkerProcess::Gone>(reply) || !worker.assignment) {
      replace(number, {});
      return std::nullopt;
    }
    const std::uint64_t ticket = worker.assignment->ticket;
    worker.assignment.reset();
    worker.idle_deaths = 0;
    if (!homeless_.empty()) {
      give(worker, std::move(homeless_.front()));
      homeless_.pop_front();
    }
    return Done{ticket, std::get<TrialResult>(reply), number};
  }

  void kill_hung() {
    for (std::uint32_t i = 0; i < workers_.size(); ++i) {
      if (workers_[i].assignment && workers_[i].busy > limit_) {
        const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(workers_[i].busy).count();
        replace(i, "gave no answer for " + std::to_string(seconds) + " s");
      }
    }
  }

  /// Of a worker that can do no more. what: it did, if its end does not say so itself.
  void replace(std::uint32_t number, std::string what) {
    Worker& worker = workers_[number];
    const std::string process = std::to_string(worker.process->id());
    const std::string end = worker.process->end();
    worker.process.reset();
    what = sentence({"worker ", std::to_string(number), " (process ", process, ") ", what.empty() ? end : what});
    std::optional<Assignment> assignment = std::exchange(worker.assignment, std::nullopt);
    if (assignment && ++assignment->deaths >= most_deaths) {
      throw std::runtime_error(sentence({place_of(assignment->task), " cost ", std::to_string(most_deaths),
                                         " workers, a simulation of it cannot be had: ", what}));
    }
    what += assignment ? " in " + place_of(assignment->task) : " without a task";
    std::string refusal = "it did so " + std::to_string(most_deaths) + " times";
    if (assignment || ++worker.idle_deaths < most_deaths) {
      refusal = fork_worker(worker);
    }
    if (!refusal.empty()) {
      messages_.push_back(
          sentence({what, "; not started again: ", refusal, assignment ? "; evaluation repeated" : ""}));
      require_worker(refusal);
    } else {
      messages_.push_back(what + "; started again" + (assignment ? ", evaluation repeated" : ""));
    }
    if (assignment) {
      repeat(std::move(*assignment), worker);
    }
  }

  void repeat(Assignment assignment, Worker& replacement) {
    const auto worker = replacement.process != nullptr ? workers_.begin() + (&replacement - workers_.data())
                                                       : std::ranges::find_if(workers_, is_idle);
    if (worker != workers_.end()) {
      give(*worker, std::move(assignment));
    } else {
      homeless_.push_back(std::move(assignment));
    }
  }

  const Experiment& experiment_;
  RunTask run_;
  Clock::duration limit_;
  std::vector<Worker> workers_;
  std::deque<Assignment> homeless_;  ///< tasks whose worker died without a successor, while all others were busy
  std::vector<std::string> messages_;
};

LocalWorkers::LocalWorkers(const Experiment& experiment, std::uint32_t count, RunTask run, TaskLimit limit)
    : implementation_(std::make_unique<Implementation>(experiment, count, std::move(run), limit)) {}
LocalWorkers::~LocalWorkers() = default;
std::uint32_t LocalWorkers::count() const { return implementation_->count(); }
std::uint32_t LocalWorkers::idle() const { return implementation_->idle(); }
void LocalWorkers::start(std::uint64_t ticket, const Task& task) { implementation_->start(ticket, task); }
std::optional<Workers::Done> LocalWorkers::wait(std::chrono::milliseconds timeout) {
  return implementation_->wait(timeout);
}
std::vector<std::string> LocalWorkers::messages() { return implementation_->messages(); }

}  // namespace proleg::optimize
