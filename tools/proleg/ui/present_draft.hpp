#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <utility>

#include "sim/scenario/scenario.hpp"

namespace proleg::tools {

/// The draft as it is now, for other sessions. Any thread may use it.
class PresentDraft {
 public:
  struct Content {
    std::shared_ptr<const sim::Scenario> scenario;  ///< null: there is no draft
    std::uint64_t revision = 0;
    bool is_saved = false;  ///< its files are on disk as they are here
  };

  void set(Content content) {
    const std::lock_guard lock(mutex_);
    content_ = std::move(content);
  }
  [[nodiscard]] Content get() const {
    const std::lock_guard lock(mutex_);
    return content_;
  }

 private:
  mutable std::mutex mutex_;
  Content content_;
};

}  // namespace proleg::tools
