#include <lefort/anatomy/find_teeth.h>
#include <lefort/core/version.h>
#include <lefort/geometry/mesh_properties.h>
#include <lefort/io/deprecated_keys.h>
#include <lefort/io/landmarks_file.h>
#include <lefort/io/output_folder.h>
#include <lefort/io/plan_inputs.h>
#include <lefort/io/read_text.h>
#include <lefort/io/surface_files.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/dental/dental_json.h>
#include <lefort/pipeline/dental/dental_numbers.h>
#include <lefort/pipeline/guide.h>
#include <lefort/pipeline/json/json_values.h>
#include <lefort/pipeline/plan/nerve_file.h>
#include <lefort/pipeline/plan/screw_clearance.h>
#include <lefort/pipeline/prepare/find_head_landmarks.h>
#include <lefort/pipeline/prepare/load_head.h>
#include <lefort/plan/cut_solid.h>
#include <lefort/plan/elevation_zone.h>
#include <lefort/plan/head_directions.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace lefort::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr const char* kGuidesFile = "guides.json";
constexpr const char* kHolesBefore = "holes_before.mrk.json";
constexpr const char* kHolesAfter = "holes_after.mrk.json";
/// A shorter line needs no guide.
constexpr double kMinLine_mm = 12.0;
/// A guide that touches more than this on its way does not fit.
constexpr double kMaxPenetration_mm = 0.1;
/// Beyond this from the midline a guide is named by its side.
constexpr double kMiddle_mm = 5.0;

struct View {
  std::string name;
  Vec3 outward_L;
};

/// What all guides of a plan have in common.
struct GuideHead {
  io::PlanFile plan;
  plan::HeadDirections directions;
  geometry::Bvh bone;
  plan::CutSegments cut;
  std::vector<geometry::Bvh> pieces;  ///< The segments after all cuts, then the remainder.
  geometry::Bvh cut_faces;            ///< Of all cuts.
  anatomy::ToothMap teeth;
  std::optional<dental::NumberedTeeth> numbers;
  io::Nerves nerves;
};

struct NamedHole {
  std::string name;
  dental::GuideHole hole;
  std::string bone;                                  ///< The segment that it is in, or "remainder".
  RigidTransform X_LB = RigidTransform::Identity();  ///< Of that bone.
  ScrewNeighbor neighbor;
};

struct NamedGuide {
  std::string name, segment, view;
  dental::Guide guide;
  std::vector<NamedHole> holes;
  int wanted_holes = 0;
};

Result<std::vector<View>> views_of(const std::string& from, const plan::Osteotomy& osteotomy,
                                   const plan::HeadDirections& directions) {
  const View right{"right", -directions.left_L}, left{"left", directions.left_L},
      anterior{"anterior", directions.anterior_L}, inferior{"inferior", -directions.superior_L};
  for (const View& one : {right, left, anterior, inferior})
    if (from == one.name) return std::vector{one};
  if (!from.empty())
    return fail(
        ErrorCode::kInvalidArgument,
        fmt::format("`{}` is no side of a guide, must be anterior, right, left or inferior", from));
  if (osteotomy.procedure == plan::OsteotomyTemplate::kSagittalSplit)
    return std::vector{right, left};
  return std::vector{anterior};
}

bool is_cut(const plan::PlannedSegment& one) {
  return !one.is_whole_mandible && !one.piece_at_L && !plan::is_of_sheets(one.osteotomy);
}

/// The segments that get guides.
Result<std::vector<std::size_t>> wanted_segments(const io::PlanFile& plan,
                                                 const std::string& name) {
  std::vector<std::size_t> wanted;
  for (std::size_t k = 0; k < plan.segments.size(); ++k) {
    if (!name.empty() && plan.segments[k].osteotomy.segment != name) continue;
    if (is_cut(plan.segments[k])) {
      wanted.push_back(k);
    } else if (!name.empty()) {
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("segment '{}' is not cut by planes or curves without bounds, which a "
                              "guide needs",
                              name));
    }
  }
  if (wanted.empty())
    return fail(ErrorCode::kPlanInvalid,
                name.empty() ? std::string("no segment of the plan is cut by planes or curves")
                             : fmt::format("the plan has no segment '{}'", name));
  return wanted;
}

bool has_teeth(const anatomy::ToothMap& teeth) {
  return std::any_of(teeth.values.begin(), teeth.values.end(),
                     [](anatomy::Tooth one) { return one != anatomy::Tooth::kNone; });
}

/// The piece of bone in which a screw holds: the one that contains the points of its axis. Nothing
/// if they are in several pieces, or the first one is in none.
std::optional<std::size_t> piece_of_screw(const GuideHead& head, const Vec3& entry_L,
                                          const Vec3& tip_L) {
  constexpr double kStep_mm = 0.5;
  const int steps = int(std::ceil((tip_L - entry_L).norm() / kStep_mm));
  std::optional<std::size_t> found;
  for (int n = 1; n <= steps; ++n) {
    const Vec3 p_L = entry_L + double(n) / steps * (tip_L - entry_L);
    for (std::size_t piece = 0; piece < head.pieces.size(); ++piece) {
      if (head.pieces[piece].signed_distance(p_L).distance_mm >= 0.0) continue;
      if (found && *found != piece) return std::nullopt;
      found = piece;
    }
    if (!found) return std::nullopt;
  }
  return found;
}

/// Distance of the axis of a screw from roots and nerves; negative if it would hold in several
/// pieces of bone, or in none, or its surface would be closer than half a millimeter to a cut.
double clear_of_screw(const GuideHead& head, const ScrewClearance& clearance, double screw_mm,
                      const Vec3& entry_L, const Vec3& tip_L) {
  constexpr double kFromCut_mm = 0.5, kStep_mm = 1.0;
  const int steps = int(std::ceil((tip_L - entry_L).norm() / kStep_mm));
  for (int n = 0; n <= steps; ++n)
    if (head.cut_faces.closest_point(entry_L + double(n) / steps * (tip_L - entry_L),
                                     0.5 * screw_mm + kFromCut_mm))
      return -1.0;
  if (!piece_of_screw(head, entry_L, tip_L)) return -1.0;
  return clearance.closest(entry_L, tip_L).distance_mm;
}

/// Reports what holes are not compared with.
void note_unknown(const GuideJob& job, const anatomy::ToothMap& teeth, Progress& progress) {
  if (!has_teeth(teeth))
    progress.note("warning: no teeth are found: holes are not compared with roots");
  if (!job.nerve)
    progress.note("no --nerve is given: holes are not compared with the canals of the nerves");
}

/// All faces of the cuts.
geometry::TriangleMesh all_cut_faces(const plan::CutSegments& cut, const io::PlanFile& plan) {
  geometry::TriangleMesh faces_L;
  for (const geometry::TriangleMesh& segment_L : cut.segments_L)
    for (const plan::PlannedSegment& one : plan.segments)
      if (is_cut(one)) plan::append(faces_L, plan::cut_faces(segment_L, one.osteotomy));
  return faces_L;
}

Result<GuideHead> read_head(const GuideJob& job, Progress& progress) {
  const StageCache cache(job.cache.value_or(job.output / "cache"));
  LEFORT_TRY(io::PlanText text, read_plan_of_scan(job.plan, job.ct, cache, progress));
  io::note_warnings(text.plan.warnings, progress);
  LEFORT_TRY_VOID(wanted_segments(text.plan, job.segment));
  LEFORT_TRY(io::Nerves nerves, read_given_nerves(job.nerve, progress));
  LEFORT_TRY(const plan::HeadDirections directions, plan::head_directions(text.plan.landmarks));
  LEFORT_TRY(const fs::path ct, io::scan_of(job.plan, text.plan, job.ct));
  LEFORT_TRY(ScannedHead head, scan_head(text.plan, ct, cache, progress));
  LEFORT_TRY_VOID(check_same_scan(nerves, head.ct_sha256));
  LEFORT_TRY_VOID(
      check_canals_of_plan(text.json, job.plan.parent_path(), head.ct_sha256, progress));
  progress.begin_stage("cut the bone");
  LEFORT_TRY(plan::CutSegments cut,
             plan::cut_segments(head.skull_L, head.mandible(), text.plan.segments, progress));
  progress.begin_stage("find teeth");
  anatomy::ToothMap teeth{head.labels.grid, {}};
  if (has_mandible(head.labels))
    teeth = anatomy::find_teeth(head.scan.ct, head.labels, head.levels.bone_hu);
  std::optional<dental::NumberedTeeth> numbers;
  if (!teeth.values.empty()) {
    LEFORT_TRY(numbers, corrected_numbers(teeth, text.plan.landmarks, job.tooth_corrections));
  }
  note_unknown(job, teeth, progress);
  if (head.mandible_L) plan::append(head.skull_L, *head.mandible_L);
  std::vector<geometry::Bvh> pieces(cut.segments_L.begin(), cut.segments_L.end());
  pieces.emplace_back(cut.remainder_L);
  geometry::Bvh faces(all_cut_faces(cut, text.plan));
  return GuideHead{std::move(text.plan), directions,         geometry::Bvh(std::move(head.skull_L)),
                   std::move(cut),       std::move(pieces),  std::move(faces),
                   std::move(teeth),     std::move(numbers), std::move(nerves)};
}

/// "right", "left", or "middle".
std::string side_of(const dental::CutLine& line, const GuideHead& head) {
  Vec3 midline_L = geometry::bounding_box(head.bone.mesh()).center();
  for (const char* const name : {"Me", "ANS", "N"})
    if (const auto at_L = plan::find_landmark(head.plan.landmarks, name)) midline_L = *at_L;
  Vec3 mean_L = Vec3::Zero();
  for (const Vec3& p_L : line.points_L) mean_L += p_L / double(line.points_L.size());
  const double left_mm = head.directions.left_L.dot(mean_L - midline_L);
  if (std::abs(left_mm) < kMiddle_mm) return "middle";
  return left_mm > 0.0 ? "left" : "right";
}

NamedHole named_hole(const dental::GuideHole& hole, std::size_t number, const NamedGuide& guide,
                     const GuideHead& head, const ScrewClearance& clearance,
                     const dental::HoleOptions& options) {
  NamedHole one;
  one.hole = hole;
  const Vec3 tip_L = hole.point_L - options.depth_mm * hole.axis_L;
  const std::size_t piece = piece_of_screw(head, hole.point_L, tip_L).value();
  const bool is_segment = piece < head.plan.segments.size();
  one.bone = is_segment ? head.plan.segments[piece].osteotomy.segment : "remainder";
  if (is_segment) one.X_LB = geometry::pose_at(head.plan.segments[piece].path, 1.0);
  one.name = fmt::format("{} {} in {}", guide.name, number, one.bone);
  one.neighbor = clearance.closest(hole.point_L, tip_L);
  one.neighbor.distance_mm -= 0.5 * options.screw_mm;
  return one;
}

Result<NamedGuide> guide_of(const GuideJob& job, const GuideHead& head, std::size_t segment,
                            const View& view, const dental::GuideSite& site,
                            const dental::CutLine& line, std::string name, Progress& progress) {
  Box3 box_L;
  for (const Vec3& p_L : line.points_L) box_L.extend(p_L);
  const Vec3 beyond_mm = Vec3::Constant(job.guide.width_mm + job.holes.depth_mm);
  box_L = Box3(box_L.min() - beyond_mm, box_L.max() + beyond_mm);
  const ScrewClearance clearance(head.teeth, head.numbers ? &*head.numbers : nullptr,
                                 head.nerves.canals, box_L);
  const auto holes = dental::choose_holes(
      site, line, job.guide, job.holes, [&](const Vec3& entry_L, const Vec3& tip_L) {
        return clear_of_screw(head, clearance, job.holes.screw_mm, entry_L, tip_L);
      });
  NamedGuide named;
  named.name = std::move(name);
  named.segment = head.plan.segments[segment].osteotomy.segment;
  named.view = view.name;
  LEFORT_TRY(named.guide,
             dental::make_guide(site, line, holes, job.holes.diameter_mm, job.guide, progress));
  for (std::size_t n = 0; n < holes.size(); ++n)
    named.holes.push_back(named_hole(holes[n], n + 1, named, head, clearance, job.holes));
  named.wanted_holes = 2 * dental::holes_per_side(line);
  return named;
}

/// A name that no guide has yet.
std::string free_name(const std::string& wanted, const std::vector<NamedGuide>& guides) {
  std::string name = wanted;
  for (int n = 2; std::any_of(guides.begin(), guides.end(),
                              [&](const NamedGuide& one) { return one.name == name; });
       ++n)
    name = fmt::format("{}_{}", wanted, n);
  return name;
}

/// The cut faces on the segment's side, with those of segments that were later cut from it.
geometry::TriangleMesh faces_of(const GuideHead& head, std::size_t segment) {
  const auto& planned = head.plan.segments;
  std::vector<std::string> names{planned[segment].osteotomy.segment};
  geometry::TriangleMesh faces_L;
  for (std::size_t k = segment; k < planned.size(); ++k) {
    if (k != segment && std::find(names.begin(), names.end(), planned[k].cut_from) == names.end())
      continue;
    names.push_back(planned[k].osteotomy.segment);
    plan::append(faces_L, plan::cut_faces(head.cut.segments_L[k], planned[segment].osteotomy));
  }
  return faces_L;
}

/// Adds the guides of one segment.
Result<void> add_guides(const GuideJob& job, const GuideHead& head, std::size_t segment,
                        std::vector<NamedGuide>& guides, Progress& progress) {
  constexpr double kRoom_mm = 100.0;
  const plan::Osteotomy& osteotomy = head.plan.segments[segment].osteotomy;
  LEFORT_TRY(const std::vector<View> views, views_of(job.from, osteotomy, head.directions));
  Box3 box = geometry::bounding_box(head.bone.mesh());
  box.min() -= Vec3::Constant(kRoom_mm);
  box.max() += Vec3::Constant(kRoom_mm);
  LEFORT_TRY(const geometry::TriangleMesh solid_L, plan::cut_solid(osteotomy, box, 0.0));
  const geometry::Bvh solid(solid_L);
  const geometry::TriangleMesh faces_L = faces_of(head, segment);
  if (osteotomy.kerf_mm == 0.0)
    progress.note(fmt::format("segment '{}' has no kerf: the slot is for a saw of {:g} mm",
                              osteotomy.segment, dental::GuideSite::kSaw_mm));
  for (const View& view : views) {
    const dental::GuideSite site{
        head.bone, solid, osteotomy.kerf_mm > 0.0 ? osteotomy.kerf_mm : dental::GuideSite::kSaw_mm,
        view.outward_L};
    for (const dental::CutLine& line :
         dental::visible_cut_lines(faces_L, head.bone, view.outward_L, kMinLine_mm)) {
      const std::string name =
          free_name(fmt::format("{}_{}", osteotomy.segment, side_of(line, head)), guides);
      LEFORT_TRY(NamedGuide one, guide_of(job, head, segment, view, site, line, name, progress));
      guides.push_back(std::move(one));
    }
  }
  return {};
}

nlohmann::json hole_json(const NamedHole& one) {
  nlohmann::json found{{"name", one.name},
                       {"bone", one.bone},
                       {"before_mm", as_json(one.hole.point_L)},
                       {"after_mm", as_json(Vec3(one.X_LB * one.hole.point_L))},
                       {"axis_before", as_json(one.hole.axis_L)},
                       {"axis_after", as_json(Vec3(one.X_LB.linear() * one.hole.axis_L))},
                       {"bone_mm", one.hole.bone_mm}};
  if (!one.neighbor.name.empty())
    found["closest"] = {{"name", one.neighbor.name}, {"distance_mm", one.neighbor.distance_mm}};
  return found;
}

nlohmann::json guide_json(const NamedGuide& one) {
  nlohmann::json holes = nlohmann::json::array();
  for (const NamedHole& hole : one.holes) holes.push_back(hole_json(hole));
  const dental::Guide& guide = one.guide;
  return {{"name", one.name},
          {"file", "guide_" + one.name + ".stl"},
          {"segment", one.segment},
          {"put_on_from", one.view},
          {"volume_ml", guide.volume_ml},
          {"parts", guide.parts},
          {"slot_mm", guide.slot_mm},
          {"slot_width_mm", guide.slot_width_mm},
          {"fit", fit_json(guide.fit)},
          {"holes", holes}};
}

std::string guide_text(const NamedGuide& one, const GuideJob& job) {
  const dental::Guide& guide = one.guide;
  std::string text = fmt::format(
      "guide_{}.stl, put on from {}: slot {:.1f} mm long and {:.2f} mm wide; clearance {:.2f} mm "
      "(5 % to 95 %: {:.2f} to {:.2f}), penetration on the way in {:.2f} mm\n  {} holes",
      one.name, one.view, guide.slot_mm, guide.slot_width_mm, guide.fit.median_mm, guide.fit.p5_mm,
      guide.fit.p95_mm, guide.fit.max_penetration_mm, one.holes.size());
  const auto closest = std::min_element(one.holes.begin(), one.holes.end(),
                                        [](const NamedHole& a, const NamedHole& b) {
                                          return a.neighbor.distance_mm < b.neighbor.distance_mm;
                                        });
  if (closest != one.holes.end() && !closest->neighbor.name.empty())
    text += fmt::format(", screws {:.1f} mm or more from roots and canals that are known ({})",
                        closest->neighbor.distance_mm, closest->neighbor.name);
  if (int(one.holes.size()) < one.wanted_holes)
    text += fmt::format(
        "\n  warning: no place for {} more holes, {:g} mm from roots and nerves: change "
        "--hole-distance",
        one.wanted_holes - int(one.holes.size()), job.holes.min_clear_mm);
  if (guide.parts > 1)
    text +=
        fmt::format("\n  warning: the guide has {} parts: make it wider (--width)", guide.parts);
  if (guide.fit.max_penetration_mm > kMaxPenetration_mm)
    text += "\n  warning: the guide meets bone on its way in";
  return text;
}

/// Removes the guides of an earlier run, which guides.json names.
Result<void> remove_earlier_guides(const fs::path& folder) {
  constexpr std::size_t kMost = 1 << 20;
  const auto text = io::read_text(folder / kGuidesFile, kMost);
  if (!text) return {};
  const auto earlier = nlohmann::json::parse(*text, nullptr, false);
  if (!earlier.is_object() || !earlier.contains("lefort_guides")) return {};
  std::vector<fs::path> files{folder / kGuidesFile, folder / kHolesBefore, folder / kHolesAfter};
  const auto guides = earlier.find("guides");
  if (guides == earlier.end() || !guides->is_array()) return io::remove_earlier_files(files);
  for (const auto& guide : *guides) {
    const bool has_name = guide.is_object() && guide.contains("file") && guide["file"].is_string();
    const std::string name = has_name ? guide["file"].get<std::string>() : std::string();
    if (name.starts_with("guide_") && name.ends_with(".stl") && fs::path(name).filename() == name)
      files.push_back(folder / name);
  }
  return io::remove_earlier_files(files);
}

Result<void> write_guides(const fs::path& folder, const std::vector<NamedGuide>& guides,
                          const nlohmann::json& result) {
  LEFORT_TRY_VOID(io::make_output_folder(folder));
  LEFORT_TRY_VOID(remove_earlier_guides(folder));
  plan::Landmarks before, after;
  for (const NamedGuide& one : guides) {
    LEFORT_TRY_VOID(
        io::write_surface(folder / ("guide_" + one.name + ".stl"), one.guide.surface_L));
    for (const NamedHole& hole : one.holes) {
      before.push_back({hole.name, hole.hole.point_L});
      after.push_back({hole.name, hole.X_LB * hole.hole.point_L});
    }
  }
  if (!before.empty()) {
    LEFORT_TRY_VOID(io::write_landmarks(folder / kHolesBefore, before));
    LEFORT_TRY_VOID(io::write_landmarks(folder / kHolesAfter, after));
  }
  return io::write_text(folder / kGuidesFile, result.dump(1) + "\n");
}

}  // namespace

Result<Summary> make_guides(const GuideJob& job, Progress& progress) {
  LEFORT_TRY_VOID(dental::check_guide(job.guide));
  LEFORT_TRY_VOID(dental::check_holes(job.holes, job.guide));
  const io::EmptyFolderCleanup none_left(job.output);
  LEFORT_TRY(const GuideHead head, read_head(job, progress));
  LEFORT_TRY(const std::vector<std::size_t> wanted, wanted_segments(head.plan, job.segment));
  std::vector<NamedGuide> guides;
  for (const std::size_t segment : wanted) {
    const std::size_t before = guides.size();
    LEFORT_TRY_VOID(add_guides(job, head, segment, guides, progress));
    if (guides.size() == before)
      progress.note(
          fmt::format("warning: no guide for segment '{}': its cut is not visible along "
                      "{:g} mm from that side",
                      head.plan.segments[segment].osteotomy.segment, kMinLine_mm));
  }
  if (guides.empty())
    return fail(ErrorCode::kCutMissesBone,
                fmt::format("no cut is visible along {:g} mm from that side: choose another one "
                            "(--from)",
                            kMinLine_mm));
  Summary summary;
  nlohmann::json list = nlohmann::json::array();
  for (const NamedGuide& one : guides) {
    summary.text += guide_text(one, job) + "\n";
    list.push_back(guide_json(one));
  }
  summary.text += kNotForClinicalUse;
  summary.json = {{"lefort_guides", 1},
                  {"notice", kNotForClinicalUse},
                  {"hole_diameter_mm", job.holes.diameter_mm},
                  {"screw_diameter_mm", job.holes.screw_mm},
                  {"hole_depth_mm", job.holes.depth_mm},
                  {"min_distance_mm", job.holes.min_clear_mm},
                  {"are_nerves_considered", job.nerve.has_value()},
                  {"are_roots_considered", has_teeth(head.teeth)},
                  {"guides", list}};
  LEFORT_TRY_VOID(write_guides(job.output, guides, summary.json));
  return summary;
}

}  // namespace lefort::pipeline
