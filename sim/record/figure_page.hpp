#pragma once

// What the panels of a figure share.

#include <array>
#include <string_view>

#include "sim/record/svg.hpp"

namespace proleg::sim {

// Page, in pixels.
inline constexpr double page_width = 900.0;
inline constexpr double page_left = 104.0;
inline constexpr double page_right = 820.0;

inline constexpr double first_panel_top = 104.0;  ///< below title, subtitle and legend

inline constexpr double label_size = 12.0;
inline constexpr double heading_size = 13.5;
inline constexpr const char* ink = "#222222";
inline constexpr const char* faint_ink = "#555555";
inline constexpr const char* grid_style = R"(stroke="#e2e2e2" stroke-width="1")";
inline constexpr const char* frame_style = R"(fill="none" stroke="#777777" stroke-width="1")";

/// Colours that people with any colour vision can distinguish (M. Okabe, K. Ito, 2008; without the yellow, which is too
/// faint on white).
inline constexpr std::array<const char*, 7> distinct_colours{"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                             "#e69f00", "#56b4e9", "#000000"};

/// At the head of the page. The subtitle leaves room for another text at the right edge, at the height subtitle_y.
inline constexpr double subtitle_y = 58.0;
inline void draw_title(Svg& svg, std::string_view title, std::string_view subtitle) {
  svg.text({page_left, 36.0}, title, TextAnchor::start, 20.0, ink, R"(font-weight="bold")");
  svg.text({page_left, subtitle_y}, subtitle, TextAnchor::start, label_size, faint_ink);
}

inline void draw_heading(Svg& svg, double panel_top, std::string_view text) {
  svg.text({page_left, panel_top - 12.0}, text, TextAnchor::start, heading_size, ink, R"(font-weight="bold")");
}

}  // namespace proleg::sim
