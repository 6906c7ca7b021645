#pragma once

// The header of a data file, and the frames of one of its modules.

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "sim/data_file/markup_scanner.hpp"

namespace proleg::sim {

/// The header's data on one producer of data: an actuation module, the touch sensors, or the robot.
struct DataModule {
  std::string name;
  std::size_t parts = 0;                 ///< number of parts, at least the count of a type's numbers
  std::vector<std::string> types;        ///< without realtime, simtime and stepcount, which frames have as attributes
  std::vector<std::string> part_names;   ///< names of joints, links or sensors; empty if the file has none
  std::vector<std::string> joint_names;  ///< names for types with a number for each joint; empty if the file has none
};

/// Reads from <dataroot> to </header>. Throws InputError for any other text, also if the file ends before </header>.
[[nodiscard]] std::vector<DataModule> read_data_header(MarkupScanner& scanner);

struct DataFrame {
  std::string index;         ///< whole number
  double realtime_ms = 0.0;  ///< time of day, from 1970-01-01
  double simtime_ms = 0.0;
  std::vector<double> values;  ///< all numbers of the first type, then of the second, ...
};

/// Reads the frames of one module, in the order of the file, and skips the others. Throws InputError.
class ModuleFrames {
 public:
  /// scanner: its position is behind the header. modules: all modules of the header; must outlive this object. own:
  /// number of the module.
  ModuleFrames(MarkupScanner scanner, const std::vector<DataModule>& modules, std::size_t own);

  /// Reads the next whole frame; false if there is no further one.
  bool next();
  [[nodiscard]] const DataFrame& frame() const { return frame_; }
  /// Count of numbers of each type, the same in all frames. Empty before the first frame.
  [[nodiscard]] const std::vector<std::size_t>& counts() const { return counts_; }
  /// The line in which the file ends before its end tags; nothing before next() has returned false.
  [[nodiscard]] std::optional<int> cut_line() const { return cut_line_; }

 private:
  enum class Place : std::uint8_t { file, round, module, after };

  /// Handles a tag of the file outside of a frame of the module.
  void enter(const MarkupScanner::Item& tag);
  void leave();
  [[nodiscard]] bool read_frame(const MarkupScanner::Item& start);
  /// Reads the numbers of a type up to its end tag; false if the file is cut.
  [[nodiscard]] bool read_numbers(std::size_t type, std::vector<double>& numbers);
  void take(std::vector<std::vector<double>>& numbers, int line);
  [[nodiscard]] std::string expected_here() const;

  MarkupScanner scanner_;
  const std::vector<DataModule>& modules_;
  std::size_t own_;
  Place place_ = Place::file;
  DataFrame frame_;
  bool has_frame_ = false;
  std::vector<std::size_t> counts_;
  std::optional<int> cut_line_;
};

}  // namespace proleg::sim
