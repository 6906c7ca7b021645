#pragma once

// The coupled phase oscillators in double precision, written from their equations (Ijspeert et al. 2007 with the
// coupling of Crespi and Ijspeert 2006), stepped explicitly as all joints do at once:
//   theta_i' = 2 pi f + w sum_j sin(theta_j - theta_i - (j - i) phi),   r'' = a (a/4 (R - r) - r'),   same for X

#include <cmath>
#include <numbers>
#include <vector>

namespace proleg::test {

struct OscillatorModel {
  double frequency = 1;                                   // Hz
  double coupling = 10;                                   // 1/s
  double rate = 20;                                       // 1/s
  double phase_difference = 55 * std::numbers::pi / 180;  // rad
  double amplitude = 40;                                  // degrees
  double offset = 0;                                      // degrees
  double dt = 0.01;                                       // s

  struct Filtered {
    double value = 0;
    double speed = 0;
  };
  std::vector<double> theta;
  std::vector<Filtered> r;
  std::vector<Filtered> x;

  void approach(Filtered& filtered, double target) const {
    const double h = rate / 2;
    const double q = std::exp(-h * dt);
    const double e = filtered.value - target;
    const double c = filtered.speed + h * e;
    filtered.value = target + (e + c * dt) * q;
    filtered.speed = (filtered.speed - h * c * dt) * q;
  }

  void step() {
    const std::vector<double> old = theta;
    for (std::size_t i = 0; i < old.size(); ++i) {
      double change = 2 * std::numbers::pi * frequency;
      if (i > 0) {
        change += coupling * std::sin(old[i - 1] - old[i] + phase_difference);
      }
      if (i + 1 < old.size()) {
        change += coupling * std::sin(old[i + 1] - old[i] - phase_difference);
      }
      theta[i] = old[i] + change * dt;
      approach(r[i], amplitude);
      approach(x[i], offset);
    }
  }

  [[nodiscard]] double output(std::size_t joint) const {
    return x[joint].value + r[joint].value * std::cos(theta[joint]);
  }
};

}  // namespace proleg::test
