#include "tools/proleg/document/recording_page.hpp"

#include <fstream>
#include <nlohmann/json.hpp>
#include <span>
#include <sstream>
#include <vector>

#include "shared/computer/deflate/deflate.hpp"
#include "tools/proleg/common/command_line.hpp"
#include "tools/proleg/document/recording_document.hpp"
#include "tools/proleg/document/robot_document.hpp"
#include "tools/proleg/document/telemetry_row.hpp"

namespace proleg::tools {
namespace {

using nlohmann::json;

/// Some ticks of a recording in the form of the player (docs/page-interface.md, The file of a recording): columns of
/// differences, which compress well.
class ColumnBlock {
 public:
  static constexpr std::size_t max_rows = 4096;

  explicit ColumnBlock(std::size_t columns) : columns_(columns) {}

  /// Adds a row; the block must not be full.
  void add(std::span<const std::int32_t> row);
  [[nodiscard]] bool is_empty() const { return rows_ == 0; }
  [[nodiscard]] bool is_full() const { return rows_ == max_rows; }
  /// Takes the rows as text, in base64, and empties the block.
  [[nodiscard]] std::string take();

 private:
  std::size_t columns_;
  std::size_t rows_ = 0;
  std::vector<std::int32_t> values_;  ///< values row by row
};

void ColumnBlock::add(std::span<const std::int32_t> row) {
  values_.insert(values_.end(), row.begin(), row.end());
  ++rows_;
}

std::string ColumnBlock::take() {
  std::string bytes;
  bytes.reserve(values_.size() * sizeof(std::int32_t));
  for (std::size_t column = 0; column < columns_; ++column) {
    std::uint32_t before = 0;
    for (std::size_t row = 0; row < rows_; ++row) {
      const auto value = static_cast<std::uint32_t>(values_[row * columns_ + column]);
      const std::uint32_t difference = value - before;
      before = value;
      for (unsigned shift = 0; shift < 32; shift += 8) {
        bytes += static_cast<char>(difference >> shift & 0xFFU);
      }
    }
  }
  rows_ = 0;
  values_.clear();
  return base64(deflate(bytes));
}

constexpr std::string_view place_mark = "<!-- the recording -->";

/// JSON as the text of an HTML element. Names come from files of other people: a text without "<" cannot end the
/// element.
std::string element_text(const json& document) {
  std::string text;
  for (const char character : document.dump(-1, ' ', true, json::error_handler_t::replace)) {
    if (character == '<') {
      text += "\\u003c";
    } else {
      text += character;
    }
  }
  return text;
}

json documents_of(const sim::Recording& recording, const sim::Scenario& scenario, const host::SignalLayout& layout) {
  return {{"block_rows", ColumnBlock::max_rows},
          {"robot", robot_document(scenario, "recording")},
          {"parameters", recorded_parameters_document(recording, scenario)},
          {"telemetry", layout.document(recording.tick_period_us())},
          {"recording", recording_document(recording)}};
}

}  // namespace

PlayerPage::PlayerPage(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  text_ = text.str();
  place_ = text_.find(place_mark);
  if (!stream || !text_.starts_with(first_text) || place_ == std::string::npos) {
    throw BadInput("found no player in " + file.string() + ", expected one that tools/page has built");
  }
}

std::string_view PlayerPage::after_recording() const {
  return std::string_view(text_).substr(place_ + place_mark.size());
}

void write_html(const sim::Recording& recording, const sim::Scenario& scenario, const PlayerPage& player,
                const std::function<void(std::string_view)>& write,
                const std::function<void(std::uint32_t tick)>& after_tick) {
  const host::SignalLayout layout(signals_of(scenario));
  write(player.before_recording());
  write("<script type=\"application/json\" id=\"documents\">");
  write(element_text(documents_of(recording, scenario, layout)));
  write("</script>\n");
  ColumnBlock block(layout.row_size());
  const auto write_block = [&] {
    write("<script type=\"text/plain\" class=\"ticks\">");
    write(block.take());
    write("</script>\n");
  };
  std::vector<std::int32_t> row;
  recording.read_ticks(recording.first_tick(), recording.last_tick(), [&](const sim::RecordedTick& tick) {
    fill_row(tick, scenario, row);
    block.add(row);
    if (block.is_full()) {
      write_block();
    }
    after_tick(tick.tick);
  });
  if (!block.is_empty()) {
    write_block();
  }
  write(player.after_recording());
}

}  // namespace proleg::tools
