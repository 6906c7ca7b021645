#pragma once

// What differs if the menu of a desktop starts the program: no terminal says in which folder it works, and ends it.

#include <chrono>
#include <cstddef>
#include <string>

namespace proleg::tools {

/// The folder Proleg in the home of the user, which it makes. If that cannot be written, prints a warning and returns
/// the folder for temporary files.
[[nodiscard]] std::string desktop_folder();

/// Finds out when the last page has been closed for a while.
class LastPage {
 public:
  using Time = std::chrono::steady_clock::time_point;
  /// A page that is loaded again, or a browser that starts, is back before.
  static constexpr std::chrono::seconds patience{60};

  explicit LastPage(Time start) : last_seen_(start) {}
  /// viewers: pages that are open now.
  [[nodiscard]] bool is_gone(Time now, std::size_t viewers) {
    if (viewers > 0) {
      last_seen_ = now;
    }
    return now - last_seen_ > patience;
  }

 private:
  Time last_seen_;
};

}  // namespace proleg::tools
