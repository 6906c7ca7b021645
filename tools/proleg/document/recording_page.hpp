#pragma once

// A page that plays a recording in a browser, in one file.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

#include "sim/record/recording.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::tools {

/// The page that tools/page builds for recordings (host/page/source/player). It shows nothing without a recording.
class PlayerPage {
 public:
  /// The text at the begin of all files that write_html() writes.
  static constexpr std::string_view first_text = "<!doctype html>\n<!-- A recording of Proleg";

  /// Reads the file. Throws BadInput if it is missing, or is no player.
  explicit PlayerPage(const std::filesystem::path& file);

  [[nodiscard]] std::string_view before_recording() const { return std::string_view(text_).substr(0, place_); }
  [[nodiscard]] std::string_view after_recording() const;

 private:
  std::string text_;
  std::size_t place_ = 0;  ///< position of the recording in the text
};

/// Writes the page with the recording in it (docs/page-interface.md, The file of a recording). scenario: scenario_of()
/// the recording. after_tick: called after each tick. It needs memory for some thousand ticks, independently of the
/// recording's length.
void write_html(const sim::Recording& recording, const sim::Scenario& scenario, const PlayerPage& player,
                const std::function<void(std::string_view)>& write,
                const std::function<void(std::uint32_t tick)>& after_tick);

}  // namespace proleg::tools
