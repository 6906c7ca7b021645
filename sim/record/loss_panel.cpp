#include "sim/record/loss_panel.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "shared/gait/registry.hpp"
#include "sim/record/figure_page.hpp"

namespace proleg::sim {
namespace {

/// A joint on which two slots broadcast sends two frames in a tick, any other joint one. All other joints receive them.
double receptions_in_a_tick(const Recording& recording) {
  const std::size_t joints = recording.joints().size();
  std::size_t frames = 0;
  for (std::size_t joint = 0; joint < joints; ++joint) {
    std::size_t broadcasts = 0;
    for (const RecordedSlot& slot : recording.slots()) {
      const ActuationModule* const algorithm = find_algorithm(slot.algorithm);
      broadcasts +=
          algorithm != nullptr && !algorithm->declaration().frame.empty() && slot.joint_group[joint] ? 1U : 0U;
    }
    frames += std::max<std::size_t>(broadcasts, 1);
  }
  return static_cast<double>(frames * (joints - 1));
}

std::string percent(double share, int decimals) { return plain_number(100.0 * share, decimals) + " %"; }

}  // namespace

LossShares collect_loss_shares(const Recording& recording, const Disturbances& disturbances, const Axis& time) {
  constexpr double bar_width = 6.0;  // pixels, at least
  const double tick_s = recording.tick_period_us() / 1e6;
  const auto tick_at = [&](double seconds) {
    return static_cast<std::uint32_t>(std::max(std::ceil(seconds / tick_s - 1e-6), 0.0));
  };
  const std::uint32_t first = tick_at(time.low);
  const std::uint32_t end = std::max(tick_at(time.high), first + 1);
  const double pixels_of_tick = time.pixel(time.low + tick_s) - time.pixel(time.low);
  const double receptions = receptions_in_a_tick(recording);

  LossShares shares;
  shares.ticks_of_bar = static_cast<std::uint32_t>(std::max(std::ceil(bar_width / pixels_of_tick - 1e-6), 1.0));
  std::vector<double> lost((end - first + shares.ticks_of_bar - 1) / shares.ticks_of_bar);
  double all = 0.0;
  for (const Disturbances::TickLosses& losses : disturbances.lost_in_ticks) {
    if (losses.tick >= first && losses.tick < end) {
      lost[(losses.tick - first) / shares.ticks_of_bar] += losses.frames;
      all += losses.frames;
    }
  }
  shares.share = all / (receptions * (end - first));
  for (std::uint32_t bar = 0; bar < lost.size(); ++bar) {
    const std::uint32_t from = first + bar * shares.ticks_of_bar;
    const std::uint32_t to = std::min(from + shares.ticks_of_bar, end);
    if (lost[bar] > 0.0) {
      shares.bars.push_back({from, to, std::min(lost[bar] / (receptions * (to - from)), 1.0)});
    }
  }
  return shares;
}

void draw_loss_panel(Svg& svg, const Recording& recording, const Disturbances& disturbances, double top,
                     const Axis& time) {
  const LossShares shares = collect_loss_shares(recording, disturbances, time);
  double highest = 0.01;
  for (const LossShares::Bar& bar : shares.bars) {
    highest = std::max(highest, bar.share);
  }
  const Axis height{0.0, std::min(nice_step(highest), 1.0), top + loss_panel_height, top};
  draw_heading(svg, top, "State frames lost (%)");
  svg.text({page_right, top - 12.0},
           percent(shares.share, 1) + " in this window; each bar: " +
               plain_number(shares.ticks_of_bar * recording.tick_period_us() / 1e3, 3) + " ms",
           TextAnchor::end, label_size, faint_ink);
  for (const double share : {height.low, height.high}) {
    svg.text({page_left - 8.0, height.pixel(share) + 4.0}, plain_number(100.0 * share, 1), TextAnchor::end, label_size,
             ink);
  }
  svg.begin_group("loss");
  for (const LossShares::Bar& bar : shares.bars) {
    const double left = time.pixel(std::max(recording.sync_time_s(bar.first_tick), time.low));
    const double right = time.pixel(std::min(recording.sync_time_s(bar.end_tick), time.high));
    const double y = height.pixel(bar.share);
    svg.rectangle({left, y}, std::max(right - left, 0.5), height.pixel_low - y, R"(fill="#d55e00")");
  }
  svg.end_group();
  svg.rectangle({page_left, top}, page_right - page_left, loss_panel_height, frame_style);
}

}  // namespace proleg::sim
