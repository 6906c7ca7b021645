#pragma once

// The algorithms of the core. Each is one object in flash; registry.hpp makes it known to files and tools.

#include "shared/gait/actuation_module.hpp"

namespace proleg {

/// The angle of a joint is a parameter (thesis listing B.5). Nothing is broadcast.
[[nodiscard]] const ActuationModule& direct_joint_access();

/// A sin(2 pi f t + Phi_i) + O (thesis equation 3.1), Phi_i = i * phase_difference + phase. The phase is a function of
/// the tick and the parameters alone. So a joint that missed a frame is right again at once, and a change of frequency
/// makes the phase jump. The extended form changes smoothly.
[[nodiscard]] const ActuationModule& pattern_generator_sinusoidal();

/// A sin(n Theta + Phi_i) + O, the extended form of the sine: the phase is accumulated over the ticks, so it is
/// continuous when the frequency changes. Amplitude, phase and offset approach their parameters through critically
/// damped filters; amplitude and offset start at 0. n is a whole multiple of the frequency for each joint.
[[nodiscard]] const ActuationModule& pattern_generator_sinusoidal_extended();

/// Amplitude-controlled phase oscillators, coupled to both neighbours (A. J. Ijspeert et al., Science 315, 2007;
/// A. Crespi and A. J. Ijspeert, CLAWAR 2006; without the neighbours' amplitude in the coupling, so that a joint at
/// rest still passes the wave on):
///   theta_i' = 2 pi f + sum_j w sin(theta_j - theta_i - (j - i) phase_difference),   out_i = X_i + r_i cos(theta_i)
/// with r_i and X_i filtered as in the extended sine. The phases start from noise.
[[nodiscard]] const ActuationModule& pattern_generator_coupled_oscillator();

/// The sine of equation 3.1 whose wave runs the other way while something touches the head, and for `retreat` ticks
/// after that, so that the robot crawls backwards (thesis section 4.3.1: caterpillars react to stimuli on their head;
/// J. Brackenbury, J. Exp. Biol. 202, 1999). The phase is accumulated, so it is continuous at both reversals and when
/// the frequency changes. A joint takes phase and remaining retreat from the joint ahead; the first joint of the group
/// leads.
[[nodiscard]] const ActuationModule& pattern_generator_head_stimulus();

/// Serpenoid curve (S. Hirose, "Biologically Inspired Robots", 1993): link l has the heading alpha cos(2 pi f t - l b),
/// so joint i of the group has the angle A sin(2 pi f t - i b - b / 2) + turn, with b = 2 pi waves / joints of the
/// group and A = 2 alpha sin(b / 2), at most 90 degrees. Changes are smooth, as in the extended sine.
[[nodiscard]] const ActuationModule& pattern_generator_serpenoid();

/// Compound serpenoid curve for chains whose joints pitch and yaw in turn (M. Tesch et al., Advanced Robotics 23,
/// 2009): a wave beta + A sin(2 pi f t + n phase_difference) of the pitch joints and one of the yaw joints, which is
/// yaw_phase ahead; n counts all joints from the head. The algorithm does not use how a joint is mounted.
[[nodiscard]] const ActuationModule& pattern_generator_compound_serpenoid();

/// Hopf oscillators (L. Righetti and A. J. Ijspeert, ICRA 2008; with different speeds of the two half periods),
/// coupled to both neighbours by k (R z_j - z_i); R turns a state by the phase between the joints. The state first
/// turns exactly, then relaxes: z += dt alpha (1 - |z|^2) z. The joint has the angle A x + O.
[[nodiscard]] const ActuationModule& pattern_generator_hopf();

/// Matsuoka oscillators (shared/gait/matsuoka_pair.hpp); the joint has the angle 2 A (y1 - y2) + O. A neighbour's y1 -
/// y2 arrives as phase and amplitude; turned by the wanted phase difference, it inhibits the opposite neuron.
[[nodiscard]] const ActuationModule& pattern_generator_matsuoka();

/// Half-centres (T. Graham Brown, Proc. R. Soc. B 84, 1911): one of two populations that inhibit each other is active.
/// Its fatigue grows; when it exceeds the fatigue of the other by h, the other becomes active. tau s' = +-1 - s is the
/// difference of the fatigues; the joint has the angle A s / h + O. The period is 2 tau ln((1 + h) / (1 - h)).
/// Neighbours speed the fatigue up or slow it down until their phases fit.
[[nodiscard]] const ActuationModule& pattern_generator_half_centre();

/// Push-pull network (F. Herrero-Carron, F. B. Rodriguez, P. Varona, Bioinspir. Biomim. 6, 2011): promotor and remotor
/// neuron of a joint (shared/gait/rulkov_neuron.hpp) inhibit each other and, after a delay, drive those of the next
/// joint. The joint follows the smoothed difference of their activities.
[[nodiscard]] const ActuationModule& pattern_generator_push_pull();

/// The generator of M-TRAN (A. Kamimura et al., IEEE/ASME Trans. Mechatronics 10, 2005): a Matsuoka oscillator that
/// also receives the joint's own commanded angle, and the outputs of both neighbours, each through a weight. The joint
/// has the angle m2 y2 - m1 y1 + O.
[[nodiscard]] const ActuationModule& pattern_generator_mtran();

/// The extended sine with a phase that runs at two speeds, so that the angle grows during rising_fraction of the period
/// (after G. Li et al. on asymmetric oscillation, 2011; the equations are an interpretation). At 0.5 it is the extended
/// sine, bit for bit.
[[nodiscard]] const ActuationModule& pattern_generator_asymmetric_wave();

/// An offset for the gait of another slot, from the contacts of all links. On flat ground the supports of a travelling
/// wave lie almost a wavelength apart. Where two links touch at most `reach` places apart, for `confirm` ticks in a
/// row, something lies under the robot or in its way. Every joint then moves to its angle `raise`, holds it until
/// `hold` ticks after the last such sign, and returns to 0. Raised joints bend the body upwards, so that it comes down
/// on an obstacle instead of pushing against it. Without such a sign the angles are those of the other slot, bit for
/// bit. Nothing is broadcast. This is not the adaptive algorithm of the thesis (section 6.2), and simpler.
[[nodiscard]] const ActuationModule& sensing_module_uneven_ground_reflex();

/// The adaptive algorithm of the thesis (section 6.2, "Global Adaptive Touch"): offsets for the gait of another slot,
/// from the contacts of all links. A joint is stuck while something touches the robot, but the touch of the four links
/// around the joint has not changed for `stuck_threshold`. A stuck joint bends: up if the two outer links touch more
/// than the two at the joint, down if they touch less, else further to the side of the gait. One of eight constants is
/// the speed: four are for bending up and four for bending down, by the touch of the two links at the joint. A joint
/// that is not stuck returns to the gait. On flat ground the touch changes in each period. The thesis prints the names
/// and ranges of the parameters and their effect, but no equations: this is an interpretation (docs/adaptive-touch.md).
/// Nothing is broadcast.
[[nodiscard]] const ActuationModule& sensing_module_global_adaptive_touch();

/// A wave A_s sin(2 pi integral f_s dt + i phase_difference_s) + O_s, whose set of parameters s the robot chooses by
/// what it senses (thesis, section 7.3: sensor fusion that selects locomotion patterns). The first joint of the group
/// decides, from eight features: low-pass filtered inclination and its swing, roll, touch of all links, touch of the
/// first link, changes of touch, and current and tracking error of the joint's servo. Set 4, 3 or 2 is chosen, in this
/// order, if the one or two conditions of its rule hold, else set 1. The decision travels from joint to joint with a
/// countdown, at whose end all joints change in the same tick; amplitude, phase and offset then pass over smoothly. A
/// joint that receives nothing keeps its set, and is right one tick after it receives a frame again. This is a design
/// of Proleg (docs/gait-selector.md); the conditions are those of a decision list (R. Rivest, Machine Learning 2,
/// 1987).
[[nodiscard]] const ActuationModule& sensing_module_gait_selector();

}  // namespace proleg
