#include "tools/proleg/search/sweep_claim.hpp"

#include <cstddef>
#include <filesystem>
#include <system_error>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/output/output.hpp"

namespace proleg::tools {
namespace {

namespace fs = std::filesystem;

bool is_noted(const fs::path& file, const optimize::SweepRequest& request) {
  constexpr std::size_t most = 1 << 20;
  try {
    return optimize::read_sweep_request(file.string(), first_bytes(file, most)).measure == request.measure;
  } catch (const InputError&) {
    return false;
  }
}

}  // namespace

SweepClaim::SweepClaim(const fs::path& folder, const optimize::SweepRequest& request, bool is_resumed)
    : table_(folder / optimize::sweep_table_name),
      request_(folder / optimize::sweep_request_name),
      lock_(table_, "its lock cannot be made") {
  optimize::forget_stop_request(table_);  // of an earlier program: request_stop() needs the lock
  if (!is_resumed || !is_noted(request_, request)) {
    try {
      write_file(request_, optimize::sweep_request_text(request));
    } catch (...) {
      std::error_code ignored;
      fs::remove(table_.string() + ".lock", ignored);
      throw;
    }
  }
  lock_.note_writer();
}

SweepClaim::~SweepClaim() {
  std::error_code ignored;
  optimize::forget_stop_request(table_);
  fs::remove(table_.string() + ".lock", ignored);
  std::size_t count = 0;
  for (fs::directory_iterator entry(table_.parent_path(), ignored); !ignored && entry != fs::directory_iterator();
       entry.increment(ignored)) {
    ++count;
  }
  if (count == 1) {
    fs::remove(request_, ignored);
  }
}

bool SweepClaim::is_stop_requested() const { return optimize::is_stop_requested(table_); }

}  // namespace proleg::tools
