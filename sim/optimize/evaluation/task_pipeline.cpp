#include "sim/optimize/evaluation/task_pipeline.hpp"

#include <algorithm>
#include <bit>
#include <utility>

namespace proleg::optimize {
namespace {

/// Unique in the process: workers may still simulate a task of an earlier pipeline.
std::uint64_t new_ticket() {
  static std::uint64_t last = 0;
  return ++last;
}

}  // namespace

std::size_t TaskHash::operator()(const Task& task) const {
  std::uint64_t hash = task.number * 0x9E3779B97F4A7C15U + task.trial;
  const auto mix = [&hash](std::uint64_t value) {
    hash = (hash ^ value) * 0xD6E8FEB86659FD93U;
    hash ^= hash >> 32U;
  };
  mix(task.run);
  mix(std::bit_cast<std::uint64_t>(task.hopeless_below.value_or(-1.0)));
  for (const std::uint32_t index : task.candidate) {
    mix(index);
  }
  return hash;
}

TaskPipeline::TaskPipeline(const Experiment& experiment, Workers& workers, Store* store, ResultScope result_scope)
    : experiment_(experiment), workers_(workers), store_(store), result_scope_(result_scope) {}

Task TaskPipeline::key(const Task& task) const {
  Task key = task;
  if (result_scope_ == ResultScope::all_numbers) {
    key.number = 0;
  }
  return key;
}

void TaskPipeline::set_wanted(std::span<const Task> tasks) {
  const std::unordered_map<Task, Task, TaskHash> wanted_before = std::exchange(wanted_, {});
  queue_.clear();
  for (const Task& task : tasks) {
    const Task its_key = key(task);
    const bool known = results_.contains(its_key);
    if (!wanted_.emplace(its_key, task).second) {
      continue;
    }
    if (known) {
      counts_.wasted -= !wanted_before.contains(its_key) && !results_.at(its_key).restored ? 1U : 0U;
    } else if (!keys_at_workers_.contains(its_key)) {
      if (store_ != nullptr && !wanted_before.contains(its_key)) {
        if (std::optional<TrialResult> stored = store_->find(task)) {
          results_.emplace(its_key, KeptResult{std::move(*stored), 0, true, task.number});
          continue;
        }
      }
      queue_.push_back(task);
    }
  }
  drop_unwanted(wanted_before);
}

/// Drops the results of tasks that are not wanted any more. With ResultScope::all_numbers a result stays: its task may
/// be wanted again.
void TaskPipeline::drop_unwanted(const std::unordered_map<Task, Task, TaskHash>& wanted_before) {
  for (const auto& [its_key, task] : wanted_before) {
    const auto known = results_.find(its_key);
    if (wanted_.contains(its_key) || known == results_.end()) {
      continue;
    }
    counts_.wasted += known->second.restored ? 0U : 1U;
    known->second.saved_as.reset();  // a wanted result with its number may replace it in the store
    if (result_scope_ == ResultScope::one_number) {
      results_.erase(known);
    }
  }
}

void TaskPipeline::run(std::chrono::milliseconds timeout) {
  give_tasks();
  std::optional<Workers::Done> done = workers_.wait(timeout);
  while (done) {
    receive(std::move(*done));
    done = workers_.wait(std::chrono::milliseconds(0));
  }
}

void TaskPipeline::give_tasks() {
  if (queue_.empty()) {
    return;
  }
  // The judging engine has no batches.
  const std::size_t share = is_judged(experiment_) && is_fresh_run(experiment_, queue_.front())
                                ? 1
                                : share_of_worker(experiment_.scenario, queue_.size(), workers_);
  while (!queue_.empty() && workers_.idle() > 0) {
    std::vector<TicketedTask> batch;
    for (; batch.size() < share && !queue_.empty(); queue_.pop_front()) {
      batch.push_back({new_ticket(), std::move(queue_.front())});
    }
    workers_.start(batch);
    for (TicketedTask& each : batch) {
      keys_at_workers_.insert(key(each.task));
      at_workers_.emplace(each.ticket, std::move(each.task));
    }
  }
}

void TaskPipeline::receive(Workers::Done done) {
  const auto task = at_workers_.find(done.ticket);
  if (task == at_workers_.end()) {
    return;  // of an earlier pipeline
  }
  const Task its_key = key(task->second);
  at_workers_.erase(task);
  keys_at_workers_.erase(its_key);
  counts_.simulated_s += done.result.simulated_s;
  counts_.workers_s += done.result.wall_s;
  const auto wanted = wanted_.find(its_key);
  if (wanted == wanted_.end()) {
    counts_.wasted += 1;
    if (result_scope_ == ResultScope::one_number) {
      return;
    }
  }
  KeptResult& known = results_[its_key];
  known = {std::move(done.result), done.worker, false, {}};
  if (wanted != wanted_.end()) {
    save(wanted->second, known);
  }
}

void TaskPipeline::save(const Task& task, KeptResult& known) {
  if (store_ != nullptr && known.saved_as != task.number) {
    store_->save(task, seed_of(experiment_, task), known.result, known.worker);
    known.saved_as = task.number;
  }
}

TaskPipeline::ClaimedResult TaskPipeline::claim_result(const Task& task) {
  auto node = results_.extract(key(task));
  KeptResult& known = node.mapped();
  save(task, known);
  wanted_.erase(key(task));
  return {std::move(known.result), known.restored};
}

}  // namespace proleg::optimize
