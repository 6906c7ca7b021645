#include "sim/optimize/adaptation/gaussian_process.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace proleg::optimize {
namespace {

using Point = std::vector<double>;

TEST(Covariance, IsThatOfTheTextbook) {
  // Matern 5/2 at the distance of the length: (1 + sqrt(5) + 5/3) exp(-sqrt(5)) = 0.5239941088318203.
  EXPECT_NEAR(covariance({0.5, 1.0, 0.0}, 0.5), 0.5239941088318203, 1e-14);
  EXPECT_NEAR(covariance({0.5, 3.0, 0.0}, 0.5), 9.0 * 0.5239941088318203, 1e-13);
  EXPECT_EQ(covariance({0.5, 2.0, 1.0}, 0.0), 4.0) << "noise is of observations";
  EXPECT_LT(covariance({0.1, 1.0, 0.0}, 10.0), 1e-60);
}

TEST(GaussianProcess, HasItsPriorBeforeAnyObservation) {
  const GaussianProcess process({0.4, 2.0, 0.1});
  const Estimate estimate = process.estimate(Point{0.3, 0.4}, 7.0);
  EXPECT_EQ(estimate.mean, 7.0);
  EXPECT_EQ(estimate.deviation, 2.0);
}

TEST(GaussianProcess, OfOneObservationHasTheClosedForm) {
  const Kernel kernel{0.4, 2.0, 0.3};
  GaussianProcess process(kernel);
  process.observe(Point{0.1, 0.2}, 1.0, 3.5);
  const Point other{0.4, 0.6};  // at the distance 0.5
  const Estimate estimate = process.estimate(other, 0.7);
  const double k = covariance(kernel, 0.5);
  EXPECT_NEAR(estimate.mean, 0.7 + k / (4.0 + 0.09) * 2.5, 1e-14);
  EXPECT_NEAR(estimate.deviation, std::sqrt(4.0 - k * k / (4.0 + 0.09)), 1e-14);
}

TEST(GaussianProcess, OfTwoObservationsHasTheClosedForm) {
  const Kernel kernel{0.7, 1.5, 0.2};
  GaussianProcess process(kernel);
  process.observe(Point{0.0}, 0.5, 2.0);
  process.observe(Point{1.0}, 0.25, -1.0);
  const Estimate estimate = process.estimate(Point{0.3}, 0.4);
  const double a = 1.5 * 1.5 + 0.2 * 0.2;
  const double b = covariance(kernel, 1.0);
  const double p = covariance(kernel, 0.3);
  const double q = covariance(kernel, 0.7);
  const double determinant = a * a - b * b;  // of the matrix a b, b a
  const double of_first = (a * p - b * q) / determinant;
  const double of_second = (a * q - b * p) / determinant;
  EXPECT_NEAR(estimate.mean, 0.4 + of_first * 1.5 + of_second * -1.25, 1e-13);
  EXPECT_NEAR(estimate.deviation, std::sqrt(2.25 - of_first * p - of_second * q), 1e-13);
}

TEST(GaussianProcess, AgreesWithAnIndependentComputation) {
  // By a program in Python that solves the equations of the textbook with the method of Gauss and Jordan.
  const std::vector<Point> points{{0.1, 0.2}, {0.4, 0.9}, {0.35, 0.5}, {0.8, 0.1}, {0.6, 0.65}};
  const std::array<double, 5> values{1.2, -0.3, 0.7, 2.0, 0.1};
  const std::array<double, 5> priors{1.0, 0.5, 0.5, 1.5, 0.25};
  GaussianProcess process({0.3, 1.7, 0.2});
  for (std::size_t i = 0; i < points.size(); ++i) {
    process.observe(points[i], priors[i], values[i]);
  }
  struct Case {
    Point point;
    double prior;
    double mean;
    double deviation;
  };
  for (const Case& one : {
           Case{{0.2, 0.3}, 0.9, 1.16571504752065, 0.707862107297557},
           Case{{0.5, 0.5}, 0.4, 0.563905768633758, 0.67843144740735},
           Case{{0.9, 0.9}, -1.0, -1.15191874374288, 1.56461109722329},
           Case{{0.1, 0.2}, 1.0, 1.19919885423937, 0.19839384300952},
       }) {
    const Estimate estimate = process.estimate(one.point, one.prior);
    EXPECT_NEAR(estimate.mean, one.mean, 1e-12);
    EXPECT_NEAR(estimate.deviation, one.deviation, 1e-12);
  }
}

TEST(GaussianProcess, HasTheLogarithmOfTheDensityOfItsObservations) {
  const Kernel kernel{0.7, 1.5, 0.2};
  GaussianProcess process(kernel);
  EXPECT_EQ(process.log_likelihood(), 0.0);
  process.observe(Point{0.0}, 0.5, 2.0);
  const double variance = 1.5 * 1.5 + 0.2 * 0.2;
  const double two_pi = 2.0 * std::acos(-1.0);
  EXPECT_NEAR(process.log_likelihood(), -0.5 * 1.5 * 1.5 / variance - 0.5 * std::log(two_pi * variance), 1e-12);
  process.observe(Point{1.0}, 0.25, -1.0);
  const double covariant = covariance(kernel, 1.0);
  const double determinant = variance * variance - covariant * covariant;
  const double square = (variance * 1.5 * 1.5 - 2.0 * covariant * 1.5 * -1.25 + variance * 1.25 * 1.25) / determinant;
  EXPECT_NEAR(process.log_likelihood(), -0.5 * square - std::log(two_pi) - 0.5 * std::log(determinant), 1e-12)
      << "the density of two normal values that are correlated";
}

TEST(GaussianProcess, WithoutNoiseGoesThroughItsObservations) {
  GaussianProcess process({0.3, 1.0, 0.0});
  const std::vector<double> places{0.0, 0.2, 0.5, 0.9};
  for (const double place : places) {
    process.observe(Point{place}, place, std::sin(9.0 * place));
  }
  for (const double place : places) {
    const Estimate estimate = process.estimate(Point{place}, place);
    EXPECT_NEAR(estimate.mean, std::sin(9.0 * place), 1e-9);
    EXPECT_NEAR(estimate.deviation, 0.0, 1e-6);
  }
}

TEST(GaussianProcess, KeepsItsPriorFarFromAllObservations) {
  GaussianProcess process({0.1, 2.0, 0.1});
  process.observe(Point{0.0, 0.0}, 0.0, 100.0);
  const Estimate estimate = process.estimate(Point{9.0, 9.0}, 3.0);
  EXPECT_NEAR(estimate.mean, 3.0, 1e-12);
  EXPECT_NEAR(estimate.deviation, 2.0, 1e-12);
}

TEST(GaussianProcess, TakesTheMeanOfEqualPointsAlsoWithoutNoise) {
  GaussianProcess process({0.4, 1.0, 0.0});
  process.observe(Point{0.5, 0.5}, 0.0, 1.0);
  process.observe(Point{0.5, 0.5}, 0.0, 2.0);
  process.observe(Point{0.5, 0.5 + 1e-13}, 0.0, 3.0);
  EXPECT_NEAR(process.estimate(Point{0.5, 0.5}, 0.0).mean, 2.0, 1e-4);
}

TEST(GaussianProcess, IsFiniteAndLessUncertainWithEachObservation) {
  constexpr unsigned seed = 5;
  std::mt19937 random(seed);
  const auto draw = [&] { return static_cast<double>(random() % 1000) / 1000.0; };
  for (const double length : {1e-3, 0.4, 50.0, 1000.0}) {
    for (const double noise : {0.0, 1e-9, 0.1}) {
      GaussianProcess process({length, 1.0, noise});
      const Point asked{draw(), draw()};
      double before = 1.0;
      for (int i = 0; i < 30; ++i) {
        process.observe(Point{draw(), draw()}, 0.0, draw());
        const Estimate estimate = process.estimate(asked, 0.0);
        ASSERT_TRUE(std::isfinite(estimate.mean)) << "length " << length << ", noise " << noise << ", seed " << seed;
        ASSERT_GE(estimate.deviation, 0.0);
        ASSERT_LE(estimate.deviation, before + 1e-3);
        before = estimate.deviation;
      }
    }
  }
}

}  // namespace
}  // namespace proleg::optimize
