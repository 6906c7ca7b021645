#include "sim/record/series.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"

namespace proleg::sim {
namespace {

constexpr std::size_t max_points = 1U << 16U;  // of a series; a multiple of four
constexpr std::string_view series_option = "--series";

/// The lowest and the highest of each four neighbours.
void keep_extremes(Polyline& points) {
  const auto lower = [](const Point& a, const Point& b) { return a.y < b.y; };
  Polyline kept;
  for (std::size_t i = 0; i + 4 <= points.size(); i += 4) {
    const auto begin = points.begin() + static_cast<std::ptrdiff_t>(i);
    const auto numbers_end = std::partition(begin, begin + 4, [](const Point& p) { return !std::isnan(p.y); });
    if (numbers_end == begin) {
      kept.push_back(*begin);
      continue;
    }
    const auto [low, high] = std::minmax_element(begin, numbers_end, lower);
    const auto [first, second] = low->x < high->x ? std::pair(*low, *high) : std::pair(*high, *low);
    kept.push_back(first);
    if (first.x != second.x) {
      kept.push_back(second);
    }
  }
  points = std::move(kept);
}

void keep_every_second(Polyline& points) {
  Polyline kept;
  for (std::size_t i = 0; i < points.size(); i += 2) {
    kept.push_back(points[i]);
  }
  points = std::move(kept);
}

/// Throws for a name that the table does not have. --series also takes the name that columns of several joints share.
[[noreturn]] void refuse_name(const std::string& option, const std::string& name,
                              const std::vector<std::string>& columns) {
  std::vector<std::string> known;
  for (const std::string& column : columns) {
    known.push_back(column);
    const std::size_t dot = column.find('.');
    if (dot != std::string::npos && option == series_option) {
      known.push_back(column.substr(0, dot));
    }
  }
  std::ranges::sort(known);
  known.erase(std::unique(known.begin(), known.end()), known.end());
  std::vector<std::string> similar;
  constexpr std::size_t max_hints = 3;
  std::vector<std::string> rest = known;
  while (similar.size() < max_hints) {
    const std::optional<std::string> next = most_similar(name, rest);
    if (!next) {
      break;
    }
    similar.push_back(*next);
    std::erase(rest, *next);
  }
  if (similar.empty() && option == series_option) {
    std::erase_if(known, [](const std::string& word) { return word.find('.') != std::string::npos; });
  }
  if (similar.empty()) {
    similar = known;
  }
  throw InputError(option, 0, in_quotes(name),
                   "columns of the table of 'proleg export', for example " + listed(similar));
}

/// Reads a table line by line.
class SeriesCollector {
 public:
  explicit SeriesCollector(const SeriesRequest& request) : request_(request) {}

  void take(std::string_view text) {
    while (!text.empty()) {
      const std::size_t end = text.find('\n');
      rest_ += text.substr(0, end);
      if (end == std::string_view::npos) {
        return;
      }
      take_line();
      rest_.clear();
      text.remove_prefix(end + 1);
    }
  }

  [[nodiscard]] SeriesSet finish() {
    if (rows_ < 2) {
      const auto& [from_s, to_s] = request_.window;
      const std::string found = rows_ == 0 ? "no row of the table" : "one row of the table";
      if (!from_s && !to_s) {
        throw InputError(request_.file, 0, found, "two or more; a line needs two points");
      }
      if (from_s && to_s && *from_s > *to_s) {
        throw InputError("--from and --to", 0, number_text(*from_s) + " s to " + number_text(*to_s) + " s",
                         "a window that ends after it begins");
      }
      throw InputError("--from and --to", 0, found, "a window with two or more");
    }
    return std::move(set_);
  }

 private:
  void take_line() {
    const std::vector<std::string_view> cells = cells_of(rest_);
    if (columns_.empty()) {
      read_header(cells);
      return;
    }
    const double time = number_in(cells, time_);
    if (!(time >= request_.window.from_s.value_or(-std::numeric_limits<double>::infinity()) &&
          time <= request_.window.to_s.value_or(std::numeric_limits<double>::infinity()))) {
      return;
    }
    set_.from_s = rows_ == 0 ? time : set_.from_s;
    set_.to_s = time;
    if (rows_++ % stride_ != 0) {
      return;
    }
    const double x = number_in(cells, x_);
    for (std::size_t i = 0; i < set_.series.size(); ++i) {
      set_.series[i].points.push_back({x, number_in(cells, columns_[i])});
    }
    for (Series& series : set_.series) {
      if (x_ == time_ && series.points.size() >= max_points) {
        keep_extremes(series.points);
      }
    }
    if (x_ != time_ && set_.series.front().points.size() >= max_points) {
      stride_ *= 2;
      for (Series& series : set_.series) {
        keep_every_second(series.points);
      }
    }
  }

  void read_header(const std::vector<std::string_view>& cells) {
    const std::vector<std::string> names(cells.begin(), cells.end());
    const auto position = [&](const std::string& option, const std::string& name) {
      const auto found = std::ranges::find(names, name);
      if (found == names.end()) {
        refuse_name(option, name, names);
      }
      return static_cast<std::size_t>(found - names.begin());
    };
    time_ = position("--x", "time_s");
    x_ = position("--x", request_.x);
    set_.x_name = request_.x;
    for (const std::string& list : request_.names) {
      add_columns(list, names);
    }
    if (columns_.size() > max_series) {
      throw InputError("--series", 0, std::to_string(columns_.size()) + " columns",
                       "at most " + std::to_string(max_series));
    }
    for (const std::size_t column : columns_) {
      set_.series.push_back({names[column], {}});
    }
  }

  void add_columns(const std::string& list, const std::vector<std::string>& names) {
    for (std::size_t begin = 0; begin <= list.size();) {
      std::size_t end = list.size();
      while (!add_column(trimmed(std::string_view(list).substr(begin, end - begin)), names)) {
        const std::size_t comma = std::string_view(list).substr(begin, end - begin).rfind(',');
        if (comma == std::string_view::npos) {
          const std::string first(trimmed(std::string_view(list).substr(begin, end - begin)));
          if (first.empty()) {
            throw InputError(std::string(series_option), 0, in_quotes(list),
                             "names of columns with commas between them");
          }
          refuse_name(std::string(series_option), first, names);
        }
        end = begin + comma;
      }
      begin = end + 1;
    }
  }

  /// Adds the columns with this name. Returns whether there is one.
  bool add_column(std::string_view name, const std::vector<std::string>& names) {
    bool is_known = false;
    for (std::size_t i = 0; i < names.size(); ++i) {
      const bool is_named = names[i] == name || names[i].starts_with(std::string(name) + ".");
      is_known = is_known || is_named;
      if (is_named && std::ranges::find(columns_, i) == columns_.end()) {
        columns_.push_back(i);
      }
    }
    return is_known;
  }

  [[nodiscard]] static double number_in(const std::vector<std::string_view>& cells, std::size_t column) {
    return column < cells.size() ? parse_number(cells[column]).value_or(std::numeric_limits<double>::quiet_NaN())
                                 : std::numeric_limits<double>::quiet_NaN();
  }

  const SeriesRequest& request_;
  std::string rest_;
  std::vector<std::size_t> columns_;
  std::size_t time_ = 0;
  std::size_t x_ = 0;
  std::uint64_t rows_ = 0;
  std::uint64_t stride_ = 1;
  SeriesSet set_;
};

}  // namespace

SeriesSet collect_series(const WriteTable& table, const SeriesRequest& request) {
  SeriesCollector collector(request);
  table([&](std::string_view text) { collector.take(text); });
  return collector.finish();
}

}  // namespace proleg::sim
