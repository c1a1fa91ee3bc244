#include <lefort/dental/check_arch.h>
#include <lefort/geometry/mesh_properties.h>

#include <fmt/format.h>

namespace lefort::dental {

Vec3 mean_vertex(const geometry::TriangleMesh& arch) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& p : arch.vertices) sum += p / double(arch.vertices.size());
  return sum;
}

namespace {

/// Whether triangles face outward: by the vector area of an open surface, by the volume of one that
/// is closed except for small holes, as a plaster cast.
bool faces(const geometry::TriangleMesh& arch, const Vec3& occlusal) {
  constexpr double kOpen = 0.1;  // Vector area over area; of open arches 0.3 and more.
  const Vec3 center = mean_vertex(arch);
  Vec3 vector = Vec3::Zero();
  double area = 0.0, volume = 0.0;
  for (Index t = 0; t < arch.triangle_count(); ++t) {
    const Vec3& a = arch.corner(t, 0);
    const Vec3 normal = (arch.corner(t, 1) - a).cross(arch.corner(t, 2) - a);
    vector += normal;
    area += normal.norm();
    volume += normal.dot(a - center);
  }
  return vector.norm() < kOpen * area ? volume > 0.0 : vector.dot(occlusal) > 0.0;
}

}  // namespace

Result<void> check_arch(const geometry::TriangleMesh& arch, const std::string& name,
                        const Vec3& occlusal) {
  LEFORT_TRY_VOID(geometry::check_surface(arch));
  const double size_mm = geometry::bounding_box(arch).sizes().maxCoeff();
  if (!(size_mm <= kMaxArch_mm))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("the {} arch is {:.0f} mm large, must be {:g} or less: is it in mm?",
                            name, size_mm, kMaxArch_mm));
  const bool is_outward = faces(arch, occlusal);
  if (is_outward) return {};
  return fail(
      ErrorCode::kInvalidArgument,
      fmt::format("the {} arch does not face the other one: are upper and lower swapped, or "
                  "do its triangles face inward?",
                  name));
}

}  // namespace lefort::dental
