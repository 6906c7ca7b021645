#include "sim/reduced/chain_step.hpp"
#include "sim/reduced/kernel.hpp"

namespace proleg::sim::reduced {

constinit const ChainKernel avx512_kernel{steps_of<Planar, 8>, steps_of<Spatial, 8>, "AVX-512", 8};

}  // namespace proleg::sim::reduced
