#pragma once

// What a learner of a class may use of the computer, so that the robots of the others stay at real time
// (docs/page.md, "A class"). A person at his or her own computer has no such limits.

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "host/server/robot_session.hpp"

namespace proleg::tools {

struct SeatLimits {
  std::uint32_t workers = 1;   ///< of a search or a sweep
  std::uint32_t programs = 1;  ///< searches and sweeps that go on at a time
  std::uint64_t folder_mib = 1024;
  std::uint64_t files = 20'000;   ///< and folders, in that folder
  std::uint64_t free_mib = 1024;  ///< that stay free on the disk; of a small one a tenth of it
};

/// Those of a learner in a class with so many robots, on a computer with so many processors.
[[nodiscard]] SeatLimits limits_of_learner(unsigned robots, std::uint32_t processors);

[[nodiscard]] nlohmann::json limits_json(const SeatLimits& limits);
/// Nothing for null.
[[nodiscard]] std::optional<SeatLimits> limits_in(const nlohmann::json& object);

/// The searches and sweeps of a project, which may be limited together. May be used from any thread.
class ProgramShare {
 public:
  /// folder: of the project.
  ProgramShare(const std::filesystem::path& folder, const std::optional<SeatLimits>& limits);

  /// The greatest number of workers of one; what it has if nobody says a number.
  [[nodiscard]] std::uint32_t processors() const;
  /// The number of workers that a viewer asks for; nothing: the usual ones. Throws InputError.
  [[nodiscard]] std::uint32_t workers(std::optional<std::uint32_t> wanted) const;

  /// Takes a place for a program. written: the file that it writes. Throws std::runtime_error if all are taken.
  void claim(const std::filesystem::path& written);
  void release(const std::filesystem::path& written);

 private:
  const std::filesystem::path folder_;
  const std::optional<SeatLimits> limits_;
  std::mutex mutex_;
  std::vector<std::filesystem::path> claimed_;
};

/// What is in a folder. Links are not followed.
struct FolderUse {
  std::uint64_t bytes = 0;                     ///< on the disk
  std::uint64_t files = 0;                     ///< and folders
  std::vector<std::filesystem::path> running;  ///< files that searches and sweeps write now
};
[[nodiscard]] FolderUse measure_folder(const std::filesystem::path& folder);

/// Which limit of the disk is exceeded, in one line; empty: none. free_bytes: of the disk.
[[nodiscard]] std::string disk_problem(const SeatLimits& limits, const FolderUse& use, std::uint64_t free_bytes);

/// The way of a learner's requests. As long as the disk's limits are exceeded, operations that write much are refused.
class DiskGuard final : public host::RobotSession {
 public:
  /// session: gets the requests. Must outlive this.
  DiskGuard(const std::filesystem::path& folder, const std::optional<SeatLimits>& limits, host::RobotSession& session);

  // RobotSession
  void operate(const host::OperationRequest& request) override;
  void stop(const host::StopRequest& request) override { session_.stop(request); }
  void holder_changed(bool has_holder, bool is_away) override { session_.holder_changed(has_holder, is_away); }

 private:
  friend class DiskWatch;

  /// Looks at the disk, and ends what fills it: a recording, searches and sweeps.
  void look();

  const std::filesystem::path folder_;
  const std::optional<SeatLimits> limits_;
  host::RobotSession& session_;
  std::mutex mutex_;
  host::SessionOutput* output_ = nullptr;  ///< null: nothing looks at the disk
  std::string problem_;
};

/// Looks at the disk for a guard that has limits, in a thread of its own.
class DiskWatch {
 public:
  /// Both must outlive this.
  DiskWatch(DiskGuard& guard, host::SessionOutput& output);
  ~DiskWatch();
  DiskWatch(const DiskWatch&) = delete;
  DiskWatch& operator=(const DiskWatch&) = delete;

 private:
  void run();

  DiskGuard& guard_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool ends_ = false;
  std::thread thread_;
};

}  // namespace proleg::tools
