#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace proleg::sim {

/// A place in a picture, in pixels, y downwards.
struct Point {
  double x = 0.0;
  double y = 0.0;
};

/// A line, or values over something, e.g. time.
using Polyline = std::vector<Point>;

enum class TextAnchor { start, middle, end };

/// Writes an SVG picture: shapes with presentation attributes, in the order in which they are painted. Coordinates must
/// be finite; they are written with two decimals, independent of the locale.
class Svg {
 public:
  /// description: for those who cannot see the picture.
  Svg(double width, double height, std::string_view title, std::string_view description);

  /// style: further attributes, e.g. R"(stroke="#333" stroke-width="1")".
  void line(Point from, Point to, std::string_view style);
  void polyline(std::span<const Point> points, std::string_view style);
  void polygon(std::span<const Point> corners, std::string_view style);
  void rectangle(Point corner, double width, double height, std::string_view style);
  void circle(Point center, double radius, std::string_view style);
  /// Draws a mark at many places, as one shape of few bytes. mark: path commands relative to the place, e.g. "h0" for
  /// a dot (with round line ends) or "m-2 -2l4 4m0 -4l-4 4" for a cross.
  void marks(std::span<const Point> places, std::string_view mark, std::string_view style);
  void text(Point position, std::string_view text, TextAnchor anchor, double size, std::string_view colour,
            std::string_view style = {});

  /// What is drawn between the two has this class.
  void begin_group(std::string_view name);
  void end_group();

  /// The picture.
  [[nodiscard]] std::string finish();

 private:
  std::string picture_;
};

/// Text as it must be written in XML. What XML cannot hold (control characters, bytes that are not UTF-8) becomes '?'.
[[nodiscard]] std::string xml_text(std::string_view text);

/// The number with at most `decimals` decimals, without trailing zeros.
[[nodiscard]] std::string plain_number(double value, int decimals);

}  // namespace proleg::sim
