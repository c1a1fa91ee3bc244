/// \file
/// The space that each face, edge and vertex of a surface owns: where points may have their nearest
/// surface point on it.
///
/// The paper (section 2.1, steps 1 and 2) extrudes each triangle to a prism of +-band and visits
/// the lattice points in the prism's box. Prisms alone leave wedge-shaped gaps along convex edges
/// and cones at convex vertices, where points belong to no prism; boxes cover them only by luck. So
/// edges and vertices get regions of their own:
///
///        face            edge                vertex
///      | prism |      \  wedge /          \  cone  /
///      |       |       \      /            \      /
///      +-------+        \    /              \    /
///      |       |     ____\  /____          __\  /__
///      | prism |     face \/ face         edges \/
///
/// A point whose nearest surface point lies on a feature is in that feature's region, for any soup.
/// The converse fails, harmlessly: a region may reach past other parts of the surface, where their
/// smaller distances win. Because a region is a convex polyhedron that fits its feature, few
/// lattice points are visited in vain, even in wide bands.
#pragma once

#include <lefort/core/types.h>
#include <lefort/geometry/pseudonormals.h>
#include <lefort/geometry/triangle_mesh.h>

#include <cstdint>
#include <span>
#include <vector>

namespace lefort::field {

/// The points p with normal . p <= offset.
struct HalfSpace {
  Vec3 normal;
  double offset;
};

enum class FeatureKind : std::uint8_t { kFace, kEdge, kVertex };

struct FeatureRegion {
  FeatureKind kind;
  Vec3 anchor;         ///< A point of the feature.
  Vec3 axis;           ///< Unit: a face's normal, an edge's direction; zero for a vertex.
  Vec3 pseudonormal;   ///< Its product with p - nearest point has the sign of the distance.
  Box3 box;            ///< Holds the region.
  std::int32_t first;  ///< Its half-spaces in the list of all.
  std::int32_t count;
};

/// Regions of all features: faces, then edges, then vertices, each in ascending order.
class FeatureRegions {
 public:
  /// \param reach_mm  regions end at this distance from their feature.
  /// \param slack_mm  half-spaces are moved out by this, so that rounding opens no gap.
  FeatureRegions(const geometry::TriangleMesh& mesh, const geometry::Pseudonormals& normals,
                 double reach_mm, double slack_mm);

  [[nodiscard]] Index count() const { return Index(regions_.size()); }
  [[nodiscard]] const FeatureRegion& operator[](Index feature) const {
    return regions_[std::size_t(feature)];
  }
  [[nodiscard]] std::span<const HalfSpace> half_spaces_of(const FeatureRegion& region) const {
    return std::span(half_spaces_).subspan(std::size_t(region.first), std::size_t(region.count));
  }

 private:
  void add_faces(const geometry::TriangleMesh& mesh, const geometry::Pseudonormals& normals);
  void add_edges(const geometry::TriangleMesh& mesh, const geometry::Pseudonormals& normals);
  void add_vertices(const geometry::TriangleMesh& mesh, const geometry::Pseudonormals& normals);
  void begin_region(FeatureKind kind, const Vec3& anchor, const Vec3& axis,
                    const Vec3& pseudonormal);
  /// Ends the region at the plane through `point`: what lies along `outward` from it is outside.
  void cut(const Vec3& point, const Vec3& outward);

  double reach_mm_;
  double slack_mm_;
  std::vector<FeatureRegion> regions_;
  std::vector<HalfSpace> half_spaces_;
};

}  // namespace lefort::field
