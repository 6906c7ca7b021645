#include "sim/optimize/evaluation/worker_pool.hpp"

#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <deque>
#include <exception>
#include <iostream>
#include <optional>
#include <stdexcept>
#include <system_error>
#include <unordered_map>
#include <utility>

#include "shared/computer/child_process/leave_parent.hpp"
#include "sim/loop/simulation_batch.hpp"
#include "sim/optimize/evaluation/local_workers.hpp"
#include "sim/optimize/evaluation/message.hpp"

namespace proleg::optimize {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

/// Time for which an idle worker waits for more tasks than there are: the searches that got their results a moment ago
/// are about to ask for the next ones.
constexpr milliseconds collecting_time{5};
/// Longest time until results are read. Without an idle worker nothing else is urgent.
constexpr milliseconds result_time{100};

constexpr const char* pool_has_ended = "the process that simulates for all searches has ended";

/// What a search sends when it has ended. No list of tasks is so short.
const Bytes farewell{std::byte{0}};

/// Tasks that a search may have at the pool, so that all together fill the batches of all workers.
std::size_t share_of_search(const Experiment& experiment, std::uint32_t workers, std::size_t searches) {
  return std::max<std::size_t>(workers * WorkerPool::tasks_of_worker(experiment) / std::max<std::size_t>(searches, 1),
                               1);
}

/// Results, and the share of the search from now on, in front of them.
Bytes reply_with(std::size_t share, std::span<const TrialResult> results) {
  Bytes reply = to_bytes(results);
  reply.insert(reply.begin(), static_cast<std::byte>(std::min<std::size_t>(share, 255)));
  return reply;
}

/// The process of the pool.
class Pool {
 public:
  Pool(const Experiment& experiment, std::uint32_t workers, std::span<const int> sockets, const RunTasks& run,
       TaskLimit limit)
      : experiment_(experiment),
        workers_(experiment, workers, run, limit),
        batch_size_(WorkerPool::tasks_of_worker(experiment)),
        active_(sockets.size()) {
    for (const int socket : sockets) {
      searches_.push_back({socket, {}, 0});
    }
  }

  void run() {
    while (active_ > 0) {
      receive_tasks(time_for_tasks());
      give_tasks();
      if (workers_.idle() < workers_.count()) {
        receive_results(workers_.idle() > 0 ? milliseconds(0) : result_time);
      }
      for (const std::string& message : workers_.messages()) {
        std::cerr << "warning: " + message + "\n";
      }
    }
  }

 private:
  struct Search {
    int socket;  ///< -1: ended
    std::vector<std::optional<TrialResult>> results;
    std::size_t missing;  ///< number of results that are missing
  };
  struct Place {
    std::size_t search;
    std::size_t number;  ///< in its results
  };
  struct Waiting {
    Place place;
    Task task;
  };

  [[nodiscard]] milliseconds time_for_tasks() const {
    if (workers_.idle() == 0) {
      return milliseconds(0);
    }
    if (queue_.empty()) {
      return workers_.idle() == workers_.count() ? result_time : collecting_time;
    }
    return std::max(std::chrono::ceil<milliseconds>(collecting_until_ - Clock::now()), milliseconds(0));
  }

  void receive_tasks(milliseconds timeout) {
    std::vector<pollfd> sockets;
    sockets.reserve(searches_.size());
    for (const Search& search : searches_) {
      sockets.push_back({search.socket, POLLIN, 0});  // poll() leaves out -1
    }
    if (poll(sockets.data(), sockets.size(), static_cast<int>(timeout.count())) <= 0) {
      return;
    }
    for (std::size_t i = 0; i < searches_.size(); ++i) {
      if (sockets[i].revents != 0) {
        receive_tasks_of(i);
      }
    }
  }

  void receive_tasks_of(std::size_t number) {
    Search& search = searches_[number];
    const Bytes message = receive_message(search.socket);
    const std::optional<std::vector<Task>> tasks = tasks_from(message);
    if (!tasks) {  // the farewell, or nothing of a search that was killed
      end(search);
      return;
    }
    if (queue_.empty()) {
      collecting_until_ = Clock::now() + collecting_time;
    }
    search.results.assign(tasks->size(), std::nullopt);
    search.missing = tasks->size();
    for (std::size_t i = 0; i < tasks->size(); ++i) {
      queue_.push_back({{number, i}, (*tasks)[i]});
    }
  }

  void end(Search& search) {
    close(std::exchange(search.socket, -1));
    --active_;
  }

  void give_tasks() {
    while (!queue_.empty() && workers_.idle() > 0 &&
           (queue_.size() >= batch_size_ || Clock::now() >= collecting_until_)) {
      const std::vector<TicketedTask> batch = take_batch();
      workers_.start(batch);
    }
  }

  /// Takes the share of an idle worker from the front of the queue. The judging engine has no batches.
  [[nodiscard]] std::vector<TicketedTask> take_batch() {
    const auto is_alone = [&](const Task& task) { return is_judged(experiment_) && is_fresh_run(experiment_, task); };
    const std::size_t idle = workers_.idle();
    const std::size_t most =
        is_alone(queue_.front().task) ? 1 : std::min(batch_size_, (queue_.size() + idle - 1) / idle);
    std::vector<TicketedTask> batch;
    while (batch.size() < most && !queue_.empty() && (batch.empty() || !is_alone(queue_.front().task))) {
      places_.emplace(++last_ticket_, queue_.front().place);
      batch.push_back({last_ticket_, std::move(queue_.front().task)});
      queue_.pop_front();
    }
    return batch;
  }

  void receive_results(milliseconds timeout) {
    std::optional<Workers::Done> done = workers_.wait(timeout);
    for (; done; done = workers_.wait(milliseconds(0))) {
      const auto place = places_.extract(done->ticket).mapped();
      Search& search = searches_[place.search];
      search.results[place.number] = std::move(done->result);
      if (--search.missing == 0 && search.socket >= 0) {
        std::vector<TrialResult> results;
        for (std::optional<TrialResult>& each : search.results) {
          results.push_back(std::move(*each));
        }
        if (!send_message(search.socket,
                          reply_with(share_of_search(experiment_, workers_.count(), active_), results))) {
          end(search);  // it was killed
        }
      }
      collecting_until_ = Clock::now() + collecting_time;
    }
  }

  const Experiment& experiment_;
  LocalWorkers workers_;
  std::size_t batch_size_;
  std::vector<Search> searches_;
  std::size_t active_;  ///< searches that have not ended
  std::deque<Waiting> queue_;
  std::unordered_map<std::uint64_t, Place> places_;  ///< by ticket
  std::uint64_t last_ticket_ = 0;
  Clock::time_point collecting_until_;
};

/// The pool as a search sees it.
class PooledWorkers final : public Workers {
 public:
  PooledWorkers(int socket, std::size_t share) : socket_(socket), share_(share) {}
  ~PooledWorkers() override {
    static_cast<void>(send_message(socket_, farewell));  // a pool that has ended needs none
    close(socket_);
  }
  PooledWorkers(const PooledWorkers&) = delete;
  PooledWorkers& operator=(const PooledWorkers&) = delete;

  [[nodiscard]] std::uint32_t count() const override { return 1; }
  [[nodiscard]] std::uint32_t idle() const override { return tickets_.empty() ? 1 : 0; }
  [[nodiscard]] std::size_t most_at_once() const override { return share_; }

  void start(std::span<const TicketedTask> batch) override {
    std::vector<Task> tasks;
    for (const TicketedTask& each : batch) {
      tickets_.push_back(each.ticket);
      tasks.push_back(each.task);
    }
    if (!send_message(socket_, to_bytes(tasks))) {
      throw std::runtime_error(pool_has_ended);
    }
  }

  std::optional<Done> wait(milliseconds timeout) override {
    pollfd ready{socket_, POLLIN, 0};
    if (finished_.empty() && poll(&ready, 1, static_cast<int>(timeout.count())) > 0) {
      receive();
    }
    if (finished_.empty()) {
      return std::nullopt;
    }
    Done done = std::move(finished_.front());
    finished_.pop_front();
    return done;
  }

  [[nodiscard]] std::vector<std::string> messages() override { return {}; }

 private:
  void receive() {
    const Bytes reply = receive_message(socket_);
    std::optional<std::vector<TrialResult>> results;
    if (!reply.empty()) {
      results = results_from(std::span(reply).subspan(1));
    }
    if (!results || results->size() != tickets_.size()) {
      throw std::runtime_error(pool_has_ended);
    }
    share_ = std::to_integer<std::size_t>(reply.front());
    for (std::size_t i = 0; i < results->size(); ++i) {
      finished_.push_back({tickets_[i], std::move((*results)[i]), 0});
    }
    tickets_.clear();
  }

  int socket_;
  std::size_t share_;
  std::vector<std::uint64_t> tickets_;  ///< of the tasks that the pool has
  std::deque<Done> finished_;           ///< results that wait() has not given yet
};

[[noreturn]] void serve(const Experiment& experiment, std::uint32_t workers, std::span<const int> sockets,
                        const RunTasks& run, TaskLimit limit) {
  int status = 0;
  try {
    Pool(experiment, workers, sockets, run, limit).run();
  } catch (const std::exception& error) {
    std::cerr << std::string(error.what()) + "\n" << std::flush;
    status = 1;
  }
  _exit(status);  // not exit(): the child must not flush or close what the parent has open
}

}  // namespace

WorkerPool::WorkerPool(const Experiment& experiment, std::uint32_t workers, std::uint32_t searches, const RunTasks& run,
                       TaskLimit limit)
    : first_share_(share_of_search(experiment, workers, searches)) {
  std::vector<int> its_ends;
  for (std::uint32_t i = 0; i < searches; ++i) {
    const auto [own_end, its_end] = make_message_sockets();
    sockets_.push_back(own_end);
    its_ends.push_back(its_end);
  }
  const pid_t parent = getpid();
  process_ = fork();
  if (process_ == 0) {
    leave_parent(its_ends, parent);
    serve(experiment, workers, its_ends, run, limit);
  }
  const int error = errno;
  std::ranges::for_each(its_ends, close);
  if (process_ < 0) {
    std::ranges::for_each(sockets_, close);
    throw std::system_error(error, std::generic_category(), "starting a process");
  }
}

WorkerPool::~WorkerPool() {
  kill(process_, SIGKILL);
  while (waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {
  }
  leave_to_searches();
}

void WorkerPool::leave_to_searches() { std::ranges::for_each(std::exchange(sockets_, {}), close); }

std::size_t WorkerPool::tasks_of_worker(const Experiment& experiment) {
  constexpr std::size_t widest_vector = 8;
  return std::min(sim::batch_size(experiment.scenario), widest_vector);
}

std::size_t WorkerPool::useful_searches(const Experiment& experiment, std::uint32_t workers) {
  constexpr std::size_t most_processes = 200;  // each takes three of the parent's files, of which it may have 1024
  return std::min(2 * workers * tasks_of_worker(experiment), most_processes);
}

std::unique_ptr<Workers> WorkerPool::workers_of(std::uint32_t search) const {
  for (std::uint32_t i = 0; i < sockets_.size(); ++i) {
    if (i != search) {
      close(sockets_[i]);
    }
  }
  return std::make_unique<PooledWorkers>(sockets_[search], first_share_);
}

}  // namespace proleg::optimize
