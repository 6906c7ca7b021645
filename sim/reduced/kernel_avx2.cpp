#include "sim/reduced/chain_step.hpp"
#include "sim/reduced/kernel.hpp"

namespace proleg::sim::reduced {

constinit const ChainKernel avx2_kernel{steps_of<Planar, 4>, steps_of<Spatial, 4>, "AVX2", 4};

}  // namespace proleg::sim::reduced
