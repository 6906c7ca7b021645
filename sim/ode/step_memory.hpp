#pragma once

#include <ode/ode.h>

#include <cstddef>
#include <vector>

namespace proleg::sim {

/// The memory that the engine takes for the steps of a world. If an error of the engine leaves a step in its middle,
/// the engine never gives this memory back; the destructor does.
class StepMemory {
 public:
  StepMemory() = default;
  /// The world must be destroyed before.
  ~StepMemory();
  StepMemory(const StepMemory&) = delete;
  StepMemory& operator=(const StepMemory&) = delete;

  /// From now on the world takes its memory from here. Must be called before its first step.
  static void use_for(dWorldID world);
  /// Must be called before each step: this thread's worlds take their memory from this object.
  void select();

 private:
  /// In front of each block that the engine gets.
  struct alignas(std::max_align_t) Header {
    StepMemory* owner;
  };

  static void* allocate(std::size_t size);
  static void* shrink(void* block, std::size_t size, std::size_t smaller);
  static void release(void* block, std::size_t size);

  std::vector<Header*> blocks_;  ///< few
};

}  // namespace proleg::sim
