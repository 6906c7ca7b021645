#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "shared/can/slcan.hpp"

namespace proleg::host {

/// Assembles the characters of an slcan adapter to lines, and reads frames from them. Adapters differ: lines end with
/// CR, CR LF or LF; some confirm a frame with z and no end of a line; some append digits to a frame that the host did
/// not ask for.
class SlcanAdapterLines {
 public:
  enum class Event : std::uint8_t {
    none,      ///< the line is not complete
    line,      ///< line() is complete; it may be empty
    rejected,  ///< BEL was received after the characters of line(); mostly there are none
  };

  [[nodiscard]] Event push(char character);
  /// The line that was received; valid after `line` and `rejected`, until the next push().
  [[nodiscard]] std::string_view line() const { return line_; }
  /// A z at the begin of a line is a line from now on.
  void end_lines_after_z() { has_bare_z_ = true; }
  /// Begins with another connection.
  void reset() { *this = {}; }

  /// Reads a frame behind which an adapter may have appended hexadecimal digits: a time stamp (4 for milliseconds, 8
  /// for microseconds), before it 1 for the error state of the sender (ESI of CAN FD). An odd number is accepted if the
  /// last frame had it, too, or there was none: it can be the rest of a line that has lost characters.
  [[nodiscard]] std::optional<SlcanFrame> read_frame(std::string_view line);

 private:
  std::string line_;
  bool has_ended_ = false;
  bool has_ended_with_lf_ = false;
  bool has_bare_z_ = false;
  std::optional<std::size_t> last_appended_;  ///< number of digits behind the last frame
};

/// Whether a line begins with z or Z, with which adapters confirm a frame.
[[nodiscard]] bool begins_with_z(std::string_view line);

/// Text in quotes and shortened, in which characters that are not printable ASCII appear as \r, \a, \n or \xNN.
[[nodiscard]] std::string printable_bytes(std::string_view bytes);

}  // namespace proleg::host
