#pragma once

// Tests whether the results of two methods differ by more than chance. Best distances are not normally distributed:
// searches end on one summit or the other. A test of ranks needs no distribution.

#include <span>
#include <vector>

namespace proleg::optimize {

/// Share of the pairs (a, b) in which a is greater; equal ones count half. 0 to 1; NaN if a group is empty.
[[nodiscard]] double share_above(std::span<const double> a, std::span<const double> b);

/// Two-sided p-value of the rank-sum test of F. Wilcoxon ("Individual comparisons by ranking methods", Biometrics
/// Bulletin 1, 1945) and of H. B. Mann and D. R. Whitney: the probability that groups of these sizes, drawn at random
/// from all values, have rank sums at least as far from their mean. Equal values share the mean of their ranks. The
/// p-value is exact for up to 100 values; above, it is the normal approximation with correction for ties. It is 1 if a
/// group is empty.
[[nodiscard]] double rank_sum_test(std::span<const double> a, std::span<const double> b);

/// p-values of several tests, corrected after S. Holm ("A simple sequentially rejective multiple test procedure",
/// Scand. J. Statist. 6, 1979): each can be compared with the level of significance of all tests together.
[[nodiscard]] std::vector<double> correct_for_several(std::span<const double> p_values);

}  // namespace proleg::optimize
