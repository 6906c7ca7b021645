#include "sim/record/plot_frame.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <set>
#include <utility>
#include <vector>

namespace proleg::sim {
namespace {

/// Shortest text with which neighbouring multiples of the step differ.
std::string tick_text(double value, double step) {
  const double max = 1e6;
  if (std::abs(value) < max && step > 1.0 / max) {
    return plain_number(value, 6);
  }
  // A multiple of the step, without what the last bits of the product add.
  std::array<char, 32> text;
  const double cleaned = std::abs(value) < step / 2.0 ? 0.0 : value;
  const int digits = cleaned == 0.0 ? 1 : 1 + static_cast<int>(std::log10(std::abs(cleaned) / step) + 1.0);
  const auto end = std::to_chars(text.data(), text.data() + text.size(), cleaned, std::chars_format::general,
                                 std::clamp(digits, 1, 15));
  return {text.data(), end.ptr};
}

double width_of(std::string_view text) {
  constexpr double character_width = 7.0;  // at the size of labels, in wide fonts
  const auto characters =
      std::ranges::count_if(text, [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; });
  return character_width * static_cast<double>(characters);
}

}  // namespace

double nice_step(double min) {
  const double decade = std::pow(10.0, std::floor(std::log10(min)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    // The tolerance lets 0.3 / 3 count as 0.1.
    if (factor * decade >= min * (1.0 - 1e-9)) {
      return factor * decade;
    }
  }
  return 10.0 * decade;
}

std::vector<double> multiples(double low, double high, double step) {
  const double tolerance = 1e-6;  // of a step: ends of the range that are multiples belong to it
  std::vector<double> values;
  for (double i = std::ceil(low / step - tolerance); i <= std::floor(high / step + tolerance); i += 1.0) {
    values.push_back(i * step);
  }
  return values;
}

std::vector<double> spread(std::vector<double> positions, double gap, double low, double high) {
  std::vector<std::size_t> order(positions.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return positions[a] < positions[b]; });
  double free_from = low;
  for (const std::size_t i : order) {
    positions[i] = std::max(positions[i], free_from);
    free_from = positions[i] + gap;
  }
  double free_to = high;
  for (auto i = order.rbegin(); i != order.rend(); ++i) {
    positions[*i] = std::min(positions[*i], free_to);
    free_to = positions[*i] - gap;
  }
  return positions;
}

Axis axis_over(double low, double high, double pixel_low, double pixel_high) {
  constexpr double bound = 1e12;
  low = std::clamp(low, -bound, bound);
  high = std::clamp(high, low, bound);
  const double size = std::max(std::abs(low), std::abs(high));
  if (high - low <= 1e-9 * size) {
    const double around = size == 0.0 ? 0.5 : 0.1 * size;
    return {low - around, high + around, pixel_low, pixel_high};
  }
  const double room = 0.04 * (high - low);
  return {low - room, high + room, pixel_low, pixel_high};
}

void draw_plot_grid(Svg& svg, const Axis& x, const Axis& y, std::string_view x_name, std::string_view y_name) {
  const double top = y.pixel_high;
  const double bottom = y.pixel_low;
  const double x_step = nice_step((x.high - x.low) / 10.0);
  for (const double value : multiples(x.low, x.high, x_step)) {
    const double at = x.pixel(value);
    svg.line({at, top}, {at, bottom}, grid_style);
    svg.line({at, bottom}, {at, bottom + 5.0}, R"(stroke="#777777")");
    svg.text({at, bottom + 19.0}, tick_text(value, x_step), TextAnchor::middle, label_size, ink);
  }
  const double y_step = nice_step((y.high - y.low) / std::max((bottom - top) / 34.0, 1.0));
  for (const double value : multiples(y.low, y.high, y_step)) {
    const double at = y.pixel(value);
    svg.line({x.pixel_low, at}, {x.pixel_high, at}, grid_style);
    svg.text({x.pixel_low - 8.0, at + 4.0}, tick_text(value, y_step), TextAnchor::end, label_size, ink);
  }
  svg.text({(x.pixel_low + x.pixel_high) / 2.0, bottom + 37.0}, x_name, TextAnchor::middle, label_size, ink);
  draw_heading(svg, top, y_name);
}

void draw_plot_frame(Svg& svg, const Axis& x, const Axis& y) {
  svg.rectangle({x.pixel_low, y.pixel_high}, x.pixel_high - x.pixel_low, y.pixel_low - y.pixel_high, frame_style);
}

Polyline to_pixels(const Polyline& trace, const Axis& x, const Axis& y) {
  Polyline pixels;
  Polyline column;
  const auto flush = [&] {
    if (column.size() <= 4) {
      pixels.insert(pixels.end(), column.begin(), column.end());
    } else {
      const auto lower = [](const Point& a, const Point& b) { return a.y < b.y; };
      auto [low, high] = std::minmax_element(column.begin() + 1, column.end() - 1, lower);
      if (high < low) {
        std::swap(low, high);
      }
      pixels.insert(pixels.end(), {column.front(), *low, *high, column.back()});
    }
    column.clear();
  };
  for (const Point& point : trace) {
    const Point pixel{x.pixel(std::clamp(point.x, x.low, x.high)), y.pixel(std::clamp(point.y, y.low, y.high))};
    if (!column.empty() && std::floor(pixel.x) != std::floor(column.front().x)) {
      flush();
    }
    column.push_back(pixel);
  }
  flush();
  return pixels;
}

Polyline to_marks(const Polyline& points, const Axis& x, const Axis& y, double size) {
  Polyline marks;
  std::set<std::pair<std::int32_t, std::int32_t>> taken;
  for (const Point& point : points) {
    const Point pixel{x.pixel(std::clamp(point.x, x.low, x.high)), y.pixel(std::clamp(point.y, y.low, y.high))};
    if (taken.emplace(static_cast<std::int32_t>(pixel.x / size), static_cast<std::int32_t>(pixel.y / size)).second) {
      marks.push_back(pixel);
    }
  }
  return marks;
}

void draw_line_names(Svg& svg, const Axis& y, double right, std::span<const LineName> names) {
  std::vector<double> ends;
  for (const LineName& name : names) {
    ends.push_back(y.pixel(std::clamp(name.value, y.low, y.high)));
  }
  const std::vector<double> places = spread(ends, 15.0, y.pixel_high + 4.0, y.pixel_low - 4.0);
  for (std::size_t i = 0; i < names.size(); ++i) {
    svg.line({right, ends[i]}, {right + 12.0, places[i]}, "stroke=\"" + names[i].colour + "\" stroke-width=\"1\"");
    svg.text({right + 15.0, places[i] + 4.0}, names[i].text, TextAnchor::start, label_size, names[i].colour,
             R"(font-weight="bold")");
  }
}

void draw_legend(Svg& svg, double right, double y, std::span<const LegendEntry> entries) {
  constexpr double line_width = 28.0;
  constexpr double mark_width = 8.0;
  constexpr double gap = 6.0;
  double end = right;
  for (auto entry = entries.rbegin(); entry != entries.rend(); ++entry) {
    const double text = end - width_of(entry->name);
    svg.text({text, y + 4.0}, entry->name, TextAnchor::start, label_size, ink);
    const double sample = text - gap - (entry->mark.empty() ? line_width : mark_width);
    if (entry->mark.empty()) {
      svg.line({sample, y}, {sample + line_width, y}, entry->style);
    } else {
      const Point place{sample + mark_width / 2.0, y};
      svg.marks({&place, 1}, entry->mark, entry->style);
    }
    end = sample - 2.0 * gap;
  }
}

}  // namespace proleg::sim
