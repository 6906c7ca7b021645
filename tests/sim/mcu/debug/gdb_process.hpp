#pragma once

#include <sys/types.h>

#include <atomic>
#include <string>
#include <thread>
#include <vector>

namespace proleg::sim {

/// The real gdb-multiarch, run without a terminal; its output is collected.
class GdbProcess {
 public:
  /// Loads the symbols of `image`, connects to the port and executes the commands.
  GdbProcess(const std::string& image, unsigned port, const std::vector<std::string>& commands);
  GdbProcess(const GdbProcess&) = delete;
  GdbProcess& operator=(const GdbProcess&) = delete;
  ~GdbProcess();

  [[nodiscard]] bool ended() const { return ended_; }
  /// As control-C in its terminal.
  void interrupt() const;
  /// Whether it waits for an event: its first thread sleeps. On a busy computer a thread that works does not sleep,
  /// even while it has no processor.
  [[nodiscard]] bool is_waiting() const;
  void kill() const;
  /// Waits for its end; all it has written.
  [[nodiscard]] const std::string& output();

 private:
  pid_t process_ = -1;
  int pipe_ = -1;
  std::atomic<bool> ended_ = false;
  std::string output_;
  std::thread reader_;
};

}  // namespace proleg::sim
