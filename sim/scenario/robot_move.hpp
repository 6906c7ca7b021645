#pragma once

#include <string>

#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// Adds a word of --move, X,Y,Z,DEGREES@TICK, behind the moves of its tick. Throws InputError with the option as its
/// file.
void add_move(Scenario& scenario, const std::string& word);

/// The same move as a word.
[[nodiscard]] std::string move_text(const RobotMove& move);

}  // namespace proleg::sim
