#include <lefort/core/units.h>
#include <lefort/geometry/rigid_path.h>
#include <lefort/io/internal/read_segments.h>
#include <lefort/io/landmarks_file.h>
#include <lefort/io/markups_file.h>
#include <lefort/io/nerve_file.h>
#include <lefort/io/transform_file.h>
#include <lefort/plan/condylar_axis.h>
#include <lefort/plan/make_keyframes.h>
#include <lefort/plan/osteotomy_template.h>

#include <fmt/format.h>

#include <string>
#include <utility>

namespace lefort::io::internal {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxPoints = 1000;  // Of a curve, as in contract/plan.schema.json.

/// What a part of the plan is read with.
struct Context {
  const plan::Landmarks& landmarks;
  const fs::path& folder;
  std::optional<Vec3> anchor_L{};  ///< The middle of what the segment holds.
};

tl::unexpected<Error> bad(const std::string& key, const std::string& what) {
  return fail(ErrorCode::kPlanInvalid, fmt::format("{}: {}", key, what));
}

Result<Vec3> landmark_of(const std::string& name, const std::string& key, const Context& context) {
  const auto point = plan::find_landmark(context.landmarks, name);
  if (!point) return bad(key, fmt::format("the plan has no landmark {}", name));
  return *point;
}

/// A point, or the name of a landmark.
Result<Vec3> point_of(const Json& json, const std::string& key, const Context& context) {
  if (json.is_string()) return landmark_of(json.get<std::string>(), key, context);
  return as_vector(json);
}

Result<Vec3> direction_of(const Json& json, const std::string& key) {
  const Vec3 vector = as_vector(json);
  const double length = vector.norm();
  if (!(length > 1e-9)) return bad(key, "the vector is zero");
  return Vec3(vector / length);
}

/// The markup of a type in a file: the one there is, or the one of that name.
Result<Markup> read_one(const fs::path& file, const char* type, const char* in_words,
                        const std::optional<std::string>& name, const std::string& key) {
  LEFORT_TRY(std::vector<Markup> markups, read_markups(file));
  Markup* found = nullptr;
  for (Markup& markup : markups) {
    if (markup.type != type || (name && markup.name != *name)) continue;
    if (found != nullptr)
      return bad(key, fmt::format("{} holds several {}s{}, must be one", file.string(), in_words,
                                  name ? " of that name" : ""));
    found = &markup;
  }
  if (found == nullptr)
    return bad(
        key, fmt::format("{} holds no {}{}", file.string(), in_words, name ? " of that name" : ""));
  return std::move(*found);
}

std::optional<std::string> name_in(const Json& json) {
  if (!json.contains("name")) return std::nullopt;
  return json["name"].get<std::string>();
}

/// A plane of Slicer: its normal points to the segment unless it is turned round.
Result<plan::CutPlane> read_plane_file(const Json& json, const std::string& key,
                                       const Context& context) {
  for (const char* of_numbers : {"point_mm", "towards_segment", "size_mm", "across"})
    if (json.contains(of_numbers))
      return bad(key, fmt::format("file and {} stand together, must be one of them", of_numbers));
  const fs::path file = context.folder / json["file"].get<std::string>();
  LEFORT_TRY(const Markup markup, read_one(file, "Plane", "plane", name_in(json), key));
  if (!markup.plane)
    return bad(key, fmt::format("the plane in {} has no center and normal; save it with Slicer 5",
                                file.string()));
  const MarkupPlane& plane_in_file = *markup.plane;
  plan::CutPlane plane{plane_in_file.center_L, json.value("flip", false)
                                                   ? Vec3(-plane_in_file.normal_L)
                                                   : plane_in_file.normal_L};
  if (!json.value("bounded", false)) return plane;
  if (!(plane_in_file.width_mm > 0.0 && plane_in_file.height_mm > 0.0))
    return bad(key, fmt::format("the plane in {} has no size to bound it", file.string()));
  plane.bounds =
      plan::PlaneBounds{plane_in_file.across_L, plane_in_file.width_mm, plane_in_file.height_mm};
  return plane;
}

Result<plan::CutPlane> read_plane(const Json& json, const std::string& key,
                                  const Context& context) {
  if (json.contains("file")) return read_plane_file(json, key, context);
  for (const char* of_file : {"name", "flip", "bounded"})
    if (json.contains(of_file))
      return bad(key, fmt::format("{} is of planes from a file", of_file));
  if (!json.contains("point_mm") || !json.contains("towards_segment"))
    return bad(key, "must have either point_mm and towards_segment, or file");
  plan::CutPlane plane{as_vector(json["point_mm"]), Vec3::Zero()};
  LEFORT_TRY(plane.normal_L, direction_of(json["towards_segment"], key + ".towards_segment"));
  if (json.contains("size_mm") != json.contains("across"))
    return bad(key, "size_mm and across bound the plane together, one is missing");
  if (!json.contains("size_mm")) return plane;
  plan::PlaneBounds bounds{Vec3::Zero(), json["size_mm"][0].get<double>(),
                           json["size_mm"][1].get<double>()};
  LEFORT_TRY(bounds.across_L, direction_of(json["across"], key + ".across"));
  plane.bounds = bounds;
  return plane;
}

Result<std::vector<Vec3>> read_curve_file(const Json& json, const std::string& key,
                                          const Context& context) {
  const fs::path file = context.folder / json["file"].get<std::string>();
  LEFORT_TRY(const Markup curve, read_one(file, "ClosedCurve", "closed curve", name_in(json), key));
  if (curve.points.size() > kMaxPoints)
    return bad(key, fmt::format("{} has {} points, at most {} are read", file.string(),
                                curve.points.size(), kMaxPoints));
  std::vector<Vec3> points;
  for (const plan::Landmark& point : curve.points) points.push_back(point.point_L);
  return points;
}

Result<plan::CutCurve> read_curve(const Json& json, const std::string& key,
                                  const Context& context) {
  plan::CutCurve curve{};
  LEFORT_TRY(curve.direction_L, direction_of(json["along"], key + ".along"));
  if (json.contains("depth_mm")) curve.depth_mm = json["depth_mm"].get<double>();
  if (json.contains("points_mm") == json.contains("file"))
    return bad(key, "must have either points_mm or file");
  if (json.contains("file")) {
    LEFORT_TRY(curve.points_L, read_curve_file(json, key, context));
    return curve;
  }
  if (json.contains("name")) return bad(key, "name is of curves from a file");
  for (const Json& point : json["points_mm"]) curve.points_L.push_back(as_vector(point));
  return curve;
}

Result<plan::CutRegion> read_region(const Json& json, const std::string& key,
                                    const Context& context) {
  plan::CutRegion region;
  for (const Json& one : list(json, "planes")) {
    LEFORT_TRY(const plan::CutPlane plane,
               read_plane(one, fmt::format("{}.planes[{}]", key, region.planes.size()), context));
    region.planes.push_back(plane);
  }
  for (const Json& one : list(json, "curves")) {
    LEFORT_TRY(plan::CutCurve curve,
               read_curve(one, fmt::format("{}.curves[{}]", key, region.curves.size()), context));
    region.curves.push_back(std::move(curve));
  }
  return region;
}

Result<plan::Osteotomy> from_template(const Json& json, const std::string& name,
                                      const std::string& key, double kerf_mm,
                                      const Context& context) {
  const auto kind = plan::find_template(
      (json.is_string() ? json : json["kind"]).get<std::string>());  // The schema lists them.
  if (!kind) return bad(key, "there is no such template");
  plan::TemplateOptions options;
  if (json.is_object()) {
    read(json, "above_palate_mm", options.above_palate_mm);
    read(json, "behind_palate_mm", options.behind_palate_mm);
    read(json, "behind_rim_mm", options.behind_rim_mm);
    read(json, "above_pogonion_mm", options.above_pogonion_mm);
    read(json, "split_depth_mm", options.split_depth_mm);
    read(json, "behind_molar_mm", options.behind_molar_mm);
    read(json, "nerve_clearance_mm", options.canal_clearance_mm);
    options.canal_clearance_mm += kerf_mm;
  }
  if (json.is_object() && json.contains("nerve")) {
    if (*kind != plan::OsteotomyTemplate::kSagittalSplit)
      return bad(key + ".nerve", "is of the template sagittal-split");
    LEFORT_TRY(const Nerves nerves, read_nerves(context.folder / json["nerve"].get<std::string>()));
    for (const predict::NerveTube& tube : nerves.canals)
      options.canals.push_back({tube.line_L, tube.radius_mm});
  }
  return plan::make_osteotomy(*kind, name, context.landmarks, options);
}

Result<plan::Osteotomy> read_osteotomy(const Json& json, const std::string& name,
                                       const std::string& key, const Context& context) {
  plan::Osteotomy osteotomy;
  const bool has_cuts =
      json.contains("planes") || json.contains("curves") || json.contains("additional_regions");
  if (json.contains("bone") || json.contains("piece_at")) {
    if (has_cuts || json.contains("template") || json.contains("kerf_mm") ||
        json.contains("anchor_points") || (json.contains("bone") && json.contains("piece_at")))
      return bad(key,
                 "bone and piece_at move a whole bone: the other, planes, curves, "
                 "additional_regions, template, kerf_mm and anchor_points are not allowed");
    osteotomy.segment = name;
    return osteotomy;
  }
  if (json.contains("template")) {
    if (has_cuts) return bad(key, "a template excludes planes, curves and additional_regions");
    LEFORT_TRY(osteotomy, from_template(json["template"], name, key + ".template",
                                        json.value("kerf_mm", 0.0), context));
  } else {
    if (!json.contains("planes") && !json.contains("curves"))
      return bad(key, "must have planes, curves, a template or a bone");
    LEFORT_TRY(plan::CutRegion first, read_region(json, key, context));
    osteotomy.planes = std::move(first.planes);
    osteotomy.curves = std::move(first.curves);
    for (const Json& one : list(json, "additional_regions")) {
      LEFORT_TRY(plan::CutRegion region,
                 read_region(one,
                             fmt::format("{}.additional_regions[{}]", key,
                                         osteotomy.additional_regions.size()),
                             context));
      osteotomy.additional_regions.push_back(std::move(region));
    }
  }
  osteotomy.segment = name;
  read(json, "kerf_mm", osteotomy.kerf_mm);
  if (json.contains("anchor_points")) osteotomy.anchor_points_L.clear();
  for (const Json& point : list(json, "anchor_points")) {
    LEFORT_TRY(const Vec3 anchor, point_of(point, key + ".anchor_points", context));
    osteotomy.anchor_points_L.push_back(anchor);
  }
  return osteotomy;
}

/// Targets by name: in the plan, or a landmarks file.
Result<geometry::Keyframe> aim(const Json& json, const std::string& key, const Context& context) {
  constexpr double kTolerance_mm = 1.0;
  LEFORT_TRY(const plan::Landmarks targets, read_plan_landmarks(json["targets"], context.folder));
  auto keyframe = plan::keyframe_to_targets(context.landmarks, targets,
                                            json.value("tolerance_mm", kTolerance_mm));
  if (!keyframe) return bad(key, keyframe.error().message);
  return keyframe;
}

/// \param center_L  What the plan says it is about; else what the segment holds.
Result<geometry::Keyframe> read_pose_file(const Json& json, const std::string& key,
                                          const std::optional<Vec3>& center_L,
                                          const Context& context) {
  LEFORT_TRY(const RigidTransform X_LB,
             read_transform(context.folder / json["transform"].get<std::string>()));
  if (!center_L && !context.anchor_L)
    return bad(key,
               "a transform needs about or about_mm, the rotation center, if the osteotomy has no "
               "anchor_points");
  return plan::keyframe_of_pose(X_LB, center_L ? *center_L : *context.anchor_L);
}

/// The center of rotation: a landmark of the plan, or the center of a condyle.
Result<Vec3> center_of(const std::string& name, const std::string& key, const Context& context) {
  const bool is_right = name == "condyle-R";
  if (!is_right && name != "condyle-L") return landmark_of(name, key, context);
  const auto axis = plan::condylar_axis(context.landmarks);
  if (!axis) return bad(key, axis.error().message);
  return is_right ? axis->right_L : axis->left_L;
}

/// The keyframe after autorotation of the mandible by `autorotate`.
Result<geometry::Keyframe> autorotated(const Json& json, const std::string& key,
                                       geometry::Keyframe keyframe, bool has_center,
                                       const Context& context) {
  const Json& turn = json["autorotate"];
  const std::string turn_key = key + ".autorotate";
  if (turn.contains("closing_deg") + turn.contains("gap_mm") + turn.contains("as") != 1)
    return bad(turn_key, "must have either closing_deg or gap_mm, or as");
  if (turn.contains("to") && !turn.contains("gap_mm")) return bad(turn_key, "to is of gap_mm");
  if (!turn.contains("closing_deg"))
    return bad(
        turn_key,
        "gap_mm and as are for `lefort plan check` and `lefort predict` with a scan; here, use "
        "closing_deg");
  const auto axis = plan::condylar_axis(context.landmarks);
  if (!axis) return bad(turn_key, axis.error().message);
  if (!has_center) keyframe.center_L = axis->middle_L();
  return plan::after_autorotation(*axis, turn["closing_deg"].get<double>(), keyframe);
}

Result<geometry::Keyframe> read_keyframe(const Json& json, const std::string& key,
                                         const Context& context) {
  const bool is_aimed = json.contains("targets"), is_file = json.contains("transform");
  const bool is_stated = json.contains("translation_mm") || json.contains("rotation_deg");
  if (int(is_aimed) + int(is_file) + int(is_stated) > 1)
    return bad(key, "must have one of targets, transform, or translation_mm and rotation_deg");
  if (json.contains("about") && json.contains("about_mm"))
    return bad(key, "must have one of about and about_mm");
  if (json.contains("tolerance_mm") && !is_aimed) return bad(key, "tolerance_mm is of targets");
  const bool is_autorotated = json.contains("autorotate");
  if (is_autorotated && (is_aimed || is_file))
    return bad(key, "autorotate excludes targets and transform");
  geometry::Keyframe keyframe = read_keyframes(Json::array({json}), "path_fraction").front();
  const double at = keyframe.path_fraction;
  std::optional<Vec3> center_L;
  if (json.contains("about_mm")) center_L = keyframe.center_L;
  if (json.contains("about")) {
    LEFORT_TRY(center_L, center_of(json["about"].get<std::string>(), key + ".about", context));
  }
  if (is_aimed) {
    LEFORT_TRY(keyframe, aim(json, key, context));
  } else if (is_file) {
    LEFORT_TRY(keyframe, read_pose_file(json, key, center_L, context));
  }
  if (center_L && is_aimed) {  // The same pose, by another way.
    const geometry::RigidPath one{.segment = {}, .keyframes = {keyframe}};
    keyframe = plan::keyframe_of_pose(geometry::pose_at(one, keyframe.path_fraction), *center_L);
  } else if (center_L && !is_file) {
    keyframe.center_L = *center_L;
  }
  if (is_autorotated) {
    LEFORT_TRY(keyframe, autorotated(json, key, keyframe, center_L.has_value(), context));
  }
  keyframe.path_fraction = at;
  return keyframe;
}

Result<std::vector<geometry::Keyframe>> read_distraction(const Json& phases, const std::string& key,
                                                         int& days) {
  std::vector<plan::DistractionPhase> read_phases;
  for (const Json& json : phases)
    read_phases.push_back(
        {as_vector(json["towards"]), json["mm_per_day"].get<double>(), json["days"].get<int>()});
  auto keyframes = plan::distraction_keyframes(read_phases);
  if (!keyframes) return bad(key, keyframes.error().message);
  days = plan::total_days(read_phases);
  return keyframes;
}

Result<geometry::RigidPath> read_path(const Json& json, const std::string& name,
                                      const std::string& key, const Context& context) {
  geometry::RigidPath path;
  path.segment = name;
  if (json.value("interpolation", "straight") == "screw")
    path.interpolation = geometry::Interpolation::kScrew;
  if (json.contains("keyframes") == json.contains("distraction"))
    return bad(key, "must have either keyframes or distraction");
  if (json.contains("distraction")) {
    LEFORT_TRY(path.keyframes,
               read_distraction(json["distraction"], key + ".distraction", path.steps));
  } else {
    for (const Json& one : json["keyframes"]) {
      LEFORT_TRY(
          const geometry::Keyframe keyframe,
          read_keyframe(one, fmt::format("{}.keyframes[{}]", key, path.keyframes.size()), context));
      path.keyframes.push_back(keyframe);
    }
  }
  read(json, "steps", path.steps);
  LEFORT_TRY_VOID(geometry::check_path(path));
  return path;
}

std::optional<Vec3> middle_of(const std::vector<Vec3>& points) {
  if (points.empty()) return std::nullopt;
  Vec3 sum = Vec3::Zero();
  for (const Vec3& p : points) sum += p;
  return Vec3(sum / double(points.size()));
}

}  // namespace

Result<plan::Landmarks> read_plan_landmarks(const Json& json, const fs::path& folder) {
  if (json.is_string()) return read_landmarks(folder / json.get<std::string>());
  plan::Landmarks landmarks;
  for (const auto& [name, point] : json.items()) landmarks.push_back({name, as_vector(point)});
  auto checked = checked_landmarks(std::move(landmarks));
  if (!checked) return fail(ErrorCode::kPlanInvalid, checked.error().message);
  return checked;
}

Result<std::vector<plan::PlannedSegment>> read_segments(const Json& segments,
                                                        const plan::Landmarks& landmarks,
                                                        const fs::path& folder) {
  const Context context{landmarks, folder};
  std::vector<plan::PlannedSegment> planned;
  for (const Json& json : segments) {
    const std::string key = fmt::format("segments[{}]", planned.size());
    const auto name = json["name"].get<std::string>();
    plan::PlannedSegment one;
    LEFORT_TRY(one.osteotomy, read_osteotomy(json["osteotomy"], name, key + ".osteotomy", context));
    one.is_whole_mandible = json["osteotomy"].contains("bone");  // The schema knows no other bone.
    if (json["osteotomy"].contains("piece_at")) {
      LEFORT_TRY(one.piece_at_L,
                 point_of(json["osteotomy"]["piece_at"], key + ".osteotomy.piece_at", context));
    }
    read(json["osteotomy"], "min_piece_ml", one.cut.min_piece_ml);
    read(json["osteotomy"], "min_piece_fraction", one.cut.min_piece_fraction);
    read(json, "cut_from", one.cut_from);
    const Context of_segment{landmarks, folder, middle_of(one.osteotomy.anchor_points_L)};
    LEFORT_TRY(one.path, read_path(json["path"], name, key + ".path", of_segment));
    one.is_distracted = json["path"].contains("distraction");
    planned.push_back(std::move(one));
  }
  LEFORT_TRY_VOID(plan::check_segments(planned));
  return planned;
}

}  // namespace lefort::io::internal
