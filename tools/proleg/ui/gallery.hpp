#pragma once

// The list with pictures of what a person can open, in a thread of its own with a low priority.

#include <chrono>
#include <cstddef>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/proleg/ui/project_files.hpp"
#include "tools/proleg/ui/session_base.hpp"

namespace proleg::tools {

struct GalleryOptions {
  /// Processor time for a picture. A scenario that needs more has a picture of its start.
  std::chrono::milliseconds longest_run{2000};
  /// At least so long it takes from one document to the next while pictures are made.
  std::chrono::milliseconds publish_period{300};
};

/// Publishes the document `gallery` (docs/page-interface.md) when somebody looks at it: first the names, then the
/// pictures as they are made. The next look finds new and changed files; what has not changed is not computed again.
class Gallery final : private SessionThread {
 public:
  /// files, requests, output: must outlive this.
  Gallery(const ProjectFiles& files, SessionRequests& requests, host::SessionOutput& output,
          GalleryOptions options = {});
  ~Gallery() override;

  /// Operations that anybody may use.
  [[nodiscard]] static std::vector<std::string> free_operations() { return {"gallery.look"}; }

 private:
  /// What is known about a file.
  struct Known {
    std::string hash;      ///< of the texts of all files of the scenario; empty: they have not been read
    nlohmann::json entry;  ///< of the document
  };

  // SessionThread
  void serve() override;
  void fail(const std::string& why) override;
  [[nodiscard]] nlohmann::json carry_out(const host::OperationRequest& operation) override;

  void list();
  /// Reads the scenario; computes what has changed since it was read before.
  void describe(const ProjectFile& file);
  void publish();

  const ProjectFiles& files_;
  GalleryOptions options_;
  bool is_wanted_ = false;              ///< somebody has looked since the last list()
  std::vector<ProjectFile> shown_;      ///< in the order of the document
  std::size_t next_ = 0;                ///< position of the first one that is to be described
  std::map<std::string, Known> known_;  ///< by file
  Clock::time_point publish_at_;
  bool has_low_priority_ = false;
};

}  // namespace proleg::tools
