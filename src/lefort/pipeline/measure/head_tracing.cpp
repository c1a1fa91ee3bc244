#include <lefort/anatomy/extract_surface.h>
#include <lefort/compare/landmark_displacements.h>
#include <lefort/geometry/plane_section.h>
#include <lefort/geometry/transform_mesh.h>
#include <lefort/io/landmarks_file.h>
#include <lefort/io/surface_files.h>
#include <lefort/pipeline/measure/head_tracing.h>

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

namespace lefort::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr report::Rgb kTracedBone{0.25, 0.65, 1.0}, kTracedSkin{0.2, 0.9, 0.6};
constexpr report::Rgb kTracedBoneAfter{1.0, 0.55, 0.1}, kTracedSkinAfter{1.0, 0.25, 0.35};

/// The section with a plane normal to the left axis.
void add_section(const geometry::TriangleMesh& mesh_L, const LateralView& view, double left_mm,
                 report::Tracing& tracing) {
  // Frame F: x to the left, y to posterior, z to superior; the origin is the center of the view.
  RigidTransform X_FL = RigidTransform::Identity();
  X_FL.linear() << view.directions.left_L.transpose(), -view.directions.anterior_L.transpose(),
      view.directions.superior_L.transpose();
  X_FL.translation() = -(X_FL.linear() * view.center_L);
  const RigidTransform X_LF = X_FL.inverse();
  for (const auto& [from_F, to_F] :
       geometry::plane_section(geometry::transformed(mesh_L, X_FL), 0, left_mm))
    tracing.lines.push_back({view.pixel_of(X_LF * from_F), view.pixel_of(X_LF * to_F)});
}

/// Names of the bones that `lefort plan check` wrote.
std::vector<fs::path> bone_files(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (name == "remainder.vtp" || (name.starts_with("segment_") && name.ends_with(".vtp")))
      files.push_back(entry->path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

Eigen::Vector2d LateralView::pixel_of(const Vec3& p_L) const {
  const Vec3 d = p_L - center_L;
  return {0.5 * columns + directions.anterior_L.dot(d) / pixel_mm,
          0.5 * rows - directions.superior_L.dot(d) / pixel_mm};
}

Result<HeadAfter> read_after(const CephalogramJob& job, const plan::Landmarks& landmarks,
                             Progress& progress) {
  HeadAfter after;
  if (job.check) {
    for (const fs::path& file : bone_files(*job.check)) {
      LEFORT_TRY(geometry::TriangleMesh bone_L, io::read_surface(file, progress));
      after.bones_L.push_back(std::move(bone_L));
    }
    if (after.bones_L.empty())
      return fail(ErrorCode::kFileNotFound,
                  fmt::format("{} has no bones of `lefort plan check`", job.check->string()));
    const fs::path moved = *job.check / "landmarks_after.mrk.json";
    if (fs::exists(moved)) {
      LEFORT_TRY(after.landmarks, io::read_landmarks(moved));
    }
  }
  if (job.prediction) {
    LEFORT_TRY(const geometry::TriangleMesh before_L,
               io::read_surface(*job.prediction / "skin_before.vtp", progress));
    LEFORT_TRY(after.skin_L, io::read_surface(*job.prediction / "predicted_skin.vtp", progress));
    LEFORT_TRY(const plan::Landmarks soft,
               compare::displace_landmarks(landmarks, before_L, after.skin_L));
    after.landmarks.insert(after.landmarks.end(), soft.begin(), soft.end());
  }
  return after;
}

Result<std::vector<report::Tracing>> trace_head(const OrientedHead& head, const HeadAfter& after,
                                                const LateralView& view, Progress& progress) {
  const image::CtVolume& ct = head.scanned.scan.ct;
  const auto& [labels, levels] = std::tie(head.scanned.labels, head.scanned.levels);
  std::vector<report::Tracing> tracings{{"bone before surgery", kTracedBone},
                                        {"skin before surgery", kTracedSkin}};
  LEFORT_TRY(const geometry::TriangleMesh bone_L,
             anatomy::extract_isosurface(
                 anatomy::bone_level(ct, labels, anatomy::Cavities::kKeep, levels), {}, progress));
  LEFORT_TRY(const geometry::TriangleMesh skin_L,
             anatomy::extract_isosurface(anatomy::skin_level(ct, labels, levels), {}, progress));
  add_section(bone_L, view, 0.0, tracings[0]);
  add_section(skin_L, view, 0.0, tracings[1]);
  if (!after.bones_L.empty()) {
    tracings.push_back({"bone after surgery", kTracedBoneAfter});
    for (const geometry::TriangleMesh& one_L : after.bones_L)
      add_section(one_L, view, 0.0, tracings.back());
  }
  if (!after.skin_L.triangles.empty()) {
    tracings.push_back({"skin after surgery", kTracedSkinAfter});
    add_section(after.skin_L, view, 0.0, tracings.back());
  }
  return tracings;
}

}  // namespace lefort::pipeline
