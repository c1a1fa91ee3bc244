#include <lefort/dental/check_arch.h>
#include <lefort/geometry/mesh_properties.h>

#include <fmt/format.h>

namespace lefort::dental {

Vec3 mean_vertex(const geometry::TriangleMesh& arch) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& p : arch.vertices) sum += p / double(arch.vertices.size());
  return sum;
}

Result<void> check_arch(const geometry::TriangleMesh& arch, const std::string& name,
                        const Vec3& occlusal) {
  LEFORT_TRY_VOID(geometry::check_surface(arch));
  const double size_mm = geometry::bounding_box(arch).sizes().maxCoeff();
  if (!(size_mm <= kMaxArch_mm))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("the {} arch is {:.0f} mm large, must be {:g} or less: is it in mm?",
                            name, size_mm, kMaxArch_mm));
  Vec3 area = Vec3::Zero();
  for (Index t = 0; t < arch.triangle_count(); ++t)
    area +=
        0.5 * (arch.corner(t, 1) - arch.corner(t, 0)).cross(arch.corner(t, 2) - arch.corner(t, 0));
  const bool is_outward = geometry::is_closed(arch) ? geometry::signed_volume_mm3(arch) > 0.0
                                                    : area.dot(occlusal) > 0.0;
  if (is_outward) return {};
  return fail(
      ErrorCode::kInvalidArgument,
      fmt::format("the {} arch does not face the other one: are upper and lower swapped, or "
                  "do its triangles face inward?",
                  name));
}

}  // namespace lefort::dental
