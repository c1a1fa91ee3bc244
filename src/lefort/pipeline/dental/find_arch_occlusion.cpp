#include <lefort/core/units.h>
#include <lefort/core/version.h>
#include <lefort/dental/check_arch.h>
#include <lefort/dental/cut_arch.h>
#include <lefort/dental/occlusal_relations.h>
#include <lefort/dental/register_bite.h>
#include <lefort/geometry/rigid_motion.h>
#include <lefort/geometry/transform_mesh.h>
#include <lefort/io/output_folder.h>
#include <lefort/io/surface_files.h>
#include <lefort/io/transform_file.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/dental.h>
#include <lefort/pipeline/dental/arch_directions.h>
#include <lefort/pipeline/dental/dental_json.h>
#include <lefort/pipeline/dental/teeth_file.h>
#include <lefort/pipeline/json/json_values.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

namespace lefort::pipeline {
namespace {

/// Movement of the lower arch: translation of its center in the directions of the arches, rotation.
nlohmann::json movement_json(const dental::Occlusion& found, const dental::ArchAxes& axes,
                             const Vec3& center_L) {
  const Vec3 shift = found.X_L_lower * center_L - center_L;
  const Vec3 turn = geometry::rotation_vector(found.X_L_lower.linear());
  return {{"anterior_mm", shift.dot(axes.anterior_L)},
          {"left_mm", shift.dot(axes.left_L())},
          {"superior_mm", shift.dot(axes.superior_L)},
          {"rotation_deg", degrees_from_radians(turn.norm())}};
}

Result<void> check_job(const OcclusionJob& job) {
  if (job.is_as_scanned && !job.arches)
    return fail(ErrorCode::kInvalidArgument,
                "--as-scanned needs --arches: it has the motions of both scans");
  if (job.is_as_scanned && !job.bites.empty())
    return fail(ErrorCode::kInvalidArgument, "give --as-scanned or --bite, not both");
  if (job.cuts.size() > 2)
    return fail(ErrorCode::kInvalidArgument, "the upper arch can be cut once or twice");
  if (!job.cuts.empty() && !job.teeth)
    return fail(ErrorCode::kInvalidArgument,
                "--cut needs --teeth: teeth.json of `lefort dental teeth`");
  const dental::OcclusionRequests& wanted = job.options.requests;
  if (wanted.midline_mm && !job.teeth)
    return fail(ErrorCode::kInvalidArgument,
                "--midline needs --teeth: teeth.json of `lefort dental teeth`");
  if ((wanted.midline_mm || wanted.overjet_mm || wanted.overbite_mm) &&
      (job.is_as_scanned || !job.bites.empty()))
    return fail(ErrorCode::kInvalidArgument,
                "--midline, --overjet and --overbite are for a search, not with --bite or "
                "--as-scanned");
  return {};
}

/// An occlusion, and where it comes from.
struct FoundOcclusion {
  dental::Occlusion occlusion;
  std::string text;
  nlohmann::json bites = nlohmann::json::array();
};

Result<FoundOcclusion> bite_occlusion(const OcclusionJob& job, const dental::Arches& arches,
                                      const dental::ArchAxes& axes, Progress& progress) {
  std::vector<geometry::TriangleMesh> bites;
  for (const auto& file : job.bites) {
    LEFORT_TRY(geometry::TriangleMesh bite, io::read_surface(file, progress));
    bites.push_back(std::move(bite));
  }
  LEFORT_TRY(
      const dental::Bite bite,
      dental::register_bite(arches.upper.mesh(), arches.lower.mesh(), axes, bites, progress));
  FoundOcclusion found{dental::measure_occlusion(arches, bite.X_L_lower, axes), "of the bite scan"};
  for (const dental::BiteFit& fit : bite.fits) {
    found.bites.push_back({{"upper_rms_mm", fit.upper_rms_mm},
                           {"lower_rms_mm", fit.lower_rms_mm},
                           {"fraction", fit.fraction}});
    found.text += fmt::format(" (RMS {:.2f} and {:.2f} mm, {:.0f} % of it on the arches)",
                              fit.upper_rms_mm, fit.lower_rms_mm, 100.0 * fit.fraction);
  }
  return found;
}

/// The options of the job with the midlines.
Result<dental::OcclusionOptions> options_of(const OcclusionJob& job,
                                            const dental::NumberedCrowns& crowns_L) {
  dental::OcclusionOptions options = job.options;
  if (!options.requests.midline_mm) return options;
  const auto upper = dental::dental_midline(crowns_L, true);
  const auto lower = dental::dental_midline(crowns_L, false);
  if (!upper || !lower)
    return fail(ErrorCode::kAnatomyMissing,
                fmt::format("{}: --midline needs teeth 11, 21, 31 and 41", job.teeth->string()));
  options.requests.upper_midline_L = *upper;
  options.requests.lower_midline_L = *lower;
  return options;
}

Result<FoundOcclusion> occlusion_of(const OcclusionJob& job, const dental::Arches& arches,
                                    const dental::ArchAxes& axes,
                                    const dental::NumberedCrowns& crowns_L, Progress& progress) {
  if (!job.bites.empty()) return bite_occlusion(job, arches, axes, progress);
  if (job.is_as_scanned) {
    LEFORT_TRY(const RigidTransform X, scanned_occlusion(*job.arches));
    return FoundOcclusion{dental::measure_occlusion(arches, X, axes), "as the files were scanned"};
  }
  LEFORT_TRY(const dental::OcclusionOptions options, options_of(job, crowns_L));
  LEFORT_TRY(
      dental::Occlusion searched,
      dental::find_occlusion(arches.upper.mesh(), arches.lower.mesh(), axes, options, progress));
  const dental::OcclusionRequests& wanted = options.requests;
  const bool has_requests = wanted.midline_mm || wanted.overjet_mm || wanted.overbite_mm;
  return FoundOcclusion{std::move(searched), has_requests ? "maximum intercuspation with requests"
                                                          : "maximum intercuspation"};
}

/// Adds midlines and the relations of canines and molars.
void add_relations(const dental::OcclusalRelations& relations, Summary& summary) {
  nlohmann::json json = {{"midline_mm", number_or_null(relations.midline_mm)}};
  summary.text +=
      std::isnan(relations.midline_mm)
          ? "\n  midlines unknown"
          : fmt::format("\n  lower midline {:.1f} mm to the {}", std::abs(relations.midline_mm),
                        relations.midline_mm < 0.0 ? "right" : "left");
  for (const auto& [name, relation_mm] : {std::pair("right_canine", relations.right_canine_mm),
                                          std::pair("left_canine", relations.left_canine_mm),
                                          std::pair("right_molar", relations.right_molar_mm),
                                          std::pair("left_molar", relations.left_molar_mm)}) {
    const std::string_view angle = dental::angle_class(relation_mm);
    json[name] = {{"mesial_mm", number_or_null(relation_mm)},
                  {"class", angle.empty() ? nlohmann::json(nullptr) : nlohmann::json(angle)}};
    if (angle.empty()) continue;
    std::string words = name;
    std::replace(words.begin(), words.end(), '_', ' ');
    summary.text += fmt::format(", {} class {} ({:+.1f} mm)", words, angle, relation_mm);
  }
  summary.json["relations"] = std::move(json);
}

/// What was requested, with what was found, and a warning where they differ.
void add_requests(const dental::OcclusionRequests& wanted, const dental::Occlusion& found,
                  double midline_mm, Summary& summary) {
  constexpr double kMet_mm = 0.3;
  nlohmann::json requests = nlohmann::json::object();
  for (const auto& [name, value, reached_mm] :
       {std::tuple("overjet", wanted.overjet_mm, found.overjet_mm),
        std::tuple("overbite", wanted.overbite_mm, found.overbite_mm),
        std::tuple("midline", wanted.midline_mm, midline_mm)}) {
    if (!value) continue;
    const bool is_met = std::abs(reached_mm - *value) <= kMet_mm;
    requests[std::string(name) + "_mm"] = {
        {"requested", *value}, {"reached", number_or_null(reached_mm)}, {"is_met", is_met}};
    if (!is_met)
      summary.text +=
          fmt::format("\n  warning: the requested {} of {:.1f} mm is not reached, it is {:.1f} mm",
                      name, *value, reached_mm);
  }
  summary.json["requests"] = std::move(requests);
}

/// The pieces of the upper arch; none without cuts.
Result<std::vector<geometry::TriangleMesh>> pieces_of(const OcclusionJob& job,
                                                      const geometry::TriangleMesh& upper_L,
                                                      const dental::NumberedCrowns& crowns_L) {
  if (job.cuts.empty()) return std::vector<geometry::TriangleMesh>();
  std::map<int, Vec3> centers_L;
  for (const auto& [fdi, crown] : crowns_L) centers_L.emplace(fdi, crown.center_L);
  return dental::cut_arch(upper_L, centers_L, job.cuts);
}

/// Removes what an earlier run may have left.
Result<void> remove_earlier_occlusion(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files{folder / "occlusion.json",
                                           folder / "lower_with_upper.tfm"};
  for (int n = 1; n <= 3; ++n)
    for (const char* const ending : {".stl", ".tfm"})
      files.push_back(folder / fmt::format("piece_{}{}", n, ending));
  return io::remove_earlier_files(files);
}

/// Moves each piece of the upper arch to its occlusion with the lower arch, which stays.
Result<void> add_pieces(const OcclusionJob& job, const std::vector<geometry::TriangleMesh>& pieces,
                        const geometry::TriangleMesh& lower_L, const dental::ArchAxes& axes,
                        Summary& summary, Progress& progress) {
  // A piece takes the part of the lower arch.
  const dental::ArchAxes turned{-axes.superior_L, axes.anterior_L};
  dental::OcclusionOptions options = job.options;
  options.is_close = true;
  options.requests = {};
  nlohmann::json list = nlohmann::json::array();
  for (std::size_t n = 0; n < pieces.size(); ++n) {
    LEFORT_TRY(const dental::Occlusion found,
               dental::find_occlusion(lower_L, pieces[n], turned, options, progress));
    const std::string name = fmt::format("piece_{}", n + 1);
    LEFORT_TRY_VOID(io::write_surface(job.output / (name + ".stl"),
                                      geometry::transformed(pieces[n], found.X_L_lower)));
    LEFORT_TRY_VOID(io::write_transform(job.output / (name + ".tfm"), found.X_L_lower));
    nlohmann::json movement = movement_json(found, axes, dental::mean_vertex(pieces[n]));
    summary.text += fmt::format(
        "\n  {}: {:.1f} mm anterior, {:.1f} mm left, {:.1f} mm superior, {:.1f} degrees", name,
        movement["anterior_mm"].get<double>(), movement["left_mm"].get<double>(),
        movement["superior_mm"].get<double>(), movement["rotation_deg"].get<double>());
    list.push_back({{"name", name},
                    {"pose_4x4_row_major_mm_lps", as_json(found.X_L_lower)},
                    {"movement", std::move(movement)},
                    {"max_penetration_mm", found.contacts.max_penetration_mm}});
  }
  summary.json["pieces"] = std::move(list);
  return {};
}

Result<void> write_occlusion(const OcclusionJob& job, const geometry::TriangleMesh& lower_L,
                             const dental::Occlusion& found, const RigidTransform& X_upper) {
  LEFORT_TRY_VOID(io::make_output_folder(job.output));
  LEFORT_TRY_VOID(remove_earlier_occlusion(job.output));
  LEFORT_TRY_VOID(
      io::write_surface(job.output / "lower.stl", geometry::transformed(lower_L, found.X_L_lower)));
  LEFORT_TRY_VOID(io::write_transform(job.output / "lower_to_occlusion.tfm", found.X_L_lower));
  if (job.upper_transform)
    LEFORT_TRY_VOID(
        io::write_transform(job.output / "lower_with_upper.tfm", X_upper * found.X_L_lower));
  LEFORT_TRY_VOID(io::write_surface(job.output / "lower_contacts.vtp",
                                    geometry::transformed(lower_L, found.X_L_lower),
                                    {{"gap_mm", found.gaps_mm}}));
  return {};
}

Summary summary_of(const OcclusionJob& job, const FoundOcclusion& from,
                   const dental::ArchAxes& axes, const Vec3& center_L) {
  const dental::Occlusion& found = from.occlusion;
  const dental::OcclusalContacts& contacts = found.contacts;
  Summary summary;
  summary.json = {{"lefort_occlusion", 1},
                  {"notice", kNotForClinicalUse},
                  {"source", from.text},
                  {"bites", from.bites},
                  {"pose_4x4_row_major_mm_lps", as_json(found.X_L_lower)},
                  {"movement", movement_json(found, axes, center_L)},
                  {"contacts",
                   {{"left_mm2", contacts.left_mm2},
                    {"right_mm2", contacts.right_mm2},
                    {"patches", contacts.patches},
                    {"max_penetration_mm", contacts.max_penetration_mm}}},
                  {"overjet_mm", number_or_null(found.overjet_mm)},
                  {"overbite_mm", number_or_null(found.overbite_mm)}};
  summary.text = fmt::format(
      "{}, {}: contact on {:.1f} mm2 (right {:.1f}, left {:.1f}) in {} patches, penetration {:.2f} "
      "mm, overjet {:.1f} mm, overbite {:.1f} mm (edge to edge)",
      job.output.string(), from.text, contacts.left_mm2 + contacts.right_mm2, contacts.right_mm2,
      contacts.left_mm2, contacts.patches, contacts.max_penetration_mm, found.overjet_mm,
      found.overbite_mm);
  if (contacts.max_penetration_mm > dental::kMaxOcclusalPenetration_mm)
    summary.text += fmt::format("\n  warning: the arches penetrate by more than {:g} mm",
                                dental::kMaxOcclusalPenetration_mm);
  return summary;
}

}  // namespace

Result<Summary> find_arch_occlusion(const OcclusionJob& job, Progress& progress) {
  LEFORT_TRY_VOID(check_job(job));
  LEFORT_TRY(const geometry::TriangleMesh upper_L, io::read_surface(job.upper, progress));
  LEFORT_TRY(const geometry::TriangleMesh lower_L, io::read_surface(job.lower, progress));
  LEFORT_TRY(const ArchDirections directions, read_arch_directions(job.arches));
  RigidTransform X_upper = RigidTransform::Identity();
  if (job.upper_transform) {
    LEFORT_TRY(X_upper, io::read_transform(*job.upper_transform));
  }
  const dental::ArchAxes& axes = directions.axes;
  LEFORT_TRY_VOID(dental::check_arch(upper_L, "upper", -axes.superior_L));
  LEFORT_TRY_VOID(dental::check_arch(lower_L, "lower", axes.superior_L));
  const dental::Arches arches{geometry::Bvh(upper_L), geometry::Bvh(lower_L)};
  dental::NumberedCrowns crowns_L;
  if (job.teeth) {
    LEFORT_TRY(crowns_L, read_crowns(*job.teeth));
  }
  LEFORT_TRY(const auto pieces, pieces_of(job, upper_L, crowns_L));
  LEFORT_TRY(const FoundOcclusion from, occlusion_of(job, arches, axes, crowns_L, progress));
  const dental::Occlusion& found = from.occlusion;
  LEFORT_TRY_VOID(write_occlusion(job, lower_L, found, X_upper));
  Summary summary = summary_of(job, from, axes, dental::mean_vertex(lower_L));
  if (job.teeth) {
    const auto relations = dental::occlusal_relations(crowns_L, found.X_L_lower, axes);
    add_relations(relations, summary);
    add_requests(job.options.requests, found, relations.midline_mm, summary);
  } else {
    add_requests(job.options.requests, found, std::nan(""), summary);
  }
  if (!pieces.empty())
    LEFORT_TRY_VOID(add_pieces(job, pieces, geometry::transformed(lower_L, found.X_L_lower), axes,
                               summary, progress));
  LEFORT_TRY_VOID(io::write_text(job.output / "occlusion.json", summary.json.dump(1) + "\n"));
  return summary;
}

}  // namespace lefort::pipeline
