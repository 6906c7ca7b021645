#include "sim/optimize/mpi/mpi_workers.hpp"

#include <algorithm>
#include <cstdlib>
#include <stdexcept>
#include <thread>
#include <utility>

#include "sim/optimize/mpi/mpi_channel.hpp"
#include "sim/scenario/text.hpp"

namespace proleg::optimize {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

/// MPI cannot be waited for together with anything else without burning a core, so it is asked this often.
constexpr milliseconds look_interval{1};
/// How long ranks have for their goodbye.
constexpr std::chrono::seconds longest_goodbye{5};

std::optional<int> number_in_environment(const char* name) {
  const char* text = std::getenv(name);
  return text != nullptr ? sim::parse_whole<int>(text) : std::nullopt;
}

}  // namespace

std::optional<MpiPlace> mpi_place() {
  const std::optional<int> rank = number_in_environment("OMPI_COMM_WORLD_RANK");
  const std::optional<int> size = number_in_environment("OMPI_COMM_WORLD_SIZE");
  return rank && size ? std::optional<MpiPlace>({*rank, *size}) : std::nullopt;
}

class MpiWorkers::Implementation {
 public:
  Implementation(const Experiment& experiment, const std::string& build_id, RunTask run, TaskLimit limit)
      : local_(experiment, 1, std::move(run), limit), ranks_(static_cast<std::size_t>(channel_.size())) {
    const std::vector<std::string> identities = channel_.exchange(mpi_identity(experiment, build_id));
    for (std::size_t rank = 1; rank < identities.size(); ++rank) {
      if (identities[rank] != identities[0]) {
        over_ = true;  // the others know it, too
        throw std::runtime_error("rank " + std::to_string(rank) + " has " + identities[rank] + ", rank 0 has " +
                                 identities[0] + "; all computers need the same files and the same program");
      }
    }
  }

  ~Implementation() {
    if (!over_) {
      end_ranks();
    }
  }

  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  [[nodiscard]] std::uint32_t count() const { return local_.count() + static_cast<std::uint32_t>(ranks_.size()) - 1; }

  [[nodiscard]] std::uint32_t idle() const {
    return local_.idle() + static_cast<std::uint32_t>(std::count(ranks_.begin() + 1, ranks_.end(), std::nullopt));
  }

  void start(std::uint64_t ticket, const Task& task) {
    // The other ranks first: a message takes longer than a socket.
    const auto rank = std::find(ranks_.begin() + 1, ranks_.end(), std::nullopt);
    if (rank == ranks_.end()) {
      local_.start(ticket, task);
      return;
    }
    *rank = ticket;
    channel_.send(static_cast<int>(rank - ranks_.begin()), MpiTag::task, to_bytes(task));
  }

  std::optional<Done> wait(milliseconds timeout) {
    const Clock::time_point end = Clock::now() + timeout;
    while (true) {
      while (std::optional<MpiMessage> message = channel_.receive()) {
        if (std::optional<Done> done = hear(*message)) {
          return done;
        }
      }
      if (std::optional<Done> done = local_.wait(std::min(timeout, look_interval))) {
        done->worker = 0;
        return done;
      }
      if (Clock::now() >= end) {
        return std::nullopt;
      }
    }
  }

  std::vector<std::string> messages() {
    std::vector<std::string> all = local_.messages();
    all.insert(all.end(), messages_.begin(), messages_.end());
    messages_.clear();
    return all;
  }

 private:
  std::optional<Done> hear(const MpiMessage& message) {
    const std::string place = "rank " + std::to_string(message.rank) + ": ";
    if (message.tag == MpiTag::message) {
      messages_.push_back(place + message.text());
      return std::nullopt;
    }
    if (message.tag == MpiTag::failure) {
      throw std::runtime_error(place + message.text());
    }
    std::optional<std::uint64_t>& ticket = ranks_[static_cast<std::size_t>(message.rank)];
    std::optional<TrialResult> result = result_from(message.content);
    if (message.tag != MpiTag::result || !result || !ticket) {
      throw std::runtime_error(place + "sent what is not the result of a task");
    }
    return Done{*std::exchange(ticket, std::nullopt), std::move(*result), static_cast<std::uint32_t>(message.rank)};
  }

  void end_ranks() const {
    const int count = channel_.size() - 1;
    for (int rank = 1; rank <= count; ++rank) {
      channel_.send(rank, MpiTag::stop);
    }
    const Clock::time_point end = Clock::now() + longest_goodbye;
    for (int gone = 0; gone < count;) {
      if (const std::optional<MpiMessage> message = channel_.receive()) {
        gone += message->tag == MpiTag::goodbye ? 1 : 0;
      } else if (Clock::now() > end) {
        channel_.abort();
      } else {
        std::this_thread::sleep_for(look_interval);
      }
    }
  }

  LocalWorkers local_;  // forks before MPI is initialised
  MpiChannel channel_;
  std::vector<std::optional<std::uint64_t>> ranks_;  ///< the ticket that each is at; [0] is not used
  std::vector<std::string> messages_;
  bool over_ = false;
};

MpiWorkers::MpiWorkers(const Experiment& experiment, const std::string& build_id, RunTask run, TaskLimit limit)
    : implementation_(std::make_unique<Implementation>(experiment, build_id, std::move(run), limit)) {}
MpiWorkers::~MpiWorkers() = default;
std::uint32_t MpiWorkers::count() const { return implementation_->count(); }
std::uint32_t MpiWorkers::idle() const { return implementation_->idle(); }
void MpiWorkers::start(std::uint64_t ticket, const Task& task) { implementation_->start(ticket, task); }
std::optional<Workers::Done> MpiWorkers::wait(milliseconds timeout) { return implementation_->wait(timeout); }
std::vector<std::string> MpiWorkers::messages() { return implementation_->messages(); }

}  // namespace proleg::optimize
