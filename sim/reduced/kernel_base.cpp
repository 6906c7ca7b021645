#include "sim/reduced/chain_step.hpp"
#include "sim/reduced/kernel.hpp"

namespace proleg::sim::reduced {

constinit const ChainKernel base_kernel{steps_of<Planar, 2>, steps_of<Spatial, 2>, "SSE2 or NEON", 2};

}  // namespace proleg::sim::reduced
