#include <lefort/io/predicted_poses.h>

#include <optional>

namespace lefort::io {
namespace {

using nlohmann::json;

/// Nothing if it is not a rigid motion.
std::optional<RigidTransform> as_pose(const json& numbers) {
  constexpr double kRigid = 1e-6;
  RigidTransform X_LB;
  for (std::size_t k = 0; k < 16; ++k)
    X_LB.matrix()(Index(k / 4), Index(k % 4)) = numbers.at(k).get<double>();
  const Mat3 rotation = X_LB.linear();
  if (!X_LB.matrix().allFinite() || X_LB.matrix().row(3) != Eigen::RowVector4d(0, 0, 0, 1) ||
      (rotation.transpose() * rotation - Mat3::Identity()).norm() > kRigid ||
      rotation.determinant() < 0.0)
    return std::nullopt;
  return X_LB;
}

}  // namespace

Result<void> check_prediction_version(const json& document) {
  const auto version = document.find("lefort_prediction");
  if (version == document.end() || *version == kPredictionVersion) return {};
  return fail(ErrorCode::kFileUnsupported,
              "the prediction was written by another version of the program: predict again");
}

Result<std::vector<SegmentPose>> predicted_poses(const json& document, const json& step) {
  const auto damaged = [] {
    return fail(ErrorCode::kFileCorrupt,
                "the prediction has no valid poses of its segments: predict again");
  };
  LEFORT_TRY_VOID(check_prediction_version(document));
  try {
    std::vector<SegmentPose> all;
    for (const json& segment : step.at("segments")) {
      const auto X_LB = as_pose(segment.at("pose_4x4_row_major_mm_lps"));
      if (!X_LB) return damaged();
      all.push_back({segment.at("name").get<std::string>(), *X_LB});
    }
    if (all.empty()) return damaged();
    return all;
  } catch (const json::exception&) {
    return damaged();
  }
}

}  // namespace lefort::io
