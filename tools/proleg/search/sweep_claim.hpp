#pragma once

#include <cstdint>
#include <filesystem>

#include "sim/optimize/evaluation/store_file.hpp"
#include "sim/optimize/sweep/sweep_request.hpp"

namespace proleg::tools {

/// The files of a sweep for other programs, beside its results: what it was asked for, and while it runs a lock and
/// the requests to stop (sim/optimize/evaluation/store_file.hpp). Its folder must be claimed (ResultFolder).
class SweepClaim {
 public:
  /// is_resumed: the folder has results; the request stays as it is if it is readable and has the same measure. Throws
  /// FileError and StoreError.
  SweepClaim(const std::filesystem::path& folder, const optimize::SweepRequest& request, bool is_resumed);
  /// Removes the lock, and without results the request if the folder has nothing else.
  ~SweepClaim();
  SweepClaim(const SweepClaim&) = delete;
  SweepClaim& operator=(const SweepClaim&) = delete;

  /// Whether another program has asked this one to stop.
  [[nodiscard]] bool is_stop_requested() const;

 private:
  std::filesystem::path table_;
  std::filesystem::path request_;
  optimize::StoreLock lock_;
};

}  // namespace proleg::tools
