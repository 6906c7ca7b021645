#pragma once

#include <atomic>
#include <string>
#include <thread>

#include "tests/host/dynamixel/servo_emulator.hpp"

namespace proleg::test {

/// Emulated servos behind a pseudo terminal, in real time, in a thread of their own.
class PtyServos {
 public:
  /// servos: must outlive this object. Its members may be read again after stop().
  explicit PtyServos(ServoEmulator& servos);
  ~PtyServos();
  PtyServos(const PtyServos&) = delete;
  PtyServos& operator=(const PtyServos&) = delete;

  /// The device that a program opens.
  [[nodiscard]] const std::string& device() const { return device_; }
  /// Ends the thread and closes the terminal, as if the adapter were unplugged.
  void stop();

 private:
  void serve();

  ServoEmulator& servos_;
  int terminal_ = -1;
  std::string device_;
  std::atomic<bool> must_end_ = false;
  std::thread thread_;
};

}  // namespace proleg::test
