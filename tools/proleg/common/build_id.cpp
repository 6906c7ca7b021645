#include "tools/proleg/common/build_id.hpp"

#include "build_id_text.hpp"
#include "result_key_text.hpp"

namespace proleg::tools {

const char* const build_id = PROLEG_BUILD_ID;
const char* const result_key = PROLEG_RESULT_KEY;

}  // namespace proleg::tools
