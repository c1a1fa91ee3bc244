#include <lefort/io/predicted_poses.h>

#include <optional>

namespace lefort::io {
namespace {

using nlohmann::json;

/// Nothing if it is not a rigid motion.
std::optional<RigidTransform> as_pose(const json& rows) {
  constexpr double kRigid = 1e-6;
  RigidTransform X_LB;
  for (std::size_t row = 0; row < 4; ++row)
    for (std::size_t column = 0; column < 4; ++column)
      X_LB.matrix()(Index(row), Index(column)) = rows.at(row).at(column).get<double>();
  const Mat3 turn = X_LB.linear();
  if (!X_LB.matrix().allFinite() || (turn.transpose() * turn - Mat3::Identity()).norm() > kRigid)
    return std::nullopt;
  return X_LB;
}

}  // namespace

Result<std::vector<SegmentPose>> predicted_poses(const json& document, const json& step) {
  const auto damaged = [] {
    return fail(ErrorCode::kFileCorrupt,
                "the prediction does not contain the poses of its segments");
  };
  try {
    const json& names = document.at("parameters").at("segment");
    const json& poses = step.at("pose_4x4_row_major_mm_lps");
    std::vector<SegmentPose> all;
    for (const json& name : names.is_array() ? names : json::array({names})) {
      const auto segment = name.get<std::string>();
      const auto X_LB = as_pose(names.is_array() ? poses.at(segment) : poses);
      if (!X_LB) return damaged();
      all.push_back({segment, *X_LB});
    }
    if (all.empty()) return damaged();
    return all;
  } catch (const json::exception&) {
    return damaged();
  }
}

}  // namespace lefort::io
