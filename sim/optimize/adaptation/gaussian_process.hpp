#pragma once

#include <span>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace proleg::optimize {

/// What a Gaussian process assumes of a function, in any unit of values and points.
struct Kernel {
  double length = 0.4;     ///< distance over which values differ little; above 0
  double deviation = 1.0;  ///< standard deviation of the function from its prior mean; above 0
  double noise = 0.0;      ///< standard deviation of an observation from the function; not negative
};

/// Covariance of the values of two points at a distance: Matern 5/2,
///     deviation^2 (1 + a + a^2 / 3) exp(-a),  a = sqrt(5) distance / length
/// (C. E. Rasmussen, C. K. I. Williams, "Gaussian Processes for Machine Learning", MIT Press 2006, equation 4.17).
[[nodiscard]] double covariance(const Kernel& kernel, double distance);

/// A normal distribution.
struct Estimate {
  double mean = 0.0;
  double deviation = 0.0;  ///< standard deviation of the function, without the noise of an observation; not negative
};

/// Regression with a Gaussian process whose prior mean the caller knows at each point (Rasmussen and Williams,
/// equations 2.25, 2.26, 2.30 and 2.38). All points have the same number of coordinates; all numbers must be finite.
/// Equal points are allowed, also without noise: the estimate is then their mean.
class GaussianProcess {
 public:
  explicit GaussianProcess(const Kernel& kernel) : kernel_(kernel) {}

  /// prior: the mean at the point before any observation.
  void observe(std::span<const double> point, double prior, double value);
  [[nodiscard]] Estimate estimate(std::span<const double> point, double prior) const;
  /// Natural logarithm of the probability density of the values that were observed; 0 before any observation.
  [[nodiscard]] double log_likelihood() const;

 private:
  void factorise();

  Kernel kernel_;
  std::vector<std::vector<double>> points_;
  std::vector<double> differences_;  ///< of the values from their prior means
  Eigen::LLT<Eigen::MatrixXd> factor_;
  Eigen::VectorXd weights_;
};

}  // namespace proleg::optimize
