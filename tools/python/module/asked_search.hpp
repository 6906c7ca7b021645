#pragma once

// A search of `proleg optimise` whose candidates somebody else simulates.

#include <atomic>
#include <chrono>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "sim/optimize/evaluation/evaluator.hpp"
#include "sim/optimize/evaluation/store.hpp"
#include "sim/optimize/experiment/experiment.hpp"
#include "tools/python/module/asked_workers.hpp"

namespace proleg::python {

/// A method drives its own loop and calls what rates a candidate. It therefore runs in a thread of its own, which waits
/// for the caller of this class. Candidates, scores and store are those of `proleg optimise`.
///
/// The thread ends with the method, with a stop that `proleg optimise --stop` requests, and with this object; then the
/// store is closed.
class AskedSearch {
 public:
  /// Continues the search whose store is in the folder, or begins one. at_once: candidates that may be asked for at the
  /// same time; nothing: those of a generation. Throws InputError, BadInput.
  AskedSearch(optimize::Experiment experiment, const std::filesystem::path& folder,
              const std::optional<std::uint32_t>& trials, const std::optional<std::uint32_t>& at_once);
  ~AskedSearch();
  AskedSearch(const AskedSearch&) = delete;
  AskedSearch& operator=(const AskedSearch&) = delete;

  [[nodiscard]] const optimize::Experiment& experiment() const { return experiment_; }
  /// For the user, about what was asked for; empty: none.
  [[nodiscard]] const std::string& remark() const { return remark_; }

  /// Whether the method asks for something or has ended, within the time. Throws what ended it, such as a StoreError.
  [[nodiscard]] bool wait_until_asked(std::chrono::milliseconds timeout);
  [[nodiscard]] bool has_ended() const { return workers_.has_ended(); }
  /// What the method asks for, at most so many; none if it has ended.
  [[nodiscard]] std::vector<optimize::Task> tasks(std::size_t most) const;
  /// The results of the first tasks(), at most all. They are in the store when wait_until_asked() has returned true.
  void answer(std::vector<optimize::TrialResult> results) { workers_.answer(std::move(results)); }
  /// Ends the thread and closes the store; what was answered stays. May be called again.
  void close();

  /// All evaluations of the search, by number.
  [[nodiscard]] std::vector<optimize::Evaluation> evaluations() const;
  [[nodiscard]] optimize::SearchProgress progress() const;
  /// Why the search ended; nothing if it did not: it goes on, was stopped, or has failed.
  [[nodiscard]] std::optional<std::string> ending() const;

 private:
  /// The right to use GAlib, which has one random generator in a process: two searches would share it.
  class GalibTurn {
   public:
    /// Throws InputError if another search of this process has the right.
    explicit GalibTurn(const optimize::MethodSettings& method);
    ~GalibTurn() { end(); }
    GalibTurn(const GalibTurn&) = delete;
    GalibTurn& operator=(const GalibTurn&) = delete;
    void end();

   private:
    bool has_it_;
  };

  void run();

  optimize::Experiment experiment_;
  GalibTurn galib_;
  AskedWorkers workers_;
  std::unique_ptr<optimize::Store> store_;
  std::string remark_;
  std::atomic<bool> closes_ = false;
  mutable std::mutex mutex_;  ///< of what follows
  std::vector<optimize::Evaluation> evaluations_;
  optimize::SearchProgress progress_;
  std::optional<std::string> ending_;
  std::exception_ptr thrown_;
  std::thread thread_;
};

}  // namespace proleg::python
