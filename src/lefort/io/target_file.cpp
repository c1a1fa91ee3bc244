#include <lefort/io/internal/validated_json.h>
#include <lefort/io/read_text.h>
#include <lefort/io/surface_files.h>
#include <lefort/io/target_file.h>
#include <lefort/io/target_schema.h>

#include <fmt/format.h>

#include <cstddef>
#include <utility>

namespace lefort::io {
namespace {

using internal::as_vector;
using internal::Json;
using internal::list;
using internal::read;
using internal::section;
namespace fs = std::filesystem;

constexpr std::uintmax_t kMaxTarget = 4 << 20;  // Bytes.

std::optional<Vec3> vector_at(const Json& object, const char* key) {
  if (const auto found = object.find(key); found != object.end()) return as_vector(*found);
  return std::nullopt;
}

std::optional<double> number_at(const Json& object, const char* key) {
  if (const auto found = object.find(key); found != object.end()) return found->get<double>();
  return std::nullopt;
}

Result<inverse::LandmarkSpec> read_landmark(const Json& object) {
  inverse::LandmarkSpec spec{.name = object["name"].get<std::string>(),
                             .at_L = vector_at(object, "at_mm"),
                             .to_L = vector_at(object, "to_mm"),
                             .by_mm = vector_at(object, "by_mm"),
                             .towards_L = vector_at(object, "towards")};
  read(object, "distance_mm", spec.distance_mm);
  read(object, "weight", spec.weight);
  if (spec.towards_L && !(spec.towards_L->norm() > 0.0))
    return fail(ErrorCode::kPlanInvalid,
                fmt::format("landmarks: towards of {} is zero", spec.name));
  return spec;
}

inverse::ProfileSpec read_profile(const Json& object) {
  inverse::ProfileSpec spec{.x_mm = number_at(object, "x_mm")};
  read(object, "name", spec.name);
  for (const Json& point : list(object, "points"))
    spec.points.push_back({.z_mm = point["z_mm"].get<double>(),
                           .y_mm = number_at(point, "y_mm"),
                           .anterior_by_mm = number_at(point, "anterior_by_mm")});
  for (const Json& point : list(object, "polyline_mm"))
    spec.polyline_mm.push_back({point[0].get<double>(), point[1].get<double>()});
  read(object, "spacing_mm", spec.spacing_mm);
  read(object, "weight", spec.weight);
  return spec;
}

Result<inverse::SurfaceTarget> read_surface_target(const Json& object, const fs::path& folder,
                                                   Progress& progress) {
  inverse::SurfaceTarget target;
  const fs::path file = folder / object["file"].get<std::string>();
  target.name = object.value("name", file.stem().string());
  LEFORT_TRY(target.surface_L, read_surface(file, progress));
  if (const auto box = object.find("box_mm"); box != object.end()) {
    const Vec3 a = as_vector((*box)[0]), b = as_vector((*box)[1]);
    target.region_L = Box3(a.cwiseMin(b), a.cwiseMax(b));
  }
  read(object, "max_distance_mm", target.max_distance_mm);
  read(object, "weight", target.weight);
  return target;
}

inverse::BodySpec read_body(const Json& object) {
  inverse::BodySpec spec;
  for (const Json& segment : object["segments"])
    spec.segments.push_back(segment.get<std::string>());
  spec.name = object.value("name", spec.segments.front());
  if (object.value("relative_pose", "plan") == "scan") spec.relative = inverse::RelativePose::kScan;
  spec.center_L = vector_at(object, "center_mm");
  const Json& bounds = section(object, "bounds");
  const auto free = object.find("free");
  if (free != object.end()) spec.is_free.emplace().fill(false);
  for (std::size_t i = 0; i < inverse::kMotionNames.size(); ++i) {
    const std::string name = inverse::kMotionNames[i];
    if (free != object.end())
      for (const Json& one : *free)
        if (one.get<std::string>() == name) (*spec.is_free)[i] = true;
    const std::string key = name + (i < 3 ? "_mm" : "_deg");
    if (const auto found = bounds.find(key); found != bounds.end())
      spec.bounds[i] = {(*found)[0].get<double>(), (*found)[1].get<double>()};
  }
  return spec;
}

}  // namespace

Result<inverse::TargetSpec> parse_target(std::string_view text, const fs::path& folder,
                                         Progress& progress) {
  LEFORT_TRY(const Json target, internal::parse_checked(text, kTargetSchema, "the target"));
  inverse::TargetSpec spec;
  read(target, "title", spec.title);
  for (const Json& one : list(target, "landmarks")) {
    LEFORT_TRY(spec.landmarks.emplace_back(), read_landmark(one));
  }
  for (const Json& one : list(target, "profiles")) spec.profiles.push_back(read_profile(one));
  for (const Json& one : list(target, "surfaces")) {
    LEFORT_TRY(spec.surfaces.emplace_back(), read_surface_target(one, folder, progress));
  }
  for (const Json& one : list(target, "bodies")) spec.bodies.push_back(read_body(one));
  read(section(target, "limits"), "overlap_mm", spec.overlap_mm);
  read(section(target, "regularization"), "weight", spec.regularization);
  if (spec.landmarks.empty() && spec.profiles.empty() && spec.surfaces.empty())
    return fail(ErrorCode::kPlanInvalid,
                "the target is empty: it needs landmarks, profiles or surfaces");
  return spec;
}

Result<TargetText> read_target(const fs::path& file, Progress& progress) {
  LEFORT_TRY(std::string text, read_text(file, kMaxTarget));
  LEFORT_TRY(inverse::TargetSpec target, parse_target(text, file.parent_path(), progress));
  return TargetText{std::move(target), std::move(text)};
}

}  // namespace lefort::io
