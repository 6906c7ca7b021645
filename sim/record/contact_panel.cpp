#include "sim/record/contact_panel.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "shared/computer/text/text.hpp"
#include "sim/record/figure_page.hpp"

namespace proleg::sim {
namespace {

double contact_row_height(std::size_t links) {
  constexpr double max_panel_height = 320.0;
  return std::min(22.0, max_panel_height / static_cast<double>(links));
}

}  // namespace

double contact_panel_height(const Recording& recording) {
  const std::size_t links = recording.links().size();
  return contact_row_height(links) * static_cast<double>(links);
}

void draw_contact_panel(Svg& svg, const Recording& recording, const FigureContents& contents, double panel_top,
                        const Axis& time) {
  const std::size_t links = recording.links().size();
  const double row = contact_row_height(links);
  draw_heading(svg, panel_top, "Contacts with the ground");
  svg.text({page_right, panel_top - 12.0}, "in each row: front sensor above, rear sensor below", TextAnchor::end,
           label_size, faint_ink);
  const auto every = static_cast<std::size_t>(std::ceil(14.0 / row));
  for (std::size_t link = 0; link < links; ++link) {
    const double top = panel_top + row * static_cast<double>(link);
    if (link > 0) {
      svg.line({page_left, top}, {page_right, top}, grid_style);
    }
    if (link % every == 0) {
      svg.text({page_left - 8.0, top + row / 2.0 + 4.0}, shortened(recording.links()[link], 11), TextAnchor::end,
               label_size, ink);
    }
    const double bar = row * 0.36;
    for (unsigned sensor = 0; sensor < 2; ++sensor) {
      const double y = sensor == 1 ? top + row / 2.0 - bar - row * 0.03 : top + row / 2.0 + row * 0.03;
      for (const FigureContents::Press& press : contents.presses[link][sensor]) {
        const double x = time.pixel(press.from_s);
        svg.rectangle({x, y}, time.pixel(press.to_s) - x, bar,
                      sensor == 1 ? R"(class="contact" fill="#444444")" : R"(class="contact" fill="#8a8a8a")");
      }
    }
  }
  svg.rectangle({page_left, panel_top}, page_right - page_left, contact_panel_height(recording), frame_style);
}

}  // namespace proleg::sim
