#pragma once

// Threads that share the independent parts of a short piece of work, again and again.

#include <atomic>
#include <cstdint>
#include <functional>
#include <span>
#include <thread>
#include <vector>

namespace proleg {

/// Each part has a thread that takes it first, so that its data stay in the cache of a core. A thread that has none
/// left takes those of others: on a busy computer a thread that does not run delays no other. The thread that calls
/// run() takes part, so a computer with two cores needs one more thread. Between two pieces of work the threads look
/// for the next one for some microseconds, then they sleep.
class WorkerThreads {
 public:
  /// threads: with the thread that calls run(), at least 1. parts: largest number of a part, plus 1. Throws
  /// std::system_error if the threads cannot be started.
  WorkerThreads(unsigned threads, unsigned parts);
  ~WorkerThreads();
  WorkerThreads(const WorkerThreads&) = delete;
  WorkerThreads& operator=(const WorkerThreads&) = delete;

  /// Calls work(part) once for each of the parts, which are all different, and returns when all calls have returned.
  /// work must not throw. What was written before run() is visible to it, and what it has written is visible after
  /// run().
  void run(std::span<const unsigned> parts, const std::function<void(unsigned part)>& work);

 private:
  void serve(unsigned thread);
  /// Does those parts of the piece of work that are still free.
  void take_parts(unsigned thread, std::uint32_t piece);
  void take(unsigned part, std::uint32_t piece);

  std::atomic<std::uint32_t> piece_{0};  ///< number of the present piece of work
  std::atomic<std::uint32_t> left_{0};   ///< parts that are not done
  std::atomic<bool> ends_{false};
  const std::function<void(unsigned part)>* work_ = nullptr;
  /// By part: 2 n while the part is free in piece n, 2 n + 1 when it is taken.
  std::vector<std::atomic<std::uint32_t>> states_;
  std::vector<std::thread> threads_;
};

}  // namespace proleg
