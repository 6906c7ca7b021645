#include "tools/proleg/ui/begun_programs.hpp"

#include <algorithm>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/optimize/evaluation/store_file.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/ui/scenario_copy.hpp"

namespace proleg::tools {
namespace {

namespace fs = std::filesystem;

/// Asks a program to stop that may have ended just now.
void stop_if_running(const fs::path& written) {
  try {
    optimize::request_stop(written);
  } catch (const optimize::StoreError&) {
    if (optimize::is_being_written(written)) {
      throw;
    }
  }
}

}  // namespace

fs::path BegunPrograms::written_in(const fs::path& folder) const { return folder / kind_.written; }

void BegunPrograms::begin(host::RequestId request, const std::string& name, const fs::path& folder, bool is_new,
                          const std::vector<std::string>& command, const fs::path& directory) {
  share_.claim(written_in(folder));
  try {
    beginnings_.push_back({request, name, folder, DetachedProgram(command, directory.string(), folder / kind_.log),
                           Clock::now() + kind_.longest_start, is_new});
  } catch (...) {
    share_.release(written_in(folder));
    throw;
  }
}

bool BegunPrograms::look() {
  bool has_begun = false;
  beginnings_.remove_if([&](Beginning& beginning) { return look_at(beginning, has_begun); });
  running_.remove_if([this](Running& running) {
    const bool has_ended = running.program.status().has_value();
    if (has_ended) {
      share_.release(running.written);
    }
    return has_ended;
  });
  return has_begun;
}

bool BegunPrograms::look_at(Beginning& beginning, bool& has_begun) {
  const fs::path written = written_in(beginning.folder);
  const std::optional<int> status = beginning.program.status();
  // Another program may have been faster, and writes to it.
  const bool is_open = optimize::writer_of(written) == beginning.program.process();
  std::error_code error;
  if (is_open || (status == exit_success && fs::exists(written, error))) {
    has_begun = true;
    if (beginning.stops && is_open) {
      stop_if_running(written);
    }
    if (!beginning.is_answered) {
      output_.answer(beginning.request, {{"name", beginning.name}});
    }
    running_.push_back({std::move(beginning.program), written});
    return true;
  }
  if (!status) {
    if (!beginning.is_answered && Clock::now() >= beginning.until) {
      output_.refuse(beginning.request, "the " + kind_.what + " has not begun in time; it may begin later");
      beginning.is_answered = true;
    }
    return false;
  }
  if (!beginning.is_answered) {
    output_.refuse(beginning.request, refusal_of(beginning.folder, *status));
  }
  share_.release(written);
  if (beginning.is_new && !kind_.has_results(beginning.folder)) {
    fs::remove_all(beginning.folder, error);
  }
  return true;
}

std::string BegunPrograms::refusal_of(const fs::path& folder, int status) const {
  if (optimize::is_being_written(written_in(folder))) {
    return "another program has begun to continue this " + kind_.what;
  }
  std::string line = kind_.failure(folder);
  constexpr std::uintmax_t little = 64 * 1024;
  if (std::error_code error; line.empty() && fs::space(folder, error).available < little) {
    line = "no space left on the disk";  // not even for the reason
  }
  return line.empty() ? "the " + kind_.what + " has ended with status " + std::to_string(status) : line;
}

bool BegunPrograms::begins(const fs::path& folder) const {
  return std::ranges::any_of(beginnings_, [&](const Beginning& its) { return its.folder == folder; });
}

bool BegunPrograms::stop(const std::string& name) {
  const auto found = std::ranges::find(beginnings_, name, &Beginning::name);
  if (found == beginnings_.end()) {
    return false;
  }
  found->stops = true;
  return true;
}

void BegunPrograms::refuse_all(const std::string& why) {
  for (Beginning& beginning : beginnings_) {
    if (!beginning.is_answered) {
      output_.refuse(beginning.request, why);
    }
    running_.push_back({std::move(beginning.program), written_in(beginning.folder)});
  }
  beginnings_.clear();
}

void BegunPrograms::close() {
  for (Beginning& beginning : beginnings_) {
    if (beginning.stops && !beginning.program.status()) {
      beginning.program.interrupt();
    }
  }
}

bool BegunPrograms::has_waiting() const { return !std::ranges::all_of(beginnings_, &Beginning::is_answered); }

fs::path make_new_folder(const fs::path& parent, const std::string& name) {
  fs::path folder = new_folder_in(parent, name, "name");
  std::error_code error;
  fs::create_directory(parent, error);
  if (const fs::path real = fs::canonical(parent, error); error || real != parent) {
    throw InputError(parent.string(), 0, error ? error.message() : "a link to " + real.string(), "a folder");
  }
  if (!fs::create_directory(folder, error)) {
    if (error) {
      throw FileError(folder, "cannot be created: " + error.message());
    }
    throw InputError("name", 0, in_quotes(name) + ", which exists", "a new name");
  }
  return folder;
}

}  // namespace proleg::tools
