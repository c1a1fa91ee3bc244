/// \file
/// Seeded random rotations and deformation gradients.
#pragma once

#include <lefort/core/types.h>

#include <cmath>
#include <random>

namespace lefort::test {

class RandomDeformation {
 public:
  explicit RandomDeformation(unsigned seed) : generator_(seed) {}

  /// In [-1, 1].
  double number() { return 2.0 * double(generator_()) / 4294967295.0 - 1.0; }

  Mat3 matrix() {
    return Mat3::NullaryExpr([this] { return number(); });
  }

  Mat3 rotation() {
    return Eigen::Quaterniond(number(), number(), number(), number())
        .normalized()
        .toRotationMatrix();
  }

  /// Ten to the power of a number between `from` and `to`.
  double decade(double from, double to) {
    return std::pow(10.0, from + 0.5 * (number() + 1.0) * (to - from));
  }

  /// From 1/2 to 2.
  double stretch() { return std::exp2(number()); }

  /// Cases that are each difficult for some law, in turn: three different stretches, rotated;
  /// almost no strain; almost equal stretches; two or three equal ones, along the axes.
  Mat3 kind(int n) {
    const double s = stretch();
    switch (n % 4) {
      case 0:
        return rotation() * Vec3(s, stretch(), stretch()).asDiagonal() * rotation();
      case 1:
        return Mat3::Identity() + decade(-9.0, -1.0) * matrix();
      case 2:
        return rotation() *
               Vec3(s, s * (1.0 + decade(-17.0, -2.0)), s * (1.0 - decade(-17.0, -2.0)))
                   .asDiagonal() *
               rotation();
      default:
        return Vec3(s, s, n % 8 < 4 ? s : stretch()).asDiagonal();
    }
  }

  /// I + up to 0.6 per entry, rotated; 0.2 <= det <= 5, so that differences are accurate.
  Mat3 gradient() {
    for (;;) {
      const Mat3 F = rotation() * (Mat3::Identity() + 0.6 * matrix());
      if (F.determinant() >= 0.2 && F.determinant() <= 5.0) return F;
    }
  }

 private:
  std::mt19937 generator_;
};

}  // namespace lefort::test
