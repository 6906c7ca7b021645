#pragma once

// Reads the data files of the thesis (listing B.8) and of `proleg export --thesis`.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <istream>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "sim/data_file/module_frames.hpp"

namespace proleg::sim {

/// Whether a file looks like XML, as a data file does and a recording does not.
[[nodiscard]] bool is_xml_file(const std::filesystem::path& path);

/// A data file as a table: a row for each time at which a module has a frame. Reads the file in a stream, once for each
/// module, because a round has the frames of one module after those of another.
///
/// A file that is cut in the middle ends with its last whole frame. Throws InputError with file and line for any other
/// text, also for a file without a whole frame, and FileError if the system cannot read it.
class DataFile {
 public:
  using Open = std::function<std::unique_ptr<std::istream>()>;

  explicit DataFile(const std::filesystem::path& path);
  /// name: for messages. open: opens the text at its beginning, each time.
  DataFile(std::string name, const Open& open);
  DataFile(const DataFile&) = delete;
  DataFile& operator=(const DataFile&) = delete;

  /// Names of the columns: tick (the index of the frame), time_s (its simtime), realtime_ms; then TYPE.PART for each
  /// number of a frame, e.g. Angle.J1, or Angle.1 if the file does not name its parts. If two modules have a column of
  /// one name, that of the second one ends with the name of its module.
  [[nodiscard]] const std::vector<std::string>& columns() const { return columns_; }

  /// Writes the table in the form of write_tsv() (sim/record/tsv.hpp); must be called only once. A cell is empty if the
  /// module has no frame at that time, or the number is infinite or NaN.
  void write_table(const std::function<void(std::string_view)>& write);

  // These are known after write_table().
  [[nodiscard]] std::uint64_t rows() const { return rows_; }
  [[nodiscard]] double last_time_s() const { return last_time_s_; }
  /// One line for the user if the file was cut; empty if it is whole.
  [[nodiscard]] std::string remark_on_cut() const;

 private:
  void name_columns();

  std::string name_;
  std::vector<DataModule> modules_;
  std::vector<ModuleFrames> frames_;
  std::vector<bool> has_frame_;  ///< whether the next frame of each module is read
  std::vector<std::string> columns_;
  std::uint64_t rows_ = 0;
  std::uint64_t whole_frames_ = 0;
  double last_time_s_ = 0.0;
};

}  // namespace proleg::sim
