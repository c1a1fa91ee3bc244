#include <lefort/field/query/evaluate_spline.h>
#include <lefort/field/storage/spline_lattice.h>

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <numeric>
#include <random>
#include <vector>

namespace lefort::field::test_spline_lattice {
namespace {

constexpr int kResolution = 16;
constexpr double kHugeCell = 1e9;  // No difference counts as a conflict.

template <class Function>
SparseLattice tabulate(const Function& f) {
  std::vector<std::int32_t> all(5 * 5 * 5);
  std::iota(all.begin(), all.end(), 0);
  SparseLattice lattice(kResolution, all, 0.0F);
  for (Index slot = 0; slot < lattice.brick_count(); ++slot) {
    const LatticePoint low = lattice.first_point(lattice.brick_number(slot));
    for (int n = 0; n < SparseLattice::kBrickPoints; ++n)
      lattice.brick(slot)[std::size_t(n)] =
          float(f(Vec3(low[0] + n % 8, low[1] + n / 8 % 8, low[2] + n / 64)));
  }
  return lattice;
}

TEST(SplineLattice, ReproducesQuadraticPolynomialsWithTheirDerivatives) {
  const auto f = [](const Vec3& u) {
    const double x = u.x() / 8, y = u.y() / 8, z = u.z() / 8;
    return x * x - 2 * x * y * z + y * y - 0.5 * z * z + 3 * x - 1;
  };
  const SparseLattice c = spline_lattice(tabulate(f), kHugeCell, kHugeCell);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> in(0, kResolution);
  for (int n = 0; n < 200; ++n) {
    const Vec3 u(in(random), in(random), in(random));
    const double x = u.x() / 8, y = u.y() / 8, z = u.z() / 8;
    const SplineValue s = evaluate_spline(c, u);
    EXPECT_NEAR(s.value, f(u), 1e-5);
    EXPECT_LT(
        (s.gradient - Vec3(2 * x - 2 * y * z + 3, -2 * x * z + 2 * y, -2 * x * y - z) / 8).norm(),
        1e-5);
    Mat3 hessian;
    hessian << 2, -2 * z, -2 * y, -2 * z, 2, -2 * x, -2 * y, -2 * x, -1;
    EXPECT_LT((s.hessian - hessian / 64).norm(), 1e-5);
  }
}

TEST(SplineLattice, InterpolatesEveryValue) {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> noise(-1, 1);
  const SparseLattice values = tabulate([&](const Vec3&) { return noise(random); });
  const SparseLattice c = spline_lattice(values, 10, kHugeCell);
  for (const LatticePoint& at :
       {LatticePoint{0, 0, 0}, LatticePoint{7, 8, 9}, LatticePoint{16, 3, 16}})
    EXPECT_EQ(evaluate_spline(c, Vec3(at[0], at[1], at[2])).value, double(values.at(at, 0.0F)));
}

TEST(SplineLattice, ErrorIsOfThirdOrderInTheCell) {
  const auto max_error = [](double wave) {
    const auto f = [&](const Vec3& u) {
      return std::sin(wave * u.x()) * std::cos(wave * u.y()) + std::sin(wave * u.z());
    };
    const SparseLattice c = spline_lattice(tabulate(f), kHugeCell, kHugeCell);
    std::mt19937 random(2);
    std::uniform_real_distribution<double> in(0, kResolution);
    double largest = 0.0;
    for (int n = 0; n < 3000; ++n) {
      const Vec3 u(in(random), in(random), in(random));
      largest = std::max(largest, std::abs(evaluate_spline(c, u).value - f(u)));
    }
    return largest;
  };
  const double ratio = max_error(0.6) / max_error(0.3);
  EXPECT_GT(ratio, 7.0);
  EXPECT_LT(ratio, 11.0);
}

TEST(SplineLattice, DerivativesMatchTheValue) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> in(0, kResolution), noise(-1, 1);
  const SparseLattice c =
      spline_lattice(tabulate([&](const Vec3&) { return noise(random); }), 10, kHugeCell);
  constexpr double kStep = 1e-4;
  for (int n = 0; n < 200; ++n) {
    const Vec3 u(in(random), in(random), in(random));
    const SplineValue s = evaluate_spline(c, u);
    for (int k = 0; k < 3; ++k) {
      // The second derivative may jump there.
      if (std::abs(u[k] - std::round(u[k])) < 2.0 * kStep) continue;
      const Vec3 step = kStep * Vec3::Unit(k);
      const SplineValue up = evaluate_spline(c, u + step), down = evaluate_spline(c, u - step);
      EXPECT_NEAR(s.gradient[k], (up.value - down.value) / (2 * kStep), 1e-6);
      EXPECT_LT((s.hessian.col(k) - (up.gradient - down.gradient) / (2 * kStep)).norm(), 2e-4);
    }
    EXPECT_EQ(s.hessian, s.hessian.transpose());
  }
}

/// Third differences along an axis on both sides of a cell face, interpolated in the face by the
/// spline.
double sum_of_third_differences(const SparseLattice& c, const Vec3& u, int axis) {
  const auto at = [&](int cells) { return evaluate_spline(c, u + cells * Vec3::Unit(axis)).value; };
  return (at(1) - 3 * at(0) + 3 * at(-1) - at(-2)) + (at(2) - 3 * at(1) + 3 * at(0) - at(-1));
}

TEST(SplineLattice, AcrossCellsAndBricksTheSecondDerivativeJumpsByThirdDifferencesAndNoOtherDoes) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> in(0, kResolution), noise(-1, 1);
  const SparseLattice c =
      spline_lattice(tabulate([&](const Vec3&) { return noise(random); }), 10, kHugeCell);
  for (int n = 0; n < 300; ++n) {
    Vec3 u(in(random), in(random), in(random));
    const int axis = n % 3;
    u[axis] = 2 + n % (kResolution - 3);  // On a face between cells; at 8, between bricks.
    const Vec3 step = 1e-9 * Vec3::Unit(axis);
    const SplineValue before = evaluate_spline(c, u - step), after = evaluate_spline(c, u + step);
    EXPECT_NEAR(before.value, after.value, 1e-7);
    EXPECT_LT((before.gradient - after.gradient).norm(), 1e-7);
    Mat3 jump = after.hessian - before.hessian;
    EXPECT_NEAR(jump(axis, axis), -sum_of_third_differences(c, u, axis), 1e-6);
    jump(axis, axis) = 0.0;
    EXPECT_LT(jump.norm(), 1e-6);
  }
}

TEST(SplineLattice, SamplesInConflictAreMissing) {
  const auto in_conflict = [](const Vec3& u) { return u.x() < 7.5 ? -5.0 : 5.0; };
  const SparseLattice c = spline_lattice(tabulate(in_conflict), 1.0, kHugeCell);
  EXPECT_TRUE(std::isnan(evaluate_spline(c, Vec3(7.5, 4, 4)).value));
  EXPECT_NEAR(evaluate_spline(c, Vec3(2.5, 4, 4)).value, -5.0, 1e-6);
  EXPECT_NEAR(evaluate_spline(c, Vec3(12.5, 4, 4)).value, 5.0, 1e-6);
}

/// The sum of the formula, term by term.
SplineValue plain_sum(const SparseLattice& c, const Vec3& u) {
  const auto spline = [](double t, int order) {  // Centered at 0.
    const double a = std::abs(t), sign = t < 0 ? -1 : 1;
    if (a >= 2) return 0.0;
    if (order == 0)
      return a < 1 ? 1 - 2.5 * a * a + 1.5 * a * a * a : 2 - 4 * a + 2.5 * a * a - 0.5 * a * a * a;
    if (order == 1) return sign * (a < 1 ? -5 * a + 4.5 * a * a : -4 + 5 * a - 1.5 * a * a);
    return a < 1 ? -5 + 9 * a : 5 - 3 * a;
  };
  SplineValue sum{0, Vec3::Zero(), Mat3::Zero()};
  for (int z = -2; z <= kResolution + 2; ++z)
    for (int y = -2; y <= kResolution + 2; ++y)
      for (int x = -2; x <= kResolution + 2; ++x) {
        const Vec3 at = u - Vec3(x, y, z);
        if ((at.array().abs() >= 2).any()) continue;
        const double value = double(c.at({x, y, z}, std::nanf("")));
        const auto term = [&](int i, int j, int k) {
          return value * spline(at[0], i) * spline(at[1], j) * spline(at[2], k);
        };
        sum.value += term(0, 0, 0);
        sum.gradient += Vec3(term(1, 0, 0), term(0, 1, 0), term(0, 0, 1));
        Mat3 hessian;
        hessian << term(2, 0, 0), term(1, 1, 0), term(1, 0, 1), term(1, 1, 0), term(0, 2, 0),
            term(0, 1, 1), term(1, 0, 1), term(0, 1, 1), term(0, 0, 2);
        sum.hessian += hessian;
      }
  return sum;
}

TEST(SplineLattice, MatchesTheSumOfItsTermsAcrossBricksAndOnEveryProcessor) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> in(0, kResolution), noise(-1, 1);
  const SparseLattice c =
      spline_lattice(tabulate([&](const Vec3&) { return noise(random); }), 10, kHugeCell);
  std::vector<Vec3> points;
  for (int n = 0; n < 2001; ++n) points.emplace_back(in(random), in(random), in(random));
  for (const double edge : {0.0, 7.0, 8.0, 16.0}) points.push_back(Vec3::Constant(edge));
  std::vector<SplineValue> baseline(points.size()), found(points.size());
  evaluate_splines(c, points, baseline, Simd::kBaseline);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const SplineValue expected = plain_sum(c, points[i]);
    ASSERT_NEAR(baseline[i].value, expected.value, 1e-14) << points[i].transpose();
    ASSERT_LT((baseline[i].gradient - expected.gradient).norm(), 1e-13) << points[i].transpose();
    // On faces of cells the second derivative has two values.
    if ((points[i].array() == points[i].array().round()).any()) continue;
    ASSERT_LT((baseline[i].hessian - expected.hessian).norm(), 1e-13) << points[i].transpose();
  }
  for (const Simd simd : {Simd::kAvx2, Simd::kAvx512}) {
    if (simd > best_simd()) continue;
    evaluate_splines(c, points, found, simd);
    for (std::size_t i = 0; i < points.size(); ++i) {
      ASSERT_EQ(std::memcmp(&found[i], &baseline[i], sizeof(SplineValue)), 0)
          << points[i].transpose();
    }
  }
}

TEST(SplineLattice, AMissingBrickMattersOnlyWhereItsValuesAreUsed) {
  std::vector<std::int32_t> all(5 * 5 * 5);
  std::iota(all.begin(), all.end(), 0);
  const SparseLattice whole(kResolution, all, 1.0F);
  std::erase(all, whole.brick_of({8, 0, 0}));
  const SparseLattice c(kResolution, all, 1.0F);
  // The cell from 6 uses values 5 to 8, that from 5 none beyond 7.
  EXPECT_TRUE(std::isnan(evaluate_spline(c, Vec3(6.5, 3.5, 3.5)).value));
  EXPECT_NEAR(evaluate_spline(c, Vec3(5.5, 3.5, 3.5)).value, 1.0, 1e-15);
  EXPECT_TRUE(std::isnan(evaluate_spline(c, Vec3(9.5, 6.5, 6.5)).value));
  EXPECT_NEAR(evaluate_spline(c, Vec3(9.5, 9.5, 3.5)).value, 1.0, 1e-15);
}

TEST(SplineLattice, OneMissingValueMakesAllResultsNan) {
  SparseLattice c = tabulate([](const Vec3&) { return 1.0; });
  c.brick(c.slot_of(c.brick_of({9, 4, 7})))[std::size_t(SparseLattice::linear_offset({9, 4, 7}))] =
      std::nanf("");
  for (const Vec3& u : {Vec3(7.5, 4.5, 6.5), Vec3(8.0, 4.0, 7.0), Vec3(10.9, 3.5, 5.1)}) {
    const SplineValue s = evaluate_spline(c, u);
    EXPECT_TRUE(std::isnan(s.value));
    EXPECT_TRUE(s.gradient.array().isNaN().all());
    EXPECT_TRUE(s.hessian.array().isNaN().all());
  }
  EXPECT_NEAR(evaluate_spline(c, Vec3(6.9, 4.5, 6.5)).value, 1.0, 1e-15);
}

TEST(SplineLattice, BricksWithoutSmallValuesAreDropped) {
  const auto height = [](const Vec3& u) { return u.z(); };
  const SparseLattice c = spline_lattice(tabulate(height), 1.0, 3.0);
  EXPECT_EQ(c.brick_count(), 2 * 25);  // z = -8 to -1 and 0 to 7.
}

}  // namespace
}  // namespace lefort::field::test_spline_lattice
