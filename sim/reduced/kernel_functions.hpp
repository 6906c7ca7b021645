#pragma once

#include "sim/reduced/chain_step.hpp"

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

}  // namespace
}  // namespace proleg::sim::reduced
