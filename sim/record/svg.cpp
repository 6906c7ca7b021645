#include "sim/record/svg.hpp"

#include <array>
#include <charconv>

#include "shared/computer/text/text.hpp"

namespace proleg::sim {
namespace {

std::string coordinate(double value) { return plain_number(value, 2); }

std::string attribute(std::string_view name, double value) {
  return " " + std::string(name) + "=\"" + coordinate(value) + "\"";
}

std::string_view anchor_name(TextAnchor anchor) {
  switch (anchor) {
    case TextAnchor::start:
      return "start";
    case TextAnchor::middle:
      return "middle";
    case TextAnchor::end:
      break;
  }
  return "end";
}

/// Bytes of the UTF-8 character at the start of `text`; 0 if there is none that XML allows.
std::size_t xml_character_size(std::string_view text) {
  const std::string_view character = text.substr(0, utf8_character_size(text));
  const bool is_noncharacter = character == "\xEF\xBF\xBE" || character == "\xEF\xBF\xBF";  // U+FFFE, U+FFFF
  return is_noncharacter ? 0 : character.size();
}

}  // namespace

std::string plain_number(double value, int decimals) {
  std::array<char, 400> digits;  // the longest double has 309 digits before the point
  const auto end =
      std::to_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::fixed, decimals).ptr;
  std::string text(digits.data(), end);
  if (text.find('.') != std::string::npos) {
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') {
      text.pop_back();
    }
  }
  return text == "-0" ? "0" : text;
}

std::string xml_text(std::string_view text) {
  std::string escaped;
  while (!text.empty()) {
    const std::size_t length = xml_character_size(text);
    const char c = text.front();
    if (length == 0 || static_cast<unsigned char>(c) < ' ' || c == 0x7F) {
      escaped += '?';
    } else if (c == '<') {
      escaped += "&lt;";
    } else if (c == '>') {
      escaped += "&gt;";
    } else if (c == '&') {
      escaped += "&amp;";
    } else if (c == '"') {
      escaped += "&quot;";
    } else {
      escaped += text.substr(0, length);
    }
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return escaped;
}

Svg::Svg(double width, double height, std::string_view title, std::string_view description) {
  picture_ =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\"" +
      attribute("width", width) + attribute("height", height) + " viewBox=\"0 0 " + coordinate(width) + " " +
      coordinate(height) +
      "\" role=\"img\" font-family=\"Helvetica, Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif\">\n<title>" +
      xml_text(title) + "</title>\n<desc>" + xml_text(description) + "</desc>\n";
  rectangle({0, 0}, width, height, "fill=\"#ffffff\"");
}

void Svg::line(Point from, Point to, std::string_view style) {
  picture_ += "<line" + attribute("x1", from.x) + attribute("y1", from.y) + attribute("x2", to.x) +
              attribute("y2", to.y) + " " + std::string(style) + "/>\n";
}

void Svg::polyline(std::span<const Point> points, std::string_view style) {
  picture_ += "<polyline points=\"";
  for (const Point& point : points) {
    picture_ += coordinate(point.x) + "," + coordinate(point.y) + " ";
  }
  picture_ += "\" fill=\"none\" " + std::string(style) + "/>\n";
}

void Svg::polygon(std::span<const Point> corners, std::string_view style) {
  picture_ += "<polygon points=\"";
  for (const Point& corner : corners) {
    picture_ += coordinate(corner.x) + "," + coordinate(corner.y) + " ";
  }
  picture_ += "\" " + std::string(style) + "/>\n";
}

void Svg::rectangle(Point corner, double width, double height, std::string_view style) {
  picture_ += "<rect" + attribute("x", corner.x) + attribute("y", corner.y) + attribute("width", width) +
              attribute("height", height) + " " + std::string(style) + "/>\n";
}

void Svg::circle(Point center, double radius, std::string_view style) {
  picture_ += "<circle" + attribute("cx", center.x) + attribute("cy", center.y) + attribute("r", radius) + " " +
              std::string(style) + "/>\n";
}

void Svg::marks(std::span<const Point> places, std::string_view mark, std::string_view style) {
  if (places.empty()) {
    return;
  }
  picture_ += "<path d=\"";
  for (const Point& place : places) {
    picture_ += "M" + plain_number(place.x, 1) + " " + plain_number(place.y, 1) + std::string(mark);
  }
  picture_ += "\" fill=\"none\" " + std::string(style) + "/>\n";
}

void Svg::text(Point position, std::string_view text, TextAnchor anchor, double size, std::string_view colour,
               std::string_view style) {
  picture_ += "<text" + attribute("x", position.x) + attribute("y", position.y) + attribute("font-size", size) +
              " text-anchor=\"" + std::string(anchor_name(anchor)) + "\" fill=\"" + std::string(colour) + "\" " +
              std::string(style) + ">" + xml_text(text) + "</text>\n";
}

void Svg::begin_group(std::string_view name) { picture_ += "<g class=\"" + xml_text(name) + "\">\n"; }

void Svg::end_group() { picture_ += "</g>\n"; }

std::string Svg::finish() { return picture_ + "</svg>\n"; }

}  // namespace proleg::sim
