// What a file of shared/gait may include.
#include "shared/fixed/sine.hpp"
#include "shared/gait/registry.hpp"
