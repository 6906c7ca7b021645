#include "shared/computer/threads/worker_threads.hpp"

namespace proleg {
namespace {

/// Turns in which a thread looks for a change before it sleeps. A thread that wakes up from sleep is late by some 50
/// us, which is more than most pieces of work take.
constexpr unsigned turns_before_sleep = 200;

/// Returns when the value is no longer `old`.
void wait_for_change(const std::atomic<std::uint32_t>& value, std::uint32_t old) {
  for (unsigned turn = 0; turn < turns_before_sleep; ++turn) {
    if (value.load(std::memory_order_acquire) != old) {
      return;
    }
    // On a busy computer another program gets the core.
    std::this_thread::yield();
  }
  value.wait(old, std::memory_order_acquire);
}

}  // namespace

WorkerThreads::WorkerThreads(unsigned threads, unsigned parts) : states_(parts) {
  threads_.reserve(threads);
  for (unsigned thread = 1; thread < threads; ++thread) {
    threads_.emplace_back([this, thread] { serve(thread); });
  }
}

WorkerThreads::~WorkerThreads() {
  ends_.store(true, std::memory_order_relaxed);
  piece_.fetch_add(1, std::memory_order_release);
  piece_.notify_all();
  for (std::thread& thread : threads_) {
    thread.join();
  }
}

void WorkerThreads::run(std::span<const unsigned> parts, const std::function<void(unsigned part)>& work) {
  if (threads_.empty()) {
    for (const unsigned part : parts) {
      work(part);
    }
    return;
  }
  const std::uint32_t piece = piece_.load(std::memory_order_relaxed) + 1;
  work_ = &work;
  left_.store(static_cast<std::uint32_t>(parts.size()), std::memory_order_relaxed);
  for (const unsigned part : parts) {
    states_[part].store(2 * piece, std::memory_order_release);
  }
  piece_.store(piece, std::memory_order_release);
  piece_.notify_all();
  take_parts(0, piece);
  for (std::uint32_t left = left_.load(std::memory_order_acquire); left != 0;
       left = left_.load(std::memory_order_acquire)) {
    wait_for_change(left_, left);
  }
}

void WorkerThreads::serve(unsigned thread) {
  for (std::uint32_t piece = 0;;) {
    wait_for_change(piece_, piece);
    piece = piece_.load(std::memory_order_acquire);
    if (ends_.load(std::memory_order_relaxed)) {
      return;
    }
    take_parts(thread, piece);
  }
}

void WorkerThreads::take_parts(unsigned thread, std::uint32_t piece) {
  const auto count = static_cast<unsigned>(states_.size());
  const auto step = static_cast<unsigned>(threads_.size()) + 1;
  for (unsigned part = thread; part < count; part += step) {
    take(part, piece);
  }
  // The owner takes its own from the other end.
  for (unsigned part = count; part-- > 0;) {
    take(part, piece);
  }
}

void WorkerThreads::take(unsigned part, std::uint32_t piece) {
  std::uint32_t free = 2 * piece;
  if (!states_[part].compare_exchange_strong(free, free + 1, std::memory_order_acquire, std::memory_order_relaxed)) {
    return;
  }
  (*work_)(part);
  if (left_.fetch_sub(1, std::memory_order_acq_rel) == 1) {
    left_.notify_one();
  }
}

}  // namespace proleg
