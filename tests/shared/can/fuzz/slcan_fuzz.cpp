// Any characters from a host. What the codec accepts it writes back identically, but for the case of digits and the
// order of error letters. The adapter writes whole lines only, in the order of the input, and never more than its
// buffer holds; a host that reads enough gets an answer to every line that is not empty.

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <string>
#include <vector>

#include "shared/can/slcan_adapter.hpp"
#include "tests/support/fuzz_input.hpp"

namespace {

using namespace proleg;
using test::FuzzInput;
using test::require;

std::string with_upper_digits(std::string_view line) {
  std::string text(line);
  std::transform(text.begin() + 1, text.end(), text.begin() + 1,
                 [](unsigned char character) { return static_cast<char>(std::toupper(character)); });
  return text;
}

void check_codec(std::string_view line) {
  if (const auto frame = parse_slcan_frame(line)) {
    require(format_slcan_frame(*frame).view() == with_upper_digits(line), "a frame is written as it was read");
  }
  if (const auto status = parse_slcan_status(line)) {
    require(format_slcan_status(*status).view() == line, "a state is written as it was read");
  }
  if (const auto errors = parse_slcan_errors(line)) {
    require(parse_slcan_errors(format_slcan_errors(*errors).view()) == errors, "errors are read as they were written");
  }
}

class Bus final : public CanPort {
 public:
  [[nodiscard]] bool send(const CanFrame& frame) override {
    require(frame.identifier <= CanFrame::max_identifier && frame.length <= CanFrame::max_length, "frames are valid");
    require(std::all_of(frame.data.begin() + frame.length, frame.data.end(), [](auto byte) { return byte == 0; }),
            "unused bytes are 0");
    ++frames;
    return frames % 5 != 0;
  }

  unsigned frames = 0;
};

void check_output_line(std::string_view line, char end) {
  if (end == slcan_reject) {
    require(line.empty(), "BEL stands alone");
    return;
  }
  const bool is_known = line.empty() || line == "z" || (line[0] == 't' && parse_slcan_frame(line)) ||
                        (line[0] == 's' && parse_slcan_status(line)) || (line[0] == 'e' && parse_slcan_errors(line)) ||
                        (line[0] == 'F' && line.size() == 3) || (line[0] == 'V' && line.size() == 5) ||
                        (line[0] == 'N' && line.size() == 5);
  require(is_known, "the output has whole lines");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  FuzzInput input({data, size});
  std::vector<char> buffer(SlcanAdapter::min_buffer + input.byte());
  const std::uint8_t pattern = input.byte();
  Bus bus;
  SlcanAdapter adapter(buffer, bus, {0x1010, {'1', '2', '3', '4'}, static_cast<std::uint8_t>(pattern % 4U)});
  SlcanLineReader lines;
  SlcanLineReader output_lines;
  std::string output;
  Microseconds now = 0;
  unsigned answers_due = 0;
  while (!input.empty()) {
    const char character = static_cast<char>(input.byte());
    const auto event = lines.push(character);
    if (event == SlcanLineReader::Event::line || event == SlcanLineReader::Event::rejected) {
      check_codec(lines.line());
      answers_due += lines.line().empty() ? 0U : 1U;
    } else if (event == SlcanLineReader::Event::too_long) {
      ++answers_due;
    }
    adapter.input({&character, 1});
    now += 777;
    const auto identifier = static_cast<std::uint16_t>(0x080U + now % 0x280U);
    adapter.received(now, {identifier, static_cast<std::uint8_t>(now % 9U), {}});
    adapter.status_changed({static_cast<CanState>(now / 5'000 % 4U), 0, static_cast<std::uint16_t>(now % 1'100U)});
    if ((pattern & 1U) != 0 || now % 7U == 0) {
      std::vector<char> taken(1U + now % 100U);
      output.append(taken.data(), adapter.take(taken));
    }
  }
  for (std::vector<char> rest(buffer.size()); adapter.has_output();) {
    output.append(rest.data(), adapter.take(rest));
  }
  const SlcanAdapter::Counters& counters = adapter.counters();
  unsigned answers = 0;
  unsigned frames = 0;
  for (const char character : output) {
    const auto event = output_lines.push(character);
    require(event != SlcanLineReader::Event::too_long, "lines are short");
    if (event != SlcanLineReader::Event::none) {
      const std::string_view line = output_lines.line();
      check_output_line(line, character);
      const bool is_frame = !line.empty() && line[0] == 't';
      const bool is_report = !line.empty() && (line[0] == 's' || line[0] == 'e');
      frames += is_frame ? 1U : 0U;
      answers += is_frame || is_report ? 0U : 1U;
    }
  }
  require(frames == counters.frames_received, "frames are counted");
  require(answers + counters.answers_dropped == answers_due, "every line is answered");
  return 0;
}
