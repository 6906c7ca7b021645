#include "sim/reduced/chain_kernel.hpp"
#include "sim/reduced/kernel_functions.hpp"

namespace proleg::sim::reduced {

const ChainKernel avx2_kernel{
    "AVX2",           4, step_strong<4>, step_weak<4>, place<4>, step_strong_in_space<4>, step_weak_in_space<4>,
    place_in_space<4>};

}  // namespace proleg::sim::reduced
