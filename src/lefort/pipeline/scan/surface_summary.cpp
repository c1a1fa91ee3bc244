#include <lefort/pipeline/scan/surface_summary.h>

#include <fmt/format.h>

namespace lefort::pipeline {

std::string text_of(const mesh::FinishedSurface& surface) {
  return fmt::format("{} triangles, {}, {} self-intersection{}, P99 {:.2f} mm off the isosurface",
                     surface.mesh_L.triangle_count(), surface.is_closed ? "closed" : "open",
                     surface.self_intersections, surface.self_intersections == 1 ? "" : "s",
                     surface.p99_off_mm);
}

nlohmann::json json_of(const mesh::FinishedSurface& surface) {
  return {{"triangles", surface.mesh_L.triangle_count()},
          {"closed", surface.is_closed},
          {"self_intersections", surface.self_intersections},
          {"p99_off_isosurface_mm", surface.p99_off_mm},
          {"max_off_isosurface_mm", surface.max_off_mm}};
}

}  // namespace lefort::pipeline
