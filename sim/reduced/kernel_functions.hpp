#pragma once

#include "sim/reduced/chain_step.hpp"
#include "sim/reduced/spatial_step.hpp"

namespace proleg::sim::reduced {
namespace {  // of each instruction set its own (chain_step.hpp)

template <int width>
struct Block {
  using Number = typename Lanes<width>::Number;

  Block(const ChainForm& form, double* numbers)
      : memory(reinterpret_cast<Number*>(numbers), form.counts),
        scratch(reinterpret_cast<Number*>(numbers) + ChainMemory<Number>::size(form.counts), form.counts),
        step(form, memory, scratch) {}

  ChainMemory<Number> memory;
  ChainScratch<Number> scratch;
  ChainStep<width> step;
};

template <int width>
unsigned step_strong(const ChainForm& form, double* numbers) {
  return Block<width>(form, numbers).step.step_strong();
}

template <int width>
void step_weak(const ChainForm& form, double* numbers) {
  Block<width>(form, numbers).step.step_weak();
}

template <int width>
void place(const ChainForm& form, double* numbers) {
  Block<width>(form, numbers).step.place();
}

template <int width>
struct SpatialBlock {
  using Number = typename Lanes<width>::Number;

  SpatialBlock(const SpatialForm& form, double* numbers)
      : memory(reinterpret_cast<Number*>(numbers), form.counts),
        scratch(reinterpret_cast<Number*>(numbers) + SpatialMemory<Number>::size(form.counts), form.counts),
        step(form, memory, scratch) {}

  SpatialMemory<Number> memory;
  SpatialScratch<Number> scratch;
  SpatialStep<width> step;
};

template <int width>
unsigned step_strong_in_space(const SpatialForm& form, double* numbers) {
  return SpatialBlock<width>(form, numbers).step.step_strong();
}

template <int width>
void step_weak_in_space(const SpatialForm& form, double* numbers) {
  SpatialBlock<width>(form, numbers).step.step_weak();
}

template <int width>
void place_in_space(const SpatialForm& form, double* numbers) {
  SpatialBlock<width>(form, numbers).step.place();
}

}  // namespace
}  // namespace proleg::sim::reduced
