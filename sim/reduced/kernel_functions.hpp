#pragma once

#include "sim/reduced/chain_step.hpp"
#include "sim/reduced/spatial_step.hpp"

namespace proleg::sim::reduced {
namespace {  // of each instruction set its own (chain_step.hpp)

template <int width>
struct Block {
  using Number = typename Lanes<width>::Number;

  Block(const ChainForm& form, double* block, double* scratch_numbers)
      : memory(reinterpret_cast<Number*>(block), form.counts),
        scratch(reinterpret_cast<Number*>(scratch_numbers), form.counts),
        step(form, memory, scratch) {}

  ChainMemory<Number> memory;
  ChainScratch<Number> scratch;
  ChainStep<width> step;
};

template <int width>
unsigned step_strong(const ChainForm& form, double* block, double* scratch) {
  return Block<width>(form, block, scratch).step.step_strong();
}

template <int width>
void step_weak(const ChainForm& form, double* block, double* scratch) {
  Block<width>(form, block, scratch).step.step_weak();
}

template <int width>
void place(const ChainForm& form, double* block, double* scratch) {
  Block<width>(form, block, scratch).step.place();
}

template <int width>
struct SpatialBlock {
  using Number = typename Lanes<width>::Number;

  SpatialBlock(const SpatialForm& form, double* block, double* scratch_numbers)
      : memory(reinterpret_cast<Number*>(block), form.counts),
        scratch(reinterpret_cast<Number*>(scratch_numbers), form.counts),
        step(form, memory, scratch) {}

  SpatialMemory<Number> memory;
  SpatialScratch<Number> scratch;
  SpatialStep<width> step;
};

template <int width>
unsigned step_strong_in_space(const SpatialForm& form, double* block, double* scratch) {
  return SpatialBlock<width>(form, block, scratch).step.step_strong();
}

template <int width>
void step_weak_in_space(const SpatialForm& form, double* block, double* scratch) {
  SpatialBlock<width>(form, block, scratch).step.step_weak();
}

template <int width>
void place_in_space(const SpatialForm& form, double* block, double* scratch) {
  SpatialBlock<width>(form, block, scratch).step.place();
}

}  // namespace
}  // namespace proleg::sim::reduced
