/// \file
/// Seeded random rotations and deformation gradients.
#pragma once

#include <lefort/core/types.h>

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

  /// I + up to 0.6 per entry, turned; 0.2 <= det <= 5, so that differences stay accurate.
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
