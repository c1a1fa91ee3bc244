#include <cstdlib>

#include "anatomy/nerve_phantom.h"

namespace lefort::anatomy {
namespace {

using namespace test;

/// One head; all three with LEFORT_LONG_TESTS in the environment (script/test --all).
std::vector<ParametricHead> heads() {
  HeadShape small, large;
  small.scale = {0.94, 0.93, 0.95};
  small.rotation_rad = {0.08, -0.05, 0.06};
  large.scale = {1.05, 1.06, 1.04};
  large.rotation_rad = {-0.06, 0.04, 0.1};
  large.translation_mm = {12.0, -30.0, 45.0};
  if (std::getenv("LEFORT_LONG_TESTS") == nullptr) return {ParametricHead{large}};
  return {ParametricHead{{}}, ParametricHead{small}, ParametricHead{large}};
}

TEST(TraceNerve, known_canals_of_turned_heads) {
  for (const ParametricHead& head : heads()) {
    const LabeledScan scan = scan_with_canals(head, 0.6);
    for (const double side : {-1.0, 1.0}) {
      const auto canal = trace_nerve(scan.ct, scan.labels, side_of_head(head, side));
      ASSERT_TRUE(canal) << canal.error().message;
      const std::vector<Vec3> truth = canal_of(head, side);
      double sum = 0.0, at_foramen = 0.0, elsewhere = 0.0;
      for (const Vec3& p : smoothed_path(truth, 0.0, 0.5)) {
        const double d = distance_to_line(canal->line_L, p);
        sum += d * 0.5 / length_mm(truth);
        double& largest = (p - truth.front()).norm() < 8.0 ? at_foramen : elsewhere;
        largest = std::max(largest, d);
      }
      RecordProperty("mean", std::to_string(sum));
      EXPECT_LT(sum, 1.0);
      EXPECT_LT(at_foramen, 5.0);  // The nerve lies on the ramus before it enters the bone.
      EXPECT_LT(elsewhere, 2.5);
      EXPECT_LT((canal->line_L.back() - truth.back()).norm(), 3.0);
      EXPECT_GT(canal->visible_fraction, 0.8);
      ASSERT_EQ(canal->hu.size(), canal->line_L.size());
    }
  }
}

}  // namespace
}  // namespace lefort::anatomy
