#include "sim/reduced/chain_kernel.hpp"
#include "sim/reduced/kernel_functions.hpp"

namespace proleg::sim::reduced {

const ChainKernel avx512_kernel{
    "AVX-512",        8, step_strong<8>, step_weak<8>, place<8>, step_strong_in_space<8>, step_weak_in_space<8>,
    place_in_space<8>};

}  // namespace proleg::sim::reduced
