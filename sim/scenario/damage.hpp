#pragma once

// What is wrong with a robot or its world, beside what its files say: for trials of a gait on a damaged robot.

#include <string>
#include <vector>

#include "sim/scenario/losses.hpp"
#include "sim/scenario/scenario.hpp"

namespace proleg::sim {

/// Damages a robot for a whole run:
///   jammed:JOINT[=DEGREES]   the joint stays at an angle, -90 to 90 (default 0), whatever its set-points are
///   torque:JOINT=PERCENT     its servo has this share of its torque, 1 to 100
///   powerless:JOINT          its servo gives no torque: the joint turns freely within its limits
///   lost:JOINT               its module is dead: powerless, and no joint receives its state frames
///   mass:LINK=PERCENT        share of mass and inertia of a link, 1 to 1000
///   friction=PERCENT         share of all coefficients of friction, 1 to 1000
/// Throws InputError with --damage as its file, also for a joint that is damaged twice. A jam is a servo that nothing
/// overcomes, with the limits of its set-points at one angle.
void apply_damage(Scenario& scenario, const std::vector<std::string>& words);

/// The word as usual_damages() spells it, so that equal damages are equal words: "jammed:J3=0" for "jammed:J3",
/// "torque:J3=40%" for "torque:J3=40.0". Throws InputError as apply_damage() does for a word that it cannot read.
[[nodiscard]] std::string damage_word(const Scenario& scenario, const std::string& word);

/// Words of damages that a robot may have, for programs that find out which one it has: each joint without
/// power, with a weak servo, and jammed at those of some angles that it can have; less friction everywhere.
[[nodiscard]] std::vector<std::string> usual_damages(const Scenario& scenario);

/// What usual_damages() has, in words for help texts.
[[nodiscard]] std::string usual_damages_text();

/// The state frames that are lost with the modules, in a run of the scenario's length.
[[nodiscard]] Losses losses_of_damage(const Scenario& scenario, const std::vector<std::string>& words);

/// The forms of a word, for help texts and messages.
[[nodiscard]] std::string damage_forms();

/// Multiplies all coefficients of friction, of the environment and of the robot's links.
void scale_friction(Scenario& scenario, double factor);

}  // namespace proleg::sim
