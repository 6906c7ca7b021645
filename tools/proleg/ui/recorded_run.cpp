#include "tools/proleg/ui/recorded_run.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>

#include "host/server/telemetry.hpp"
#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "tools/proleg/document/recording_document.hpp"
#include "tools/proleg/document/robot_document.hpp"
#include "tools/proleg/document/telemetry_row.hpp"

namespace proleg::tools {
namespace {

using nlohmann::json;

constexpr std::uint32_t group_rows = RowPyramid::block_rows.back();

// The file is a row of groups; a group has all blocks of 4096 rows, level by level. So it can grow, and blocks that
// follow one another mostly are together.
constexpr std::uint64_t blocks_before(std::size_t level) {
  std::uint64_t blocks = 0;
  for (std::size_t i = 0; i < level; ++i) {
    blocks += group_rows / RowPyramid::block_rows[i];
  }
  return blocks;
}

constexpr std::uint64_t blocks_of_group = blocks_before(RowPyramid::block_rows.size());

std::uint64_t place(std::size_t level, std::uint64_t block) {
  const std::uint64_t in_group = group_rows / RowPyramid::block_rows[level];
  return block / in_group * blocks_of_group + blocks_before(level) + block % in_group;
}

[[noreturn]] void throw_errno() { throw std::system_error(errno, std::generic_category(), "temporary file"); }

void write_at(int file, std::span<const std::int32_t> values, std::uint64_t position) {
  const std::span<const std::byte> bytes = std::as_bytes(values);
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t written =
        ::pwrite(file, &bytes[done], bytes.size() - done, static_cast<off_t>(position * sizeof(std::int32_t) + done));
    if (written < 0 && errno != EINTR) {
      throw_errno();
    }
    done += static_cast<std::size_t>(std::max<ssize_t>(written, 0));
  }
}

void read_at(int file, std::span<std::int32_t> values, std::uint64_t position) {
  const std::span<std::byte> bytes = std::as_writable_bytes(values);
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t got =
        ::pread(file, &bytes[done], bytes.size() - done, static_cast<off_t>(position * sizeof(std::int32_t) + done));
    if (got == 0 || (got < 0 && errno != EINTR)) {
      throw_errno();
    }
    done += static_cast<std::size_t>(std::max<ssize_t>(got, 0));
  }
}

/// A file without a name. Not in /tmp, which is memory on many systems.
std::FILE* open_temporary_file() {
  const char* const folder = std::getenv("TMPDIR");
  std::string name = std::string(folder == nullptr ? "/var/tmp" : folder) + "/proleg-XXXXXX";
  const int descriptor = ::mkstemp(name.data());
  if (descriptor < 0) {
    throw_errno();
  }
  ::unlink(name.c_str());
  std::FILE* const file = ::fdopen(descriptor, "w+");
  if (file == nullptr) {
    ::close(descriptor);
    throw_errno();
  }
  return file;
}

// Ticks that are taken into the pyramid before the session looks for requests again: some milliseconds.
constexpr std::uint32_t slice_ticks = 128;

// First row, minima and maxima of a block.
constexpr std::size_t block_parts = 3;

std::unique_ptr<sim::Recording> open(const std::filesystem::path& path) {
  return std::make_unique<sim::Recording>(path);
}

/// The answer as bytes, little-endian as the processors that this program runs on.
class Rows {
 public:
  Rows(std::uint32_t tick, std::uint32_t stride, std::uint32_t newest_tick) : words_{tick, stride, 0, newest_tick} {}

  void add(std::span<const std::int32_t> row, const std::vector<std::size_t>& columns) {
    for (const std::size_t column : columns) {
      words_.push_back(static_cast<std::uint32_t>(row[column]));
    }
  }
  void count(std::uint32_t rows) { words_[2] += rows; }

  [[nodiscard]] std::vector<std::uint8_t> bytes() const {
    std::vector<std::uint8_t> bytes(words_.size() * sizeof(std::uint32_t));
    std::memcpy(bytes.data(), words_.data(), bytes.size());
    return bytes;
  }

 private:
  std::vector<std::uint32_t> words_;
};

}  // namespace

RowPyramid::RowPyramid(std::size_t width) : width_(width), file_(open_temporary_file()) {}

void RowPyramid::merge(std::vector<std::int32_t>& block, std::span<const std::int32_t> row) const {
  for (std::size_t i = 0; i < width_; ++i) {
    std::int32_t& minimum = block[width_ + i];
    std::int32_t& maximum = block[2 * width_ + i];
    if (row[i] != host::no_value) {
      minimum = minimum == host::no_value ? row[i] : std::min(minimum, row[i]);
      maximum = std::max(maximum, row[i]);  // no_value is below all values
    }
  }
}

void RowPyramid::add(std::span<const std::int32_t> row) {
  for (std::size_t level = 0; level < block_rows.size(); ++level) {
    std::vector<std::int32_t>& block = last_[level];
    if (rows_ % block_rows[level] == 0) {
      block.clear();
      for (int part = 0; part < 3; ++part) {
        block.insert(block.end(), row.begin(), row.end());
      }
    } else {
      merge(block, row);
    }
    if ((rows_ + 1) % block_rows[level] == 0) {
      write_at(::fileno(file_.get()), block, place(level, rows_ / block_rows[level]) * block_size());
    }
  }
  ++rows_;
}

std::vector<std::int32_t> RowPyramid::blocks(std::uint32_t stride, std::uint64_t first, std::uint64_t count) const {
  const auto found = std::ranges::find(block_rows, stride);
  const std::uint64_t known = (rows_ + stride - 1) / stride;
  if (found == block_rows.end() || first > known || count > known - first) {
    throw std::invalid_argument("found other blocks, expected blocks that the pyramid has");
  }
  const auto level = static_cast<std::size_t>(found - block_rows.begin());
  const std::uint64_t complete = rows_ / stride;
  std::vector<std::int32_t> values(count * block_size());
  for (std::uint64_t block = first; block < first + count;) {
    const std::span<std::int32_t> target = std::span(values).subspan((block - first) * block_size());
    if (block >= complete) {
      std::ranges::copy(last_[level], target.begin());
      break;
    }
    // Up to the end of the group they are together in the file.
    const std::uint64_t in_group = group_rows / stride;
    const std::uint64_t together = std::min({in_group - block % in_group, complete - block, first + count - block});
    read_at(::fileno(file_.get()), target.first(together * block_size()), place(level, block) * block_size());
    block += together;
  }
  return values;
}

RecordedRun::RecordedRun(std::filesystem::path path)
    : path_(std::move(path)),
      identity_(identity_of(path_)),
      finished_(open(path_)),
      scenario_(scenario_of(*finished_)),
      layout_(signals_of(scenario_)),
      pyramid_(layout_.row_size()) {
  note(*finished_);
  if (!finished_->finished()) {
    finished_.reset();
  }
}

std::optional<RecordedRun::Identity> RecordedRun::identity_of(const std::filesystem::path& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) {
    return std::nullopt;
  }
  return Identity{status.st_dev, status.st_ino};
}

bool RecordedRun::is_current() const { return identity_of(path_) == identity_; }

void RecordedRun::note(const sim::Recording& recording) {
  tick_period_us_ = recording.tick_period_us();
  first_tick_ = recording.first_tick();
  last_tick_ = recording.last_tick();
}

template <typename Use>
auto RecordedRun::with_recording(const Use& use) {
  if (finished_ == nullptr) {
    std::unique_ptr<sim::Recording> recording = open(path_);
    note(*recording);
    if (!recording->finished()) {
      return use(*recording);
    }
    finished_ = std::move(recording);
  }
  return use(*finished_);
}

void RecordedRun::read_ticks(std::uint32_t first, std::uint32_t last,
                             const std::function<void(const sim::RecordedTick&)>& use) {
  with_recording([&](const sim::Recording& recording) { recording.read_ticks(first, last, use); });
}

std::optional<double> RecordedRun::head_way(std::uint32_t from, std::uint32_t to) {
  return with_recording([&](const sim::Recording& recording) -> std::optional<double> {
    const std::vector<sim::RobotMove> moves = recording.moves();
    // A move of a tick comes before it.
    const bool was_moved =
        std::ranges::any_of(moves, [&](const sim::RobotMove& move) { return move.tick > from && move.tick <= to; });
    if (was_moved || !has_path(recording)) {
      return std::nullopt;
    }
    Eigen::Vector3d start;
    Eigen::Vector3d end;
    recording.read_ticks(from, from, [&](const sim::RecordedTick& tick) { start = tick.link_poses[0].position; });
    recording.read_ticks(to, to, [&](const sim::RecordedTick& tick) { end = tick.link_poses[0].position; });
    return (end - start).head<2>().norm();
  });
}

std::vector<std::string> RecordedRun::joint_names() const {
  std::vector<std::string> names;
  for (const sim::Joint& joint : scenario_.robot.joints) {
    names.push_back(joint.name);
  }
  return names;
}

bool RecordedRun::has_world() {
  return with_recording([](const sim::Recording& recording) { return recording.has_world(); });
}

std::string RecordedRun::part_name(const sim::MotionDifference& difference) {
  return with_recording([&](const sim::Recording& recording) { return name_of(difference, recording); });
}

json RecordedRun::documents() {
  return with_recording([this](const sim::Recording& recording) {
    json document = recording_document(recording);
    document["indexed"] = pyramid_.rows();
    document["damage"] = damage_ ? json(*damage_) : json();
    return json{{"robot", robot_document(scenario_, "recording")},
                {"parameters", recorded_parameters_document(recording, scenario_)},
                {"telemetry", layout_.document(recording.tick_period_us())},
                {"recording", std::move(document)}};
  });
}

std::vector<std::size_t> RecordedRun::columns_of(const std::vector<std::string>& signals) const {
  if (signals.empty()) {
    throw InputError("signals", 0, "no name", "names of the recording's telemetry");
  }
  std::vector<std::size_t> columns;
  for (std::size_t i = 0; i < signals.size(); ++i) {
    const host::SignalColumns* const found = layout_.find(signals[i]);
    if (found == nullptr) {
      throw InputError("signals", 0, in_quotes(shortened(signals[i])), "a name of the recording's telemetry");
    }
    // The size of a row has a bound only if no signal is in it twice.
    if (std::find(signals.begin(), signals.begin() + static_cast<std::ptrdiff_t>(i), signals[i]) !=
        signals.begin() + static_cast<std::ptrdiff_t>(i)) {
      throw InputError("signals", 0, in_quotes(signals[i]) + " twice", "different names");
    }
    for (std::size_t value = 0; value < found->count; ++value) {
      columns.push_back(found->offset + value);
    }
  }
  return columns;
}

std::vector<std::uint8_t> RecordedRun::rows(const Request& request) {
  if (request.points < 1 || request.points > max_points) {
    throw InputError("points", 0, std::to_string(request.points), "1 to " + std::to_string(max_points));
  }
  const std::vector<std::size_t> columns = columns_of(request.signals);
  return with_recording([&](const sim::Recording& recording) {
    const std::uint64_t row_bytes = columns.size() * sizeof(std::int32_t);
    const std::uint64_t points = std::min<std::uint64_t>(request.points, max_bytes / (block_parts * row_bytes));
    const std::uint32_t from = std::max(request.from, first_tick_);
    const std::uint32_t to = std::min(request.to, last_tick_);
    if (from > to) {
      return Rows(from, 1, last_tick_).bytes();
    }
    const std::uint64_t ticks = std::uint64_t{to} - from + 1;
    if (ticks <= points) {
      Rows rows(from, 1, last_tick_);
      recording.read_ticks(from, to, [&](const sim::RecordedTick& tick) {
        fill_row(tick, scenario_, row_);
        rows.add(row_, columns);
        rows.count(1);
      });
      return rows.bytes();
    }
    const auto level = std::ranges::find_if(
        RowPyramid::block_rows, [&](std::uint32_t stride) { return (ticks + stride - 1) / stride <= points; });
    const std::uint32_t stride = level == RowPyramid::block_rows.end() ? RowPyramid::block_rows.back() : *level;
    const std::uint64_t first = (from - first_tick_) / stride;
    const std::uint64_t known = (pyramid_.rows() + stride - 1) / stride;
    const std::uint64_t wanted = std::uint64_t{to - first_tick_} / stride + 1;
    const std::uint64_t end = std::min({wanted, known, first + points});
    Rows rows(first_tick_ + static_cast<std::uint32_t>(first) * stride, stride, last_tick_);
    if (first < end) {
      const std::vector<std::int32_t> blocks = pyramid_.blocks(stride, first, end - first);
      const std::span<const std::int32_t> all(blocks);
      for (std::size_t begin = 0; begin < all.size(); begin += layout_.row_size()) {
        rows.add(all.subspan(begin, layout_.row_size()), columns);
      }
      rows.count(static_cast<std::uint32_t>(end - first));
    }
    return rows.bytes();
  });
}

bool RecordedRun::index_some() {
  if (damage_) {
    return false;
  }
  const auto has_all = [this] { return pyramid_.rows() > last_tick_ - first_tick_; };
  if (has_all()) {
    return false;
  }
  with_recording([this](const sim::Recording& recording) {
    const auto next = static_cast<std::uint32_t>(first_tick_ + pyramid_.rows());
    recording.read_ticks(next, next + std::min(slice_ticks - 1, last_tick_ - next),
                         [this](const sim::RecordedTick& tick) {
                           fill_row(tick, scenario_, row_);
                           pyramid_.add(row_);
                         });
  });
  return !has_all();
}

}  // namespace proleg::tools
