#pragma once

// The damages that a robot may have before its first trial, and what the gaits of an atlas do with them.

#include <filesystem>
#include <string>
#include <vector>

#include "sim/optimize/adaptation/atlas.hpp"
#include "sim/optimize/adaptation/damage_scores.hpp"

namespace proleg::tools {

/// The usual damages of the atlas's robot, and those that the user names; "none": without the usual ones. A map that a
/// robot has filled cannot be simulated: it has no usual ones. named: words of --suspect. Throws InputError.
[[nodiscard]] std::vector<std::string> suspected_damages(const std::vector<std::string>& named,
                                                         const optimize::Atlas& atlas);

/// The scores of the gaits with these damages. Takes them from a file in the folder of the atlas, simulates what that
/// does not have, with progress on standard error, and keeps it there for the next time. Throws SearchEnded when the
/// user stops it.
[[nodiscard]] optimize::DamageScores scores_with(const optimize::Atlas& atlas, const std::filesystem::path& folder,
                                                 const std::vector<std::string>& suspects);

}  // namespace proleg::tools
