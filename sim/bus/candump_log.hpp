#pragma once

#include <filesystem>
#include <fstream>
#include <iosfwd>
#include <stdexcept>
#include <string>

#include "sim/bus/controller.hpp"

namespace proleg::sim {

/// A log that cannot be written: a full disk, a folder without permission. what() is one line: the path and why.
class CandumpLogError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The first character of every log.
inline constexpr char candump_log_start = '(';

/// Writes frames in the log format of candump (Debian's can-utils), which tshark, canplayer, log2asc, SavvyCAN and
/// others read. Each line has one frame and the time at which it ended, in seconds with six decimals:
///
///   (0000000003.001065) can0 080#2D
class CandumpLog {
 public:
  /// Creates or empties the file. Throws CandumpLogError.
  explicit CandumpLog(const std::filesystem::path& path, std::string interface = "can0");
  /// Writes to a stream, which must outlive the log; messages call it `name`.
  CandumpLog(std::ostream& stream, std::string name, std::string interface = "can0");
  /// Writes the rest, but cannot report errors: finish() can.
  ~CandumpLog();
  CandumpLog(const CandumpLog&) = delete;
  CandumpLog& operator=(const CandumpLog&) = delete;

  /// Throws CandumpLogError.
  void write(BusTime time, const CanFrame& frame);
  /// Writes the rest, so that the log is complete. Throws CandumpLogError.
  void finish();

 private:
  void flush();

  std::ofstream file_;
  std::ostream* stream_;
  std::string name_;
  std::string interface_;
  std::string buffer_;
};

}  // namespace proleg::sim
