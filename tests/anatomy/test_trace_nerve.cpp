#include "anatomy/nerve_phantom.h"

namespace lefort::anatomy {
namespace {

using namespace test;

const LabeledScan& coarse_scan() {
  static const LabeledScan scan = scan_with_canals(ParametricHead{{}}, 1.4);
  return scan;
}

TEST(TraceNerve, passes_through_given_points) {
  const ParametricHead head{{}};
  const LabeledScan& scan = coarse_scan();
  MandibleSide side = side_of_head(head, 1.0);
  const std::vector<Vec3> truth = canal_of(head, 1.0);
  side.mandibular_foramen_L = truth[1];
  side.mental_foramen_L = truth[7];
  side.points_L = {truth[4] + Vec3(0.0, 0.0, 2.0)};
  const auto canal = trace_nerve(scan.ct, scan.labels, side);
  ASSERT_TRUE(canal) << canal.error().message;
  EXPECT_LT((canal->line_L.front() - truth[1]).norm(), 0.6);
  EXPECT_LT((canal->line_L.back() - truth[7]).norm(), 0.6);
  EXPECT_LT(distance_to_line(canal->line_L, side.points_L[0]), 1.2);  // Smoothed.

  side.points_L = {truth[4] + Vec3(0.0, 0.0, 60.0)};
  const auto far = trace_nerve(scan.ct, scan.labels, side);
  ASSERT_FALSE(far);
  EXPECT_EQ(far.error().code, ErrorCode::kAnatomyMissing);
}

TEST(TraceNerve, no_mandible) {
  const ParametricHead head{{}};
  LabeledScan scan = coarse_scan();
  for (Tissue& tissue : scan.labels.values)
    if (tissue == Tissue::kMandible) tissue = Tissue::kSoftTissue;
  const auto none = trace_nerve(scan.ct, scan.labels, side_of_head(head, 1.0));
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ErrorCode::kAnatomyMissing);
}

}  // namespace
}  // namespace lefort::anatomy
