/// \file
/// A box of "tissue" in a small scan, with a segment and a remainder of bone below it, for tests of
/// domain and boundary. All distances are known in closed form:
///
///      z = 20   skin
///      |  soft tissue, 40 x 40 in x, y  |
///      z = 8    bone: segment for x < 20, remainder for x > 20
///
/// The level-set function is limited to the same band as in anatomy/tissue_levels.h.
#pragma once

#include <lefort/anatomy/label_map.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/image/volume.h>
#include <lefort/predict/tissue_boundary.h>

#include <algorithm>
#include <span>
#include <utility>

#include "support/shapes.h"

namespace lefort::test {

inline constexpr double kPhantomSide_mm = 40.0;
inline constexpr double kPhantomSkin_mm = 20.0;
inline constexpr double kPhantomBone_mm = 8.0;
inline constexpr double kPhantomNear_mm = 0.8;

struct FacePhantom {
  image::Grid grid;
  image::ScalarVolume soft_tissue_level;
  anatomy::LabelMap labels;
  geometry::TriangleMesh skin_L = make_box({0.0, 0.0, 0.0}, {40.0, 40.0, kPhantomSkin_mm});
  geometry::TriangleMesh segment_L = make_box({0.0, 0.0, 0.0}, {20.0, 40.0, kPhantomBone_mm});
  geometry::TriangleMesh remainder_L = make_box({20.0, 0.0, 0.0}, {40.0, 40.0, kPhantomBone_mm});
};

inline FacePhantom make_face_phantom() {
  FacePhantom phantom;
  phantom.grid.size = {41, 41, 31};
  phantom.soft_tissue_level.grid = phantom.grid;
  phantom.labels.grid = phantom.grid;
  for (Index k = 0; k < 31; ++k)
    for (Index j = 0; j < 41; ++j)
      for (Index i = 0; i < 41; ++i) {
        const double z = double(k);
        const double depth_mm = std::min(kPhantomSkin_mm - z, z - kPhantomBone_mm);
        phantom.soft_tissue_level.values.push_back(
            float(std::clamp(depth_mm, -kPhantomNear_mm, kPhantomNear_mm)));
        phantom.labels.values.push_back(z > kPhantomSkin_mm   ? anatomy::Tissue::kBackground
                                        : z > kPhantomBone_mm ? anatomy::Tissue::kSoftTissue
                                                              : anatomy::Tissue::kBone);
      }
  return phantom;
}

/// The boundary of a mesh of the phantom with its two bones.
///
/// \param zones  where the osteotomies elevate tissue.
[[nodiscard]] inline predict::TissueBoundary find_phantom_boundary(
    mesh::VolumeMesh mesh, const predict::TissueDomain& domain, const FacePhantom& phantom,
    const predict::BoundaryOptions& options, const predict::BoundaryLabelMap* painted = nullptr,
    std::span<const plan::ElevationZone> zones = {}) {
  return predict::find_tissue_boundary(std::move(mesh), domain, phantom.labels, phantom.skin_L,
                                       {.segments_L = {&phantom.segment_L, 1},
                                        .remainder_L = phantom.remainder_L,
                                        .elevation = zones},
                                       options, painted);
}

}  // namespace lefort::test
