#include "sim/reduced/chain_kernel.hpp"
#include "sim/reduced/kernel_functions.hpp"

namespace proleg::sim::reduced {

const ChainKernel base_kernel{
    "SSE2 or NEON",   2, step_strong<2>, step_weak<2>, place<2>, step_strong_in_space<2>, step_weak_in_space<2>,
    place_in_space<2>};

}  // namespace proleg::sim::reduced
