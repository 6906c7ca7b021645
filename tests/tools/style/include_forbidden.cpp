// The kernel stands above the algorithms: a file of shared/gait may not include it.
#include "shared/fixed/sine.hpp"
#include "shared/gait/registry.hpp"
#include "shared/kernel/kernel.hpp"
