#pragma once

#include "sim/reduced/chain_form.hpp"
#include "sim/reduced/spatial_form.hpp"

namespace proleg::sim::reduced {

/// Steps the chains of a block, one in each lane, with the instructions of one kind of processor. All kernels give the
/// same bits. The block is a ChainMemory, `scratch` a ChainScratch, both aligned to 64 bytes.
struct ChainKernel {
  const char* instructions;  ///< e.g. "AVX2"
  int width;                 ///< chains in a block
  /// ChainStep::step_strong().
  unsigned (*step_strong)(const ChainForm& form, double* block, double* scratch);
  /// ChainStep::step_weak().
  void (*step_weak)(const ChainForm& form, double* block, double* scratch);
  /// Only computes where the links are.
  void (*place)(const ChainForm& form, double* block, double* scratch);
  // The same for chains with joints of any axis. The block is a SpatialMemory, `scratch` a SpatialScratch.
  unsigned (*step_strong_in_space)(const SpatialForm& form, double* block, double* scratch);
  void (*step_weak_in_space)(const SpatialForm& form, double* block, double* scratch);
  void (*place_in_space)(const SpatialForm& form, double* block, double* scratch);
};

/// For every processor.
extern const ChainKernel base_kernel;
#ifdef __x86_64__
extern const ChainKernel avx2_kernel;
extern const ChainKernel avx512_kernel;
#endif

}  // namespace proleg::sim::reduced
