#pragma once

#include <cstdint>
#include <string>

#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// Reads a word of --move, X,Y,Z,DEGREES@TICK. Throws InputError with the option as its file.
[[nodiscard]] RobotMove parse_move(const std::string& word, std::uint32_t tick_period_us);

/// Adds a word of --move behind the moves of its tick. Throws as parse_move() does.
void add_move(Scenario& scenario, const std::string& word);

/// The word of --move that parse_move() reads as this move.
[[nodiscard]] std::string move_text(const RobotMove& move);

}  // namespace proleg::sim
