#include <lefort/core/units.h>
#include <lefort/core/version.h>
#include <lefort/dental/check_arch.h>
#include <lefort/geometry/rigid_motion.h>
#include <lefort/geometry/transform_mesh.h>
#include <lefort/io/output_folder.h>
#include <lefort/io/surface_files.h>
#include <lefort/io/transform_file.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/dental.h>
#include <lefort/pipeline/dental/arch_directions.h>
#include <lefort/pipeline/dental/dental_json.h>
#include <lefort/pipeline/json/json_values.h>

#include <fmt/format.h>

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

}  // namespace

Result<Summary> find_arch_occlusion(const OcclusionJob& job, Progress& progress) {
  LEFORT_TRY(const geometry::TriangleMesh upper_L, io::read_surface(job.upper, progress));
  LEFORT_TRY(const geometry::TriangleMesh lower_L, io::read_surface(job.lower, progress));
  LEFORT_TRY(const ArchDirections directions, read_arch_directions(job.arches));
  const dental::ArchAxes& axes = directions.axes;
  LEFORT_TRY(const dental::Occlusion found,
             dental::find_occlusion(upper_L, lower_L, axes, job.options, progress));
  LEFORT_TRY_VOID(io::make_output_folder(job.output));
  LEFORT_TRY_VOID(
      io::write_surface(job.output / "lower.stl", geometry::transformed(lower_L, found.X_L_lower)));
  LEFORT_TRY_VOID(io::write_transform(job.output / "lower_to_occlusion.tfm", found.X_L_lower));
  LEFORT_TRY_VOID(io::write_surface(job.output / "lower_contacts.vtp",
                                    geometry::transformed(lower_L, found.X_L_lower),
                                    {{"gap_mm", found.gaps_mm}}));
  const dental::OcclusalContacts& contacts = found.contacts;
  Summary summary;
  summary.json = {{"lefort_occlusion", 1},
                  {"notice", kNotForClinicalUse},
                  {"pose_4x4_row_major_mm_lps", as_json(found.X_L_lower)},
                  {"movement", movement_json(found, axes, dental::mean_vertex(lower_L))},
                  {"contacts",
                   {{"left_mm2", contacts.left_mm2},
                    {"right_mm2", contacts.right_mm2},
                    {"patches", contacts.patches},
                    {"max_penetration_mm", contacts.max_penetration_mm}}},
                  {"overjet_mm", number_or_null(found.overjet_mm)},
                  {"overbite_mm", number_or_null(found.overbite_mm)}};
  summary.text = fmt::format(
      "{}: contact on {:.1f} mm2 (right {:.1f}, left {:.1f}) in {} patches, penetration {:.2f} mm, "
      "overjet {:.1f} mm, overbite {:.1f} mm (edge to edge)",
      job.output.string(), contacts.left_mm2 + contacts.right_mm2, contacts.right_mm2,
      contacts.left_mm2, contacts.patches, contacts.max_penetration_mm, found.overjet_mm,
      found.overbite_mm);
  LEFORT_TRY_VOID(io::write_text(job.output / "occlusion.json", summary.json.dump(1) + "\n"));
  return summary;
}

}  // namespace lefort::pipeline
