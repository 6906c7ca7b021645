#include "sim/data_file/data_file.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/output/output.hpp"
#include "shared/computer/text/text.hpp"

namespace proleg::sim {
namespace {

constexpr const char* expected_file = "a data file (<dataroot>) as 'proleg export --thesis' writes it";

DataFile::Open opener(const std::filesystem::path& path) {
  if (const std::optional<std::string> found = found_instead_of_file(path)) {
    throw InputError(path.string(), 0, *found, expected_file);
  }
  return [path]() -> std::unique_ptr<std::istream> {
    auto stream = std::make_unique<std::ifstream>(path, std::ios::binary);
    if (!*stream) {
      throw FileError(path, std::string("cannot be read: ") + std::strerror(errno));
    }
    return stream;
  };
}

std::string part_name(const DataModule& module, std::size_t part, std::size_t count) {
  if (module.part_names.size() == count) {
    return module.part_names[part];
  }
  return module.joint_names.size() == count ? module.joint_names[part] : std::to_string(part + 1);
}

}  // namespace

bool is_xml_file(const std::filesystem::path& path) {
  constexpr std::size_t max_head = 200;
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    return false;
  }
  const std::string head = first_bytes(path, max_head);
  return trimmed(without_byte_order_mark(head)).starts_with('<');
}

DataFile::DataFile(const std::filesystem::path& path) : DataFile(path.string(), opener(path)) {}

DataFile::DataFile(std::string name, const Open& open) : name_(std::move(name)) {
  {
    MarkupScanner scanner(name_, open());
    modules_ = read_data_header(scanner);
  }
  for (std::size_t module = 0; module < modules_.size(); ++module) {
    MarkupScanner scanner(name_, open());
    static_cast<void>(read_data_header(scanner));
    frames_.emplace_back(std::move(scanner), modules_, module);
    has_frame_.push_back(frames_.back().next());
  }
  if (std::ranges::find(has_frame_, true) == has_frame_.end()) {
    const std::optional<int> cut = frames_.empty() ? std::nullopt : frames_.front().cut_line();
    throw InputError(name_, cut.value_or(0), cut ? "the end of the file before the first whole frame" : "no frame",
                     "at least one <frame> with the numbers of a module");
  }
  name_columns();
}

void DataFile::name_columns() {
  columns_ = {"tick", "time_s", "realtime_ms"};
  std::set<std::string> used(columns_.begin(), columns_.end());
  std::map<std::string, std::size_t> last_number;  // last number of columns with the same name, from 2
  for (std::size_t m = 0; m < modules_.size(); ++m) {
    const DataModule& module = modules_[m];
    const std::vector<std::size_t>& counts = frames_[m].counts();
    for (std::size_t type = 0; type < counts.size(); ++type) {
      for (std::size_t part = 0; part < counts[type]; ++part) {
        std::string name = one_line(module.types[type] + "." + part_name(module, part, counts[type]));
        if (used.contains(name)) {
          name += "." + module.name;
        }
        const std::string without_number = name;
        for (std::size_t& number = last_number[without_number]; !used.insert(name).second;) {
          name = without_number + "." + std::to_string(++number + 1);
        }
        columns_.push_back(name);
      }
    }
  }
}

void DataFile::write_table(const std::function<void(std::string_view)>& write) {
  TableLine line;
  for (const std::string& column : columns_) {
    line.add(std::string_view(column));
  }
  write(line.finish());
  while (true) {
    double time = std::numeric_limits<double>::infinity();
    const DataFrame* first = nullptr;
    for (std::size_t m = 0; m < frames_.size(); ++m) {
      if (has_frame_[m] && frames_[m].frame().simtime_ms < time) {
        first = &frames_[m].frame();
        time = first->simtime_ms;
      }
    }
    if (first == nullptr) {
      return;
    }
    constexpr double ms_per_s = 1e3;
    last_time_s_ = time / ms_per_s;
    line.add(std::string_view(first->index));
    line.add(last_time_s_);
    line.add(first->realtime_ms);
    for (std::size_t m = 0; m < frames_.size(); ++m) {
      if (has_frame_[m] && frames_[m].frame().simtime_ms == time) {
        for (const double value : frames_[m].frame().values) {
          line.add(value);
        }
        has_frame_[m] = frames_[m].next();
        ++whole_frames_;
      } else {
        for (const std::size_t count : frames_[m].counts()) {
          for (std::size_t part = 0; part < count; ++part) {
            line.add(std::string_view());
          }
        }
      }
    }
    write(line.finish());
    ++rows_;
  }
}

std::string DataFile::remark_on_cut() const {
  const auto cut =
      std::ranges::find_if(frames_, [](const ModuleFrames& frames) { return frames.cut_line().has_value(); });
  if (cut == frames_.end()) {
    return {};
  }
  return name_ + ":" + std::to_string(*cut->cut_line()) + ": the file ends in the middle; its " +
         std::to_string(whole_frames_) + " whole frames are used";
}

}  // namespace proleg::sim
