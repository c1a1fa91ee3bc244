/// \file
/// The lines where an osteotomy meets the surface of bone that a surgeon sees from one side.
#pragma once

#include <lefort/core/types.h>
#include <lefort/geometry/bvh.h>
#include <lefort/geometry/triangle_mesh.h>

#include <vector>

namespace lefort::dental {

/// A connected part of such a line.
struct CutLine {
  /// On the bone, about 0.5 mm from each other, by growing position along `along_L`.
  std::vector<Vec3> points_L;
  /// Unit vector: the direction of largest extent, perpendicular to the direction of view.
  Vec3 along_L = Vec3::UnitX();

  /// \returns the position of a point along the line.
  [[nodiscard]] double position_mm(const Vec3& p_L) const { return along_L.dot(p_L); }
  [[nodiscard]] double first_mm() const { return position_mm(points_L.front()); }
  [[nodiscard]] double last_mm() const { return position_mm(points_L.back()); }
};

/// Finds the lines: borders of the cut faces from which a ray towards the viewer meets no bone,
/// where the bone faces the viewer (60 degrees or less). Points up to 5 mm from each other are one
/// line; shorter ones than `min_length_mm` are left out.
///
/// \param cut_faces_L    the faces of the cut on one of its sides; open.
/// \param bone           before the cut, closed.
/// \param outward_L      unit vector from the bone to the viewer.
/// \param min_length_mm  along the line.
/// \returns the lines, the longest first.
[[nodiscard]] std::vector<CutLine> visible_cut_lines(const geometry::TriangleMesh& cut_faces_L,
                                                     const geometry::Bvh& bone,
                                                     const Vec3& outward_L, double min_length_mm);

/// Whether a ray from a point of the surface towards the viewer meets no bone.
///
/// \param normal_L  of the surface there, unit length.
[[nodiscard]] bool is_visible(const geometry::Bvh& bone, const Vec3& p_L, const Vec3& normal_L,
                              const Vec3& outward_L);

}  // namespace lefort::dental
