#pragma once

#include <ode/ode.h>

#include <cstddef>
#include <mutex>
#include <span>
#include <string>
#include <vector>

namespace proleg::sim {

/// Prepares the Open Dynamics Engine for the calling thread. An error of the engine throws PhysicsError and does not
/// end the process; its messages are counted, not printed.
void prepare_engine_for_this_thread();

/// Number of messages of the engine on this thread so far.
[[nodiscard]] std::size_t engine_messages();
/// The first messages that differ, at most ten.
[[nodiscard]] std::span<const std::string> engine_message_texts();

/// The random numbers with which dWorldQuickStep orders its rows. The engine has one generator for a process, so each
/// world keeps the state of its own, and lends it to the engine for a step. Worlds that are stepped by several threads
/// repeat like worlds that are alone.
class SolverRandomNumbers {
 public:
  /// dWorldQuickStep with this state. Waits while another thread is in it.
  void quick_step(dWorldID world, double step_s);

  /// The lock of all worlds of this process. A process that loads this code several times (extension modules of Python)
  /// must give the same lock to each copy, before its first step. A child that fork() makes can use it at once.
  [[nodiscard]] static std::mutex& lock();
  static void use_lock(std::mutex& lock);

 private:
  unsigned long state_ = 0;
};

/// The memory that the engine takes for the steps of a world. If an error of the engine ends a step in its middle, the
/// engine does not free this memory; the destructor frees it.
class StepMemory {
 public:
  StepMemory() = default;
  /// The world must be destroyed before its memory.
  ~StepMemory();
  StepMemory(const StepMemory&) = delete;
  StepMemory& operator=(const StepMemory&) = delete;

  /// Lets the world take its memory from the selected object. Must be called before the world's first step.
  static void use_for(dWorldID world);
  /// Must be called before each step: this thread's worlds take their memory from this object.
  void select();

 private:
  /// The header in front of each block that the engine gets.
  struct alignas(std::max_align_t) Header {
    StepMemory* owner;
  };

  static void* allocate(std::size_t size);
  static void* shrink(void* block, std::size_t size, std::size_t smaller);
  static void release(void* block, std::size_t size);

  std::vector<Header*> blocks_;  ///< blocks in use, which are few
};

}  // namespace proleg::sim
