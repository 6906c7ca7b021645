#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace proleg::stm32f405 {

/// A queue from one interrupt priority to a lower one, on one processor. Each index is written by one side only, and
/// the higher priority always runs between two instructions of the lower one. So the queue needs no lock; only the
/// compiler must keep the order of the writes.
template <typename T, std::size_t size>
class EventRing {
  static_assert((size & (size - 1)) == 0, "a power of two, so that the indices may wrap");

 public:
  // Functions for the side that fills the queue.

  /// Number of free entries; the other side may free more at any time.
  [[nodiscard]] std::size_t room() const {
    return size - (written_.load(std::memory_order_relaxed) - read_.load(std::memory_order_relaxed));
  }
  /// Place of the next entry; null if there is no room.
  [[nodiscard]] T* back() {
    if (room() == 0) {
      return nullptr;
    }
    return &entries_[written_.load(std::memory_order_relaxed) % size];
  }
  /// Adds the entry in back() to the queue.
  void push() {
    std::atomic_signal_fence(std::memory_order_release);
    written_.store(written_.load(std::memory_order_relaxed) + 1U, std::memory_order_relaxed);
  }

  // Functions for the side that empties the queue.

  /// The oldest entry; null if the queue is empty. It stays until pop().
  [[nodiscard]] const T* front() const {
    if (written_.load(std::memory_order_relaxed) == read_.load(std::memory_order_relaxed)) {
      return nullptr;
    }
    std::atomic_signal_fence(std::memory_order_acquire);
    return &entries_[read_.load(std::memory_order_relaxed) % size];
  }
  void pop() {
    std::atomic_signal_fence(std::memory_order_release);
    read_.store(read_.load(std::memory_order_relaxed) + 1U, std::memory_order_relaxed);
  }

 private:
  std::array<T, size> entries_{};
  std::atomic<std::uint32_t> written_{0};
  std::atomic<std::uint32_t> read_{0};
};

}  // namespace proleg::stm32f405
