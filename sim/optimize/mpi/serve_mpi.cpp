#include <csignal>
#include <exception>
#include <stdexcept>
#include <thread>
#include <utility>

#include "sim/optimize/mpi/mpi_channel.hpp"
#include "sim/optimize/mpi/mpi_workers.hpp"

namespace proleg::optimize {
namespace {

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

bool serve_mpi(const Experiment& experiment, const std::string& build_id, RunTasks run, TaskLimit limit) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    std::signal(signal, SIG_IGN);
  }
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
