#include <lefort/contact/bone_overlap.h>
#include <lefort/contact/measure_gap.h>
#include <lefort/core/parallel.h>
#include <lefort/io/field_file.h>
#include <lefort/io/read_text.h>
#include <lefort/io/surface_files.h>
#include <lefort/server/case/overlap_service.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <memory>
#include <span>

namespace lefort::server {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMaxCutBytes = 1 << 20;  // Bytes.

/// A file name of the document, if it does not lead out of its folder.
Result<fs::path> plain_name(const nlohmann::json& bone, const char* key) {
  const auto found = bone.find(key);
  if (found != bone.end() && found->is_string()) {
    const fs::path name = found->get<std::string>();
    if (name == name.filename() && name != "." && name != "..") return name;
  }
  return fail(ErrorCode::kFileCorrupt, "cut.json is damaged: cut again");
}

RigidTransform pose_of(const std::string& name, const Poses& poses) {
  const auto pose = poses.find(name);
  return pose == poses.end() ? RigidTransform::Identity() : pose->second;
}

}  // namespace

Result<OverlapService> OverlapService::read(const fs::path& cut_folder, const fs::path& cache) {
  LEFORT_TRY(const std::string text, io::read_text(cut_folder / "cut.json", kMaxCutBytes));
  const auto document = nlohmann::json::parse(text, nullptr, false);
  OverlapService live;
  if (!document.is_object() || !document.contains("bones") || !document["bones"].is_array())
    return fail(ErrorCode::kFileCorrupt, "cut.json is damaged: cut again");
  for (const auto& entry : document["bones"]) {
    if (!entry.is_object() || !entry.contains("name") || !entry["name"].is_string())
      return fail(ErrorCode::kFileCorrupt, "cut.json is damaged: cut again");
    LEFORT_TRY(const fs::path surface, plain_name(entry, "surface"));
    LEFORT_TRY(const fs::path field_name, plain_name(entry, "field"));
    LEFORT_TRY(geometry::TriangleMesh surface_B, io::read_surface(cut_folder / surface));
    LEFORT_TRY(field::DistanceField field, io::read_field(cache / field_name));
    LEFORT_TRY(auto distance_query_B,
               contact::field_distance_query(
                   std::make_shared<const field::DistanceField>(std::move(field)),
                   contact::DetectionMethod::kTrilinear));
    Box3 box_B;
    for (const Vec3& v : surface_B.vertices) box_B.extend(v);
    live.bones_.push_back({entry["name"].get<std::string>(), std::move(surface_B), box_B,
                           std::move(distance_query_B)});
  }
  return live;
}

Result<OverlapService::Depths> OverlapService::depths(const Poses& poses) const {
  for (const auto& [name, pose] : poses)
    if (name.empty() || std::none_of(bones_.begin(), bones_.end(),
                                     [&](const Bone& bone) { return bone.name == name; }))
      return fail(ErrorCode::kInvalidArgument, fmt::format("segment {} was not cut", name));
  Depths depths;
  for (const Bone& moved : bones_) {
    if (moved.name.empty() || !poses.contains(moved.name)) continue;
    const RigidTransform X_LB = poses.at(moved.name);
    const std::vector<Vec3>& vertices_B = moved.surface_B.vertices;
    std::vector<double> deepest_mm(vertices_B.size(), 0.0);
    for (const Bone& other : bones_) {
      if (&other == &moved) continue;
      const RigidTransform X_LO = pose_of(other.name, poses), X_OB = X_LO.inverse() * X_LB;
      // Points outside the other bone's box do not overlap.
      const auto near = parallel_collect<Index>(
          moved.surface_B.vertex_count(), [&](Index v, std::vector<Index>& list) {
            if (other.box_B.contains(X_OB * vertices_B[std::size_t(v)])) list.push_back(v);
          });
      std::vector<Vec3> points_L(near.size());
      parallel_for(Index(near.size()), [&](Index n) {
        points_L[std::size_t(n)] = X_LB * vertices_B[std::size_t(near[std::size_t(n)])];
      });
      std::vector<contact::Gap> gaps(near.size());
      contact::measure_gaps({other.distance_query_B, X_LO}, points_L, contact::Derivatives::kFirst,
                            gaps);
      const double max_distance_mm = other.distance_query_B->max_distance_mm();
      for (std::size_t n = 0; n < near.size(); ++n) {
        const contact::Gap& gap = gaps[n];
        const bool is_known = gap.zone == field::Zone::kBand || gap.zone == field::Zone::kInside;
        if (!is_known || !(-gap.gap_mm > contact::kTouching_mm)) continue;
        double& depth_mm = deepest_mm[std::size_t(near[n])];
        depth_mm = std::max(depth_mm, -gap.gap_mm);
        depths.deepest_mm = std::max(depths.deepest_mm, depth_mm);
        if (-gap.gap_mm >= max_distance_mm) depths.depth_is_lower_bound = true;
      }
    }
    depths.segments.emplace_back(moved.name, moved.surface_B.vertex_count());
    depths.depth_mm.insert(depths.depth_mm.end(), deepest_mm.begin(), deepest_mm.end());
  }
  return depths;
}

}  // namespace lefort::server
