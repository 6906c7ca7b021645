#pragma once

// A Matsuoka oscillator in double precision, written from its equations (Matsuoka 1985, 1987):
//   tau u1' = -u1 - w y2 - beta v1 + c + S1,   T v1' = -v1 + y1,   y = max(0, u), and the same with 1 and 2 exchanged

#include <algorithm>
#include <cmath>
#include <numbers>

namespace proleg::test {

struct MatsuokaModel {
  double tau = 0.25;  // s
  double t = 0.5;     // s
  double beta = 2.5;
  double w = 2.5;
  double u1 = 0.1;
  double u2 = 0;
  double v1 = 0;
  double v2 = 0;

  [[nodiscard]] double y1() const { return std::max(u1, 0.0); }
  [[nodiscard]] double y2() const { return std::max(u2, 0.0); }

  void step(double dt, double input1, double input2) {
    const double a = y1();
    const double b = y2();
    u1 += dt / tau * (-u1 - w * b - beta * v1 + input1);
    u2 += dt / tau * (-u2 - w * a - beta * v2 + input2);
    v1 += dt / t * (a - v1);
    v2 += dt / t * (b - v2);
  }

  /// Natural angular frequency (Matsuoka 2011).
  [[nodiscard]] double omega() const { return std::sqrt(((tau + t) * beta - tau * w) / (tau * w)) / t; }
};

}  // namespace proleg::test
