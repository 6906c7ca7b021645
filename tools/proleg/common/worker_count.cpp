#include "tools/proleg/common/worker_count.hpp"

#include <algorithm>
#include <thread>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"

namespace proleg::tools {

std::uint32_t parse_workers(const std::optional<std::string>& argument) {
  if (!argument) {
    return std::clamp(std::thread::hardware_concurrency(), 1U, max_workers);
  }
  const std::optional<std::uint32_t> count = parse_whole<std::uint32_t>(*argument);
  if (!count || *count == 0 || *count > max_workers) {
    throw InputError("--workers", 0, in_quotes(*argument), "1 to " + std::to_string(max_workers));
  }
  return *count;
}

}  // namespace proleg::tools
