#include "sim/optimize/mpi/mpi_workers.hpp"

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <deque>
#include <exception>
#include <stdexcept>
#include <thread>
#include <utility>

#include "shared/computer/algorithm_library/kept_signals.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/optimize/mpi/mpi_channel.hpp"

namespace proleg::optimize {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

/// A rank has its own limit for each try of its tasks (LocalWorkers) and reports when it gives up. A rank that is
/// silent for this number of limits is lost.
constexpr int limits_until_lost = 4;
/// Time in which all ranks must answer stop.
constexpr std::chrono::seconds goodbye_timeout{5};

std::optional<int> number_in_environment(const char* name) {
  const char* text = std::getenv(name);
  return text != nullptr ? parse_whole<int>(text) : std::nullopt;
}

void serve(const MpiChannel& channel, LocalWorkers& worker) {
  std::vector<TrialResult> results;  // results of the tasks that the worker has, in their order
  std::size_t missing = 0;
  while (true) {
    if (const std::optional<MpiMessage> message = channel.receive()) {
      if (message->tag == MpiTag::stop) {
        return;
      }
      const std::optional<std::vector<Task>> tasks = tasks_from(message->content);
      if (message->tag != MpiTag::tasks || !tasks || tasks->empty() || missing > 0) {
        throw std::runtime_error("received a message that is not its next tasks");
      }
      std::vector<TicketedTask> batch;
      for (const Task& task : *tasks) {
        batch.push_back({batch.size(), task});
      }
      worker.start(batch);
      missing = batch.size();
      results.resize(missing);
    }
    std::optional<Workers::Done> done = worker.wait(poll_interval);
    for (const std::string& text : worker.messages()) {
      channel.send(0, MpiTag::message, text);
    }
    if (done) {
      results[done->ticket] = std::move(done->result);
      if (--missing == 0) {
        channel.send(0, MpiTag::results, to_bytes(results));
      }
    }
  }
}

void wait_for_stop(const MpiChannel& channel) {
  while (true) {
    const std::optional<MpiMessage> message = channel.receive();
    if (message && message->tag == MpiTag::stop) {
      return;
    }
    std::this_thread::sleep_for(poll_interval);
  }
}

}  // namespace

std::optional<MpiRank> mpi_rank() {
  const std::optional<int> rank = number_in_environment("OMPI_COMM_WORLD_RANK");
  const std::optional<int> size = number_in_environment("OMPI_COMM_WORLD_SIZE");
  return rank && size ? std::optional<MpiRank>({*rank, *size}) : std::nullopt;
}

class MpiWorkers::Implementation {
 public:
  Implementation(const Experiment& experiment, const std::string& build_id, RunTasks run, TaskLimit limit)
      : local_(experiment, 1, std::move(run), limit),
        ranks_(static_cast<std::size_t>(channel_.size())),
        max_silence_(limits_until_lost *
                     (limit.fixed + std::chrono::duration_cast<milliseconds>(std::chrono::duration<double>(
                                        limit.per_simulated_second * experiment.scenario.duration_s)))) {
    ranks_[0].lost = true;  // this process, whose worker is local_
    const std::vector<std::string> identities = channel_.exchange(mpi_identity(experiment, build_id));
    for (std::size_t rank = 1; rank < identities.size(); ++rank) {
      if (identities[rank] != identities[0]) {
        // The other ranks have seen the difference, too, and have ended.
        throw std::runtime_error("rank " + std::to_string(rank) + " has " + identities[rank] + ", rank 0 has " +
                                 identities[0] +
                                 "; all computers need the same files and the same build of the program");
      }
    }
  }

  ~Implementation() { end_ranks(); }

  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  [[nodiscard]] std::uint32_t count() const {
    return local_.count() + static_cast<std::uint32_t>(std::ranges::count(ranks_, false, &Rank::lost));
  }

  [[nodiscard]] std::uint32_t idle() const {
    const std::size_t without_task =
        local_.idle() + static_cast<std::size_t>(std::ranges::count_if(ranks_, &Rank::is_idle));
    return static_cast<std::uint32_t>(without_task - std::min(without_task, orphaned_.size()));
  }

  void start(std::span<const TicketedTask> batch) {
    // The other ranks receive tasks first: a message over MPI takes longer than one over a socket.
    const auto rank = std::ranges::find_if(ranks_, &Rank::is_idle);
    if (rank == ranks_.end()) {
      local_.start(batch);
      return;
    }
    rank->batch.assign(batch.begin(), batch.end());
    rank->silence = milliseconds(0);
    std::vector<Task> tasks;
    for (const TicketedTask& each : batch) {
      tasks.push_back(each.task);
    }
    channel_.send(static_cast<int>(rank - ranks_.begin()), MpiTag::tasks, to_bytes(tasks));
  }

  std::optional<Done> wait(milliseconds timeout) {
    const Clock::time_point begin = Clock::now();
    std::optional<Done> done = next_result(timeout);
    count_silence(Clock::now() - begin);
    restart_orphaned();
    return done;
  }

  std::vector<std::string> messages() {
    std::vector<std::string> all = local_.messages();
    all.insert(all.end(), messages_.begin(), messages_.end());
    messages_.clear();
    return all;
  }

 private:
  /// Waits for the next result; nothing after the timeout.
  std::optional<Done> next_result(milliseconds timeout) {
    const Clock::time_point end = Clock::now() + timeout;
    while (true) {
      while (std::optional<MpiMessage> message = channel_.receive()) {
        handle(*message);
      }
      if (!finished_.empty()) {
        Done done = std::move(finished_.front());
        finished_.pop_front();
        return done;
      }
      if (std::optional<Done> done = local_.wait(std::min(timeout, poll_interval))) {
        done->worker = 0;
        return done;
      }
      if (Clock::now() >= end) {
        return std::nullopt;
      }
    }
  }

  using Batch = std::vector<TicketedTask>;
  struct Rank {
    Batch batch;                ///< the tasks that the rank has; may be empty
    Clock::duration silence{};  ///< time without a message while it has tasks, within wait()
    bool lost = false;          ///< it receives no more tasks
    [[nodiscard]] bool is_idle() const { return !lost && batch.empty(); }
  };

  /// Counts the silence of ranks, only within wait().
  void count_silence(Clock::duration waited) {
    for (std::size_t rank = 0; rank < ranks_.size(); ++rank) {
      Rank& its = ranks_[rank];
      if (its.lost || its.batch.empty() ||
          (its.silence += waited) < max_silence_ * static_cast<int>(its.batch.size())) {
        continue;
      }
      its.lost = true;
      messages_.push_back("rank " + std::to_string(rank) + " has not answered within the time limit, in evaluation " +
                          std::to_string(its.batch.front().task.number) + "; the search continues without it");
      orphaned_.push_back(std::exchange(its.batch, {}));
    }
  }

  /// Gives the tasks of lost ranks to the others.
  void restart_orphaned() {
    while (!orphaned_.empty() && (local_.idle() > 0 || std::ranges::any_of(ranks_, &Rank::is_idle))) {
      const Batch batch = std::move(orphaned_.back());
      orphaned_.pop_back();
      start(batch);
    }
  }

  void handle(const MpiMessage& message) {
    Rank& rank = ranks_[static_cast<std::size_t>(message.rank)];
    if (rank.lost) {
      return;  // the message comes too late
    }
    const std::string place = "rank " + std::to_string(message.rank) + ": ";
    if (message.tag == MpiTag::message) {
      messages_.push_back(place + message.text());
      return;
    }
    if (message.tag == MpiTag::failure) {
      throw std::runtime_error(place + message.text());
    }
    std::optional<std::vector<TrialResult>> results = results_from(message.content);
    if (message.tag != MpiTag::results || !results || results->empty() || results->size() != rank.batch.size()) {
      throw std::runtime_error(place + "sent a message that is not the results of its tasks");
    }
    for (std::size_t i = 0; i < results->size(); ++i) {
      finished_.push_back({rank.batch[i].ticket, std::move((*results)[i]), static_cast<std::uint32_t>(message.rank)});
    }
    rank.batch.clear();
  }

  void end_ranks() const {
    const int count = channel_.size() - 1;
    for (int rank = 1; rank <= count; ++rank) {
      channel_.send(rank, MpiTag::stop);
    }
    const Clock::time_point end = Clock::now() + goodbye_timeout;
    for (int stopped = 0; stopped < count;) {
      if (const std::optional<MpiMessage> message = channel_.receive()) {
        stopped += message->tag == MpiTag::stopped ? 1 : 0;
      } else if (Clock::now() > end) {
        channel_.abort();
      } else {
        std::this_thread::sleep_for(poll_interval);
      }
    }
  }

  LocalWorkers local_;  // the constructor forks before MPI is initialised
  MpiChannel channel_;
  std::vector<Rank> ranks_;
  std::vector<Batch> orphaned_;  ///< tasks of lost ranks
  std::deque<Done> finished_;    ///< results of other ranks that wait() has not given yet
  Clock::duration max_silence_;
  std::vector<std::string> messages_;
};

MpiWorkers::MpiWorkers(const Experiment& experiment, const std::string& build_id, RunTasks run, TaskLimit limit)
    : implementation_(std::make_unique<Implementation>(experiment, build_id, std::move(run), limit)) {}
MpiWorkers::~MpiWorkers() = default;
std::uint32_t MpiWorkers::count() const { return implementation_->count(); }
std::uint32_t MpiWorkers::idle() const { return implementation_->idle(); }
void MpiWorkers::start(std::span<const TicketedTask> batch) { implementation_->start(batch); }
std::optional<Workers::Done> MpiWorkers::wait(milliseconds timeout) { return implementation_->wait(timeout); }
std::vector<std::string> MpiWorkers::messages() { return implementation_->messages(); }

bool serve_mpi(const Experiment& experiment, const std::string& build_id, RunTasks run, TaskLimit limit) {
  set_ending_signals([] {
    for (const int signal : ending_signals) {
      std::signal(signal, SIG_IGN);
    }
  });
  auto worker = std::make_unique<LocalWorkers>(experiment, 1, std::move(run), limit);
  const MpiChannel channel;
  const std::vector<std::string> identities = channel.exchange(mpi_identity(experiment, build_id));
  for (const std::string& identity : identities) {
    if (identity != identities.front()) {
      return false;  // rank 0 reports the difference
    }
  }
  try {
    serve(channel, *worker);
  } catch (const std::exception& error) {
    channel.send(0, MpiTag::failure, std::string(error.what()));
    wait_for_stop(channel);
  }
  worker.reset();
  channel.send(0, MpiTag::stopped);
  return true;
}

}  // namespace proleg::optimize
