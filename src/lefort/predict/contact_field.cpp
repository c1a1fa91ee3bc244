#include <lefort/field/build/build_distance_field.h>
#include <lefort/geometry/mesh_properties.h>
#include <lefort/predict/contact_field.h>
#include <lefort/predict/load_levels.h>

#include <algorithm>

namespace lefort::predict {
namespace {

/// Penetration that a trial state of Newton's method may have.
constexpr double kContactBand_mm = 3.0;
constexpr double kRestDepthFraction = 0.5;  // Of an element: the chord height of a curved face.
constexpr double kMaxExtentFraction = 0.4;  // A quarter of the cube is the widest band.

}  // namespace

double contact_band_mm(const TissueOptions& tissue, Obstacle obstacle) {
  return kContactBand_mm +
         (kRestDepthFraction + 0.5 * increment_element_fraction(obstacle)) * tissue.element_size_mm;
}

field::DistanceFieldOptions contact_field_options(field::DistanceFieldOptions options,
                                                  const geometry::TriangleMesh& surface_B,
                                                  const TissueOptions& tissue, Obstacle obstacle) {
  if (options.band_mm > 0.0 || options.side_mm > 0.0 || surface_B.vertices.empty()) return options;
  const double extent_mm = geometry::bounding_box(surface_B).sizes().maxCoeff();
  const double wanted_mm = contact_band_mm(tissue, obstacle);
  if (field::default_band_mm(options.resolution, extent_mm) >= wanted_mm) return options;
  options.band_mm = std::min(wanted_mm, kMaxExtentFraction * extent_mm);
  return options;
}

}  // namespace lefort::predict
