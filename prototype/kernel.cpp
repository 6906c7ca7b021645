#include "prototype/spatial_step.hpp"
namespace proleg::sim::reduced {
extern const SpatialKernel KERNEL;
const SpatialKernel KERNEL = spatial_kernel<WIDTH>(NAME);
}  // namespace proleg::sim::reduced
