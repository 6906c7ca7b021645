#include "tools/proleg/build_id.hpp"

#include "build_id_text.hpp"

namespace proleg::tools {

const char* const build_id = PROLEG_BUILD_ID;

}  // namespace proleg::tools
