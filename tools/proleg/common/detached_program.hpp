#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace proleg::tools {

/// Another program (program_start.hpp) that goes on when this one ends, in any way. What it prints is added to a file.
class DetachedProgram {
 public:
  /// log: is made if there is none. Throws std::runtime_error if it cannot be started.
  DetachedProgram(const std::vector<std::string>& command, const std::string& folder, const std::filesystem::path& log);

  /// Its exit status; nothing as long as it runs. Does not wait. Without this call an ended program stays in the
  /// system's list until this one ends.
  [[nodiscard]] std::optional<int> status();
  [[nodiscard]] pid_t process() const { return process_; }
  /// As Ctrl-C does. Not after status() has returned one.
  void interrupt() const;

 private:
  pid_t process_ = -1;
  std::optional<int> status_;
};

}  // namespace proleg::tools
