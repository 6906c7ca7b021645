#pragma once

// What the page has to know about the installation of its program.

#include <chrono>
#include <string>

#include "host/server/page_files.hpp"
#include "host/server/robot_session.hpp"

namespace proleg::tools {

/// The documentation as the server has it, below /docs/; without files if it was not made.
[[nodiscard]] host::DocumentFiles served_documentation();

/// The document `program`: whether the documentation is served, and whether the files of this program were replaced or
/// removed while it runs, as by an update. The program goes on; what it starts is of the new version, or missing.
class ProgramWatch {
 public:
  using Clock = std::chrono::steady_clock;

  /// Publishes the document. page_program: the program that serves the page, by its version. A seat of a class that was
  /// started after an update is of another version than the page of the class.
  ProgramWatch(const std::string& page_program, host::SessionOutput& page);

  /// Looks at the files, at most every two seconds. If they were replaced, it publishes that, and prints a warning
  /// once.
  void look(Clock::time_point now);

 private:
  void publish();

  host::SessionOutput& page_;
  bool is_other_version_;
  bool is_replaced_ = false;
  Clock::time_point look_at_;
};

}  // namespace proleg::tools
