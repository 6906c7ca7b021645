#include "sim/scenario/robot_move.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include "shared/computer/errors/input_error.hpp"
#include "shared/computer/text/text.hpp"
#include "sim/scenario/settings.hpp"
#include "sim/scenario/values.hpp"

namespace proleg::sim {
namespace {

[[noreturn]] void refuse(const std::string& word) {
  throw InputError("--move", 0, in_quotes(word),
                   "X,Y,Z,DEGREES@TICK: metres from " + number_text(coordinates.min) + " to " +
                       number_text(coordinates.max) + ", degrees from " + number_text(turns.min) + " to " +
                       number_text(turns.max));
}

}  // namespace

RobotMove parse_move(const std::string& word, std::uint32_t tick_period_us) {
  const std::size_t at = word.find('@');
  if (at == std::string::npos) {
    refuse(word);
  }
  std::array<double, 4> numbers{};
  std::string_view rest = std::string_view(word).substr(0, at);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const bool is_last = i + 1 == numbers.size();
    const std::size_t comma = rest.find(',');
    const std::optional<double> number = parse_number_in(rest.substr(0, comma), is_last ? turns : coordinates);
    if (!number || is_last != (comma == std::string_view::npos)) {
      refuse(word);
    }
    numbers[i] = *number;
    rest.remove_prefix(is_last ? rest.size() : comma + 1);
  }
  return {read_tick(word, word.substr(at + 1), tick_period_us), {numbers[0], numbers[1], numbers[2]}, numbers[3]};
}

void add_move(Scenario& scenario, const std::string& word) {
  const RobotMove move = parse_move(word, scenario.kernel.tick_period_us);
  scenario.moves.insert(std::ranges::upper_bound(scenario.moves, move.tick, {}, &RobotMove::tick), move);
}

std::string move_text(const RobotMove& move) {
  return exact_text(move.position.x()) + ',' + exact_text(move.position.y()) + ',' + exact_text(move.position.z()) +
         ',' + exact_text(move.turn_deg) + '@' + std::to_string(move.tick);
}

}  // namespace proleg::sim
