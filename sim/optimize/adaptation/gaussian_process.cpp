#include "sim/optimize/adaptation/gaussian_process.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace proleg::optimize {
namespace {

double distance_between(std::span<const double> a, std::span<const double> b) {
  double squares = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    squares += (a[i] - b[i]) * (a[i] - b[i]);
  }
  return std::sqrt(squares);
}

}  // namespace

double covariance(const Kernel& kernel, double distance) {
  const double a = std::sqrt(5.0) * distance / kernel.length;
  return kernel.deviation * kernel.deviation * (1.0 + a + a * a / 3.0) * std::exp(-a);
}

void GaussianProcess::observe(std::span<const double> point, double prior, double value) {
  points_.emplace_back(point.begin(), point.end());
  differences_.push_back(value - prior);
  factorise();
}

/// Points that are nearly equal make the matrix singular. A little more noise (jitter) than the kernel has keeps its
/// pivots, and with them the errors of the solution, within limits.
void GaussianProcess::factorise() {
  const auto count = static_cast<Eigen::Index>(points_.size());
  const double variance = kernel_.deviation * kernel_.deviation;
  Eigen::MatrixXd matrix(count, count);
  for (Eigen::Index row = 0; row < count; ++row) {
    for (Eigen::Index column = 0; column <= row; ++column) {
      matrix(row, column) = covariance(
          kernel_, distance_between(points_[static_cast<std::size_t>(row)], points_[static_cast<std::size_t>(column)]));
    }
    matrix(row, row) += kernel_.noise * kernel_.noise;
  }
  constexpr double least_pivot = 1e-10;  // as a share of the variance
  for (double jitter = 0.0;; jitter = std::max(2.0 * least_pivot * variance, 10.0 * jitter)) {
    Eigen::MatrixXd with_jitter = matrix;
    with_jitter.diagonal().array() += jitter;
    factor_.compute(with_jitter);
    const bool is_safe = factor_.info() == Eigen::Success &&
                         factor_.matrixLLT().diagonal().array().square().minCoeff() >= least_pivot * variance;
    if (is_safe || jitter > variance) {
      break;
    }
  }
  weights_ = factor_.solve(Eigen::Map<const Eigen::VectorXd>(differences_.data(), count));
}

Estimate GaussianProcess::estimate(std::span<const double> point, double prior) const {
  if (points_.empty()) {
    return {prior, kernel_.deviation};
  }
  Eigen::VectorXd covariances(static_cast<Eigen::Index>(points_.size()));
  for (std::size_t i = 0; i < points_.size(); ++i) {
    covariances[static_cast<Eigen::Index>(i)] = covariance(kernel_, distance_between(point, points_[i]));
  }
  const double explained = factor_.matrixL().solve(covariances).squaredNorm();
  return {prior + covariances.dot(weights_),
          std::sqrt(std::max(0.0, kernel_.deviation * kernel_.deviation - explained))};
}

double GaussianProcess::log_likelihood() const {
  if (points_.empty()) {
    return 0.0;
  }
  const Eigen::Map<const Eigen::VectorXd> differences(differences_.data(), weights_.size());
  return -0.5 * differences.dot(weights_) - factor_.matrixLLT().diagonal().array().log().sum() -
         0.5 * static_cast<double>(points_.size()) * std::log(2.0 * std::numbers::pi);
}

}  // namespace proleg::optimize
