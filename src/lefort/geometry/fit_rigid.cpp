#include <lefort/core/decompositions.h>
#include <lefort/geometry/fit_rigid.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lefort::geometry {
namespace {

constexpr double kMinSpreadRatio = 0.01;  // Second to first singular value of the points.

Vec3 mean(std::span<const Vec3> points) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& p : points) sum += p;
  return sum / double(points.size());
}

Eigen::MatrixX3d centered(std::span<const Vec3> points, const Vec3& center) {
  Eigen::MatrixX3d rows(Index(points.size()), 3);
  for (std::size_t i = 0; i < points.size(); ++i)
    rows.row(Index(i)) = (points[i] - center).transpose();
  return rows;
}

/// The squares of the singular values of `rows` are the eigenvalues of rows^T rows.
bool is_collinear(const Eigen::MatrixX3d& rows) {
  const Vec3 squares = symmetric_eigen(Mat3(rows.transpose() * rows)).values;
  return !(squares[1] > kMinSpreadRatio * kMinSpreadRatio * squares[2]);
}

}  // namespace

Result<RigidFit> fit_rigid(std::span<const Vec3> from, std::span<const Vec3> to) {
  const auto bad = [](std::string what) {
    return fail(ErrorCode::kInvalidArgument, std::move(what));
  };
  if (from.size() != to.size())
    return bad(
        fmt::format("{} points for {} targets, the numbers must be equal", from.size(), to.size()));
  if (from.size() < 3) return bad(fmt::format("{} points, must be three or more", from.size()));
  for (std::size_t i = 0; i < from.size(); ++i)
    if (!from[i].allFinite() || !to[i].allFinite())
      return bad(fmt::format("point {} or its target is not finite", i));
  const Vec3 center_from = mean(from), center_to = mean(to);
  const Eigen::MatrixX3d rows_from = centered(from, center_from), rows_to = centered(to, center_to);
  if (is_collinear(rows_from))
    return bad("the points are collinear, so the rotation is not determined");
  if (is_collinear(rows_to))
    return bad("the targets are collinear, so the rotation is not determined");

  const Mat3 covariance = rows_to.transpose() * rows_from;
  const auto [U, values, V] = singular_value_decomposition(covariance);
  Vec3 sign = Vec3::Ones();
  if (U.determinant() * V.determinant() < 0.0) sign.z() = -1.0;
  RigidFit fit;
  fit.X_to_from.linear() = U * sign.asDiagonal() * V.transpose();
  fit.X_to_from.translation() = center_to - fit.X_to_from.linear() * center_from;
  double sum = 0.0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const double off_mm = (fit.X_to_from * from[i] - to[i]).norm();
    sum += off_mm * off_mm;
    if (off_mm <= fit.max_residual_mm) continue;
    fit.max_residual_mm = off_mm;
    fit.max_residual_index = Index(i);
  }
  fit.rms_mm = std::sqrt(sum / double(from.size()));
  return fit;
}

}  // namespace lefort::geometry
