#include "tools/python/module/asked_search.hpp"

#include <unistd.h>

#include <utility>
#include <variant>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/threads/quiet_thread.hpp"
#include "tools/proleg/common/result_folder.hpp"
#include "tools/proleg/search/optimisation.hpp"
#include "tools/proleg/search/search_result.hpp"

namespace proleg::python {
namespace {

/// The process in which a search uses GAlib; a child that fork() makes has none.
std::atomic<pid_t> galib_user = 0;

/// Candidates that the method rates before it looks at a score.
std::uint32_t generation_of(const optimize::MethodSettings& method) {
  if (const auto* const deluge = std::get_if<optimize::GreatDelugeSettings>(&method)) {
    return deluge->chains;
  }
  if (const auto* const genetic = std::get_if<optimize::GeneticSettings>(&method)) {
    return genetic->population;
  }
  if (const auto* const map = std::get_if<optimize::MapElitesSettings>(&method)) {
    return map->population;
  }
  return std::get<optimize::PagmoSettings>(method).population;
}

std::unique_ptr<optimize::Store> open(const std::filesystem::path& folder, const optimize::Experiment& experiment) {
  using Opening = optimize::Store::Opening;
  tools::refuse_overwriting(experiment, folder);
  const bool exists = std::filesystem::exists(tools::store_path(folder));
  if (!exists) {
    tools::check_result_folder(folder, tools::search_result_files);
  }
  return tools::open_store(folder, experiment, exists ? Opening::resume : Opening::fresh);
}

}  // namespace

AskedSearch::GalibTurn::GalibTurn(const optimize::MethodSettings& method)
    : has_it_(std::holds_alternative<optimize::GeneticSettings>(method)) {
  if (has_it_ && galib_user.exchange(getpid()) == getpid()) {
    throw InputError("method", 0, "a second search with the genetic algorithm in this process",
                     "one at a time, because GAlib has one random generator: close the other one");
  }
}

void AskedSearch::GalibTurn::end() {
  if (std::exchange(has_it_, false)) {
    galib_user = 0;
  }
}

AskedSearch::AskedSearch(optimize::Experiment experiment, const std::filesystem::path& folder,
                         const std::optional<std::uint32_t>& trials, const std::optional<std::uint32_t>& at_once)
    : experiment_(std::move(experiment)),
      galib_(experiment_.method),
      workers_(at_once.value_or(generation_of(experiment_.method) * experiment_.trials.count)),
      store_(open(folder, experiment_)) {
  remark_ = tools::keep_stored_evaluations(*store_, experiment_, trials);
  thread_ = start_quiet_thread([this] { run(); });
}

AskedSearch::~AskedSearch() { close(); }

void AskedSearch::run() {
  const auto observe = [this](const optimize::Evaluation& evaluation, const optimize::SearchProgress& progress) {
    const std::lock_guard lock(mutex_);
    evaluations_.push_back(evaluation);
    progress_ = progress;
  };
  const auto stop = [this] { return closes_ || store_->is_stop_requested(); };
  try {
    const tools::SearchOutcome outcome =
        tools::run_search(experiment_, 0, workers_, *store_, tools::SearchWatch{observe, stop});
    const std::lock_guard lock(mutex_);
    if (!outcome.ending.empty()) {
      ending_ = outcome.ending;
    }
  } catch (...) {
    const std::lock_guard lock(mutex_);
    thrown_ = std::current_exception();
  }
  store_.reset();  // so that `proleg optimise` can go on
  galib_.end();
  workers_.end();
}

bool AskedSearch::wait_until_asked(std::chrono::milliseconds timeout) {
  if (!workers_.wait_until_asked(timeout)) {
    return false;
  }
  const std::lock_guard lock(mutex_);
  if (thrown_) {
    std::rethrow_exception(thrown_);
  }
  return true;
}

std::vector<optimize::Task> AskedSearch::tasks(std::size_t most) const {
  return has_ended() ? std::vector<optimize::Task>() : workers_.tasks(most);
}

void AskedSearch::close() {
  closes_ = true;
  workers_.close();
  if (thread_.joinable()) {
    thread_.join();
  }
}

std::vector<optimize::Evaluation> AskedSearch::evaluations() const {
  const std::lock_guard lock(mutex_);
  return evaluations_;
}

optimize::SearchProgress AskedSearch::progress() const {
  const std::lock_guard lock(mutex_);
  return progress_;
}

std::optional<std::string> AskedSearch::ending() const {
  const std::lock_guard lock(mutex_);
  return ending_;
}

}  // namespace proleg::python
