/// \file
/// Many short registrations of a few points, to find initial alignments.
#pragma once

#include <lefort/core/types.h>
#include <lefort/geometry/bvh.h>
#include <lefort/geometry/triangle_mesh.h>

#include <limits>
#include <vector>

namespace lefort::dental {

struct PointWithNormal {
  Vec3 point, normal;  ///< The normal has unit length.
};

/// \returns every n-th vertex, so that there are at most `maximum`.
[[nodiscard]] std::vector<PointWithNormal> points_with_normals(const geometry::TriangleMesh& mesh,
                                                               Index maximum);

/// Points without a counterpart on the surface are further than this, or beyond its border.
inline constexpr double kCounterpart_mm = 1.0;

/// An alignment and its distance.
struct Alignment {
  RigidTransform X = RigidTransform::Identity();
  /// Quantile of the distances; infinite if too few points have a counterpart.
  double off_mm = std::numeric_limits<double>::infinity();
};

struct CoarseOptions {
  double quantile = 0.5;  ///< At least this part of the points has a counterpart; 0 to 0.5.
  int iterations = 15;
};

/// From each start some iterations of closest points with point-to-plane distances \cite chen1992
/// and Tukey's weights, whose width follows a quantile of the distances. Points beyond the border
/// of an open surface count with the whole distance.
///
/// \param points    of the object.
/// \param surface   the one to register with; closed or open.
/// \param center    about which rotations are counted.
/// \param starts    maps of the points onto the surface.
/// \param options   quantile and iterations.
/// \returns the ends, the closest first; same bits for any number of threads.
[[nodiscard]] std::vector<Alignment> align_coarsely(const std::vector<PointWithNormal>& points,
                                                    const geometry::Bvh& surface,
                                                    const Vec3& center,
                                                    const std::vector<RigidTransform>& starts,
                                                    const CoarseOptions& options = {});

}  // namespace lefort::dental
