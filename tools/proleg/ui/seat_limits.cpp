#include "tools/proleg/ui/seat_limits.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <string_view>
#include <system_error>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/optimize/evaluation/store_file.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/ui/search_folder.hpp"
#include "tools/proleg/ui/sweep_folder.hpp"

namespace proleg::tools {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::uint64_t mebibyte = std::uint64_t{1} << 20U;

/// Operations that write files of any size or number. What ends a recording, and what saves the draft in its files,
/// goes on.
constexpr std::array<std::string_view, 11> writing_operations{
    "record",       "save_as",          "draft.save_as",   "search.start",    "search.resume",  "sweep.start",
    "sweep.resume", "algorithm.create", "algorithm.build", "algorithm.check", "algorithm.image"};

bool writes_much(const host::OperationRequest& request) {
  const bool ends_recording =
      request.name == "record" && (!request.arguments.contains("file") || request.arguments["file"].is_null());
  return std::ranges::find(writing_operations, request.name) != writing_operations.end() && !ends_recording;
}

bool is_written_by_program(const fs::path& file) {
  return file.filename() == SearchFolder::store_of({}).filename() ||
         file.filename() == SweepFolder::table_of({}).filename();
}

std::string mib_text(std::uint64_t mib) { return std::to_string(mib) + " MiB"; }

}  // namespace

SeatLimits limits_of_learner(unsigned robots, std::uint32_t processors) {
  SeatLimits limits;
  limits.workers = std::max(1U, processors / std::max(1U, robots));
  return limits;
}

json limits_json(const SeatLimits& limits) {
  return {{"workers", limits.workers},
          {"programs", limits.programs},
          {"folder_mib", limits.folder_mib},
          {"files", limits.files},
          {"free_mib", limits.free_mib}};
}

std::optional<SeatLimits> limits_in(const json& object) {
  if (!object.is_object()) {
    return std::nullopt;
  }
  const SeatLimits usual;
  return SeatLimits{object.value("workers", usual.workers), object.value("programs", usual.programs),
                    object.value("folder_mib", usual.folder_mib), object.value("files", usual.files),
                    object.value("free_mib", usual.free_mib)};
}

ProgramShare::ProgramShare(const fs::path& folder, const std::optional<SeatLimits>& limits)
    : folder_(fs::canonical(folder)), limits_(limits) {}

std::uint32_t ProgramShare::processors() const {
  const std::uint32_t all = parse_workers(std::nullopt);
  return limits_ ? std::min(limits_->workers, all) : all;
}

std::uint32_t ProgramShare::workers(std::optional<std::uint32_t> wanted) const {
  const std::uint32_t most = limits_ ? limits_->workers : max_workers;
  if (wanted && (*wanted == 0 || *wanted > most)) {
    throw InputError("workers", 0, std::to_string(*wanted),
                     "1 to " + std::to_string(most) +
                         (limits_ ? ", the share that a learner of this class has of the processors" : ""));
  }
  return wanted.value_or(processors());
}

void ProgramShare::claim(const fs::path& written) {
  const std::lock_guard lock(mutex_);
  if (limits_) {
    std::vector<fs::path> running = measure_folder(folder_).running;
    for (const fs::path& claimed : claimed_) {
      if (std::ranges::find(running, claimed) == running.end()) {
        running.push_back(claimed);
      }
    }
    if (running.size() >= limits_->programs) {
      throw std::runtime_error("found " + std::to_string(running.size()) + " searches and sweeps that go on (" +
                               one_line(running.front().parent_path().filename().string()) + "), expected fewer than " +
                               std::to_string(limits_->programs) +
                               ": a learner of a class computes so many at a time; stop one, or wait for its end");
    }
  }
  claimed_.push_back(written);
}

void ProgramShare::release(const fs::path& written) {
  const std::lock_guard lock(mutex_);
  if (const auto found = std::ranges::find(claimed_, written); found != claimed_.end()) {
    claimed_.erase(found);
  }
}

FolderUse measure_folder(const fs::path& folder) {
  constexpr std::uint64_t block = 512;  // of st_blocks (stat(2))
  FolderUse use;
  std::error_code error;
  fs::recursive_directory_iterator entry(folder, fs::directory_options::skip_permission_denied, error);
  for (; !error && entry != fs::recursive_directory_iterator(); entry.increment(error)) {
    struct stat status {};
    if (::lstat(entry->path().c_str(), &status) != 0) {
      continue;  // it has gone
    }
    ++use.files;
    use.bytes += static_cast<std::uint64_t>(status.st_blocks) * block;
    if (is_written_by_program(entry->path()) && optimize::is_being_written(entry->path())) {
      use.running.push_back(entry->path());
    }
  }
  return use;
}

std::string disk_problem(const SeatLimits& limits, const FolderUse& use, std::uint64_t free_bytes) {
  const std::string remedy = "; remove files in it, or ask your teacher";
  if (use.bytes > limits.folder_mib * mebibyte) {
    return "found " + mib_text(use.bytes / mebibyte) + " in the folder of this learner, expected at most " +
           mib_text(limits.folder_mib) + remedy;
  }
  if (use.files > limits.files) {
    return "found " + std::to_string(use.files) + " files in the folder of this learner, expected at most " +
           std::to_string(limits.files) + remedy;
  }
  if (free_bytes < limits.free_mib * mebibyte) {
    return "found " + mib_text(free_bytes / mebibyte) + " free on the disk of the class, expected at least " +
           mib_text(limits.free_mib) + "; ask your teacher";
  }
  return {};
}

DiskGuard::DiskGuard(const fs::path& folder, const std::optional<SeatLimits>& limits, host::RobotSession& session)
    : folder_(fs::canonical(folder)), limits_(limits), session_(session) {}

void DiskGuard::operate(const host::OperationRequest& request) {
  if (limits_ && writes_much(request)) {
    const std::lock_guard lock(mutex_);
    if (output_ != nullptr && !problem_.empty()) {
      output_->refuse(request.request, problem_);
      return;
    }
  }
  session_.operate(request);
}

void DiskGuard::look() {
  const FolderUse use = measure_folder(folder_);
  std::error_code error;
  const fs::space_info space = fs::space(folder_, error);
  SeatLimits limits = *limits_;
  if (!error) {
    limits.free_mib = std::min<std::uint64_t>(limits.free_mib, space.capacity / mebibyte / 10);
  }
  const std::string problem = disk_problem(limits, use, error ? limits.free_mib * mebibyte : space.available);
  bool is_new = false;
  {
    const std::lock_guard lock(mutex_);
    is_new = problem_.empty() && !problem.empty();
    problem_ = problem;
  }
  if (problem.empty()) {
    return;
  }
  session_.operate({0, "record", {{"file", nullptr}}, 0, ""});
  for (const fs::path& written : use.running) {
    try {
      optimize::request_stop(written);
    } catch (const optimize::StoreError&) {  // it has ended
    }
  }
  if (const std::lock_guard lock(mutex_); is_new && output_ != nullptr) {
    output_->notice(host::NoticeLevel::error, "what fills the disk has been ended: " + problem);
  }
}

DiskWatch::DiskWatch(DiskGuard& guard, host::SessionOutput& output) : guard_(guard) {
  if (guard_.limits_) {
    const std::lock_guard lock(guard_.mutex_);
    guard_.output_ = &output;
    thread_ = std::thread([this] { run(); });
  }
}

DiskWatch::~DiskWatch() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  wake_.notify_all();
  if (thread_.joinable()) {
    thread_.join();
  }
  const std::lock_guard lock(guard_.mutex_);
  guard_.output_ = nullptr;
}

void DiskWatch::run() {
  using Clock = std::chrono::steady_clock;
  constexpr std::chrono::seconds shortest_pause{1};
  constexpr int rest = 20;  // so much longer than the look: at most 5 % of the time
  for (std::unique_lock lock(mutex_); !ends_;) {
    lock.unlock();
    const Clock::time_point begin = Clock::now();
    guard_.look();
    const Clock::duration pause = std::max<Clock::duration>(shortest_pause, rest * (Clock::now() - begin));
    lock.lock();
    wake_.wait_for(lock, pause, [this] { return ends_; });
  }
}

}  // namespace proleg::tools
