#include <lefort/compare/compare_by_region.h>
#include <lefort/compare/face_regions.h>
#include <lefort/compare/landmark_displacements.h>
#include <lefort/compare/surface_difference.h>
#include <lefort/core/version.h>
#include <lefort/geometry/mesh_properties.h>
#include <lefort/io/earlier_check_files.h>
#include <lefort/io/landmarks_file.h>
#include <lefort/io/output_folder.h>
#include <lefort/io/plan_file.h>
#include <lefort/io/sha256.h>
#include <lefort/io/surface_files.h>
#include <lefort/io/transform_file.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/compare.h>
#include <lefort/pipeline/compare/compare_tables.h>
#include <lefort/pipeline/compare/register_after_surgery.h>
#include <lefort/pipeline/json/json_values.h>
#include <lefort/report/compare_pictures.h>

#include <fmt/format.h>

#include <string>
#include <system_error>
#include <utility>
#include <vector>

namespace lefort::pipeline {
namespace {

namespace fs = std::filesystem;
using compare::FaceRegions;
using geometry::TriangleMesh;

constexpr const char* kResult = "compare.json";
constexpr const char* kRegions = "regions.csv";
constexpr const char* kMap = "difference.vtp";
constexpr const char* kLandmarks = "landmark_shifts.csv";
constexpr const char* kMovements = "movements.csv";
constexpr const char* kRegistration = "registration.tfm";
constexpr const char* kSkinAfter = "skin_after.vtp";
constexpr const char* kBoneAfter = "bone_after.vtp";

bool is_folder(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error);
}

/// The file of a face's surface: the file itself, or the predicted skin in a prediction's folder.
Result<fs::path> surface_of(const fs::path& face) {
  if (!is_folder(face)) return face;
  if (!fs::exists(face / "prediction.json"))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{} is not the folder of a finished prediction: it has no "
                            "prediction.json",
                            face.string()));
  return face / "predicted_skin.vtp";
}

Result<TriangleMesh> read_face(const fs::path& file, Progress& progress) {
  LEFORT_TRY(TriangleMesh face_L, io::read_surface(file, progress));
  LEFORT_TRY_VOID(geometry::check_surface(face_L));
  return face_L;
}

/// Files that the job reads.
struct Inputs {
  fs::path face;
  std::optional<fs::path> other, before, landmarks;

  [[nodiscard]] std::vector<fs::path> all() const {
    std::vector<fs::path> files{face};
    for (const auto* file : {&other, &before, &landmarks})
      if (*file) files.push_back(**file);
    return files;
  }
};

Result<Inputs> find_inputs(const CompareJob& job) {
  if (!job.other && !job.after_ct)
    return fail(ErrorCode::kInvalidArgument,
                "nothing to compare with: name another face, or a scan by --after-ct");
  if (job.other && job.after_ct)
    return fail(ErrorCode::kInvalidArgument, "name either another face or a scan, not both");
  if (job.after_ct && !is_folder(job.face))
    return fail(
        ErrorCode::kInvalidArgument,
        fmt::format("--after-ct needs the folder of a prediction, not {}", job.face.string()));
  Inputs inputs;
  LEFORT_TRY(inputs.face, surface_of(job.face));
  if (job.other) {
    LEFORT_TRY(inputs.other, surface_of(*job.other));
  }
  inputs.before = job.before;
  if (!inputs.before && is_folder(job.face)) inputs.before = job.face / "skin_before.vtp";
  inputs.landmarks = job.landmarks;
  return inputs;
}

/// Landmarks of the head before surgery, if there are any.
Result<plan::Landmarks> find_landmarks(const CompareJob& job) {
  if (job.landmarks) return io::read_landmarks(*job.landmarks);
  if (!is_folder(job.face)) return plan::Landmarks{};
  LEFORT_TRY(io::PlanFile plan, io::read_plan(job.face / "plan.json"));
  return std::move(plan.landmarks);
}

/// Displacement of a skin landmark from the face before surgery to the compared face.
struct LandmarkShift {
  std::string name;
  Vec3 before_L, translation_mm;
};

std::vector<LandmarkShift> find_shifts(const plan::Landmarks& landmarks,
                                       const TriangleMesh& before_L, const TriangleMesh& face_L) {
  std::vector<LandmarkShift> shifts;
  const auto carried = compare::displace_landmarks(landmarks, before_L, face_L);
  if (!carried) return shifts;  // Another surface: corresponding points are not known.
  for (const plan::Landmark& after : *carried) {
    const Vec3 before = *plan::find_landmark(landmarks, after.name);
    shifts.push_back({after.name, before, after.point_L - before});
  }
  return shifts;
}

std::string shifts_csv(const std::vector<LandmarkShift>& shifts) {
  std::string csv = "name,x_mm,y_mm,z_mm,left_mm,back_mm,up_mm,length_mm\n";
  for (const auto& [name, at, d] : shifts)
    csv += fmt::format("{},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f}\n", name, at.x(),
                       at.y(), at.z(), d.x(), d.y(), d.z(), d.norm());
  return csv;
}

std::vector<std::string> all_names() {
  std::vector<std::string> names{kResult,    kRegions,      kMap,       kLandmarks,
                                 kMovements, kRegistration, kSkinAfter, kBoneAfter};
  for (const std::string& picture : report::compare_picture_names())
    names.push_back("pictures/" + picture);
  return names;
}

Result<void> prepare_folder(const CompareJob& job, const Inputs& inputs) {
  std::vector<fs::path> ours;
  for (const std::string& name : all_names()) ours.push_back(job.output / name);
  std::vector<fs::path> read = inputs.all();
  if (job.after_ct) read.push_back(*job.after_ct);
  LEFORT_TRY_VOID(io::check_inputs_are_distinct(read, ours));
  LEFORT_TRY_VOID(io::make_output_folder(job.output));
  return io::remove_earlier_files(ours);
}

Result<nlohmann::json> fingerprints_of(const Inputs& inputs) {
  nlohmann::json files = nlohmann::json::array();
  for (const fs::path& file : inputs.all()) {
    LEFORT_TRY(const std::string sha256, io::sha256_of_file(file));
    files.push_back({{"file", file.filename().string()}, {"sha256", sha256}});
  }
  return files;
}

Result<void> write_surgery(const fs::path& folder, const SurgeryFound& surgery) {
  LEFORT_TRY_VOID(io::write_text(folder / kMovements, movements_csv(surgery)));
  // Transform for 3D Slicer from the scan after surgery to the head before surgery.
  LEFORT_TRY_VOID(io::write_transform(folder / kRegistration, surgery.base.X_onto_from.inverse()));
  LEFORT_TRY_VOID(io::write_surface(folder / kSkinAfter, surgery.skin_L));
  return io::write_surface(folder / kBoneAfter, surgery.bone_L);
}

Result<void> write_pictures(const fs::path& folder,
                            const std::vector<report::ComparePicture>& pictures) {
  if (pictures.empty()) return {};
  LEFORT_TRY_VOID(io::make_output_folder(folder / "pictures"));
  for (const report::ComparePicture& picture : pictures)
    LEFORT_TRY_VOID(io::write_text(folder / "pictures" / picture.file, picture.png));
  return {};
}

/// The face that is compared, and the same face before surgery with its landmarks.
struct Faces {
  TriangleMesh face_L;
  std::optional<TriangleMesh> before_L;
  plan::Landmarks landmarks;
  FaceRegions regions;

  [[nodiscard]] const TriangleMesh* before() const { return before_L ? &*before_L : nullptr; }
};

Result<Faces> read_faces(const CompareJob& job, const Inputs& inputs, Progress& progress) {
  LEFORT_TRY(TriangleMesh face_L, read_face(inputs.face, progress));
  std::optional<TriangleMesh> before_L;
  if (inputs.before) {
    LEFORT_TRY(before_L, read_face(*inputs.before, progress));
  }
  LEFORT_TRY(plan::Landmarks landmarks, find_landmarks(job));
  LEFORT_TRY(FaceRegions regions, FaceRegions::from(landmarks));
  return Faces{std::move(face_L), std::move(before_L), std::move(landmarks), std::move(regions)};
}

struct Measured {
  compare::SurfaceDifference difference;
  std::vector<compare::RegionDifference> rows;  ///< The whole face first.
  std::vector<LandmarkShift> shifts;            ///< None without a face before surgery.
};

Result<Measured> measure(const Faces& faces, TriangleMesh other_L, Progress& progress) {
  const geometry::Bvh other(std::move(other_L));
  Measured measured{compare::measure_difference(faces.face_L, other), {}, {}};
  measured.rows = compare::compare_by_region(faces.face_L, measured.difference, other,
                                             faces.before(), faces.regions);
  if (measured.rows.front().face.compared_fraction == 0.0)
    return fail(ErrorCode::kInvalidArgument,
                "no point of the face has a counterpart on the other within 20 mm; are both in "
                "the same frame?");
  for (const std::string& missing : faces.regions.missing())
    progress.note(fmt::format("not distinguished because landmarks are missing: {}", missing));
  if (faces.before_L) measured.shifts = find_shifts(faces.landmarks, *faces.before_L, faces.face_L);
  return measured;
}

Result<nlohmann::json> result_json(const Inputs& inputs, const Faces& faces,
                                   const Measured& measured,
                                   const std::optional<SurgeryFound>& surgery) {
  nlohmann::json result{
      {"lefort_compare", 2}, {"notice", kNotForClinicalUse}, {"version", kVersion}};
  LEFORT_TRY(result["inputs"], fingerprints_of(inputs));
  result["regions"] = regions_json(measured.rows);
  result["regions_missing"] = faces.regions.missing();
  for (const auto& [name, at, d] : measured.shifts)
    result["landmark_shifts"].push_back({{"name", name},
                                         {"before_mm", as_json(at)},
                                         {"shift_mm", as_json(d)},
                                         {"length_mm", d.norm()}});
  if (surgery) {
    result["after_ct_sha256"] = surgery->scan_sha256;
    result["registration"] = registration_json(surgery->base);
    result["warnings"] = surgery->warnings;
    result["movements"] = movements_json(*surgery);
  }
  return result;
}

/// Writes all files except compare.json, whose presence shows that the others are complete.
Result<void> write_files(const CompareJob& job, const Faces& faces, const Measured& measured,
                         const std::optional<SurgeryFound>& surgery,
                         const std::vector<report::ComparePicture>& pictures) {
  if (surgery) LEFORT_TRY_VOID(write_surgery(job.output, *surgery));
  LEFORT_TRY_VOID(io::write_text(job.output / kRegions, regions_csv(measured.rows)));
  if (!measured.shifts.empty())
    LEFORT_TRY_VOID(io::write_text(job.output / kLandmarks, shifts_csv(measured.shifts)));
  std::vector<double> region_of;
  for (const auto region : compare::regions_of(faces.face_L, faces.before(), faces.regions))
    region_of.push_back(double(region));
  LEFORT_TRY_VOID(
      io::write_surface(job.output / kMap, faces.face_L,
                        {{"difference_mm", measured.difference.signed_mm}, {"region", region_of}}));
  return write_pictures(job.output, pictures);
}

}  // namespace

Result<Summary> compare_faces(const CompareJob& job, Progress& progress) {
  LEFORT_TRY(const Inputs inputs, find_inputs(job));
  progress.begin_stage("read the faces");
  LEFORT_TRY(const Faces faces, read_faces(job, inputs, progress));
  const io::EmptyFolderCleanup cleanup(job.output);
  LEFORT_TRY_VOID(prepare_folder(job, inputs));

  std::optional<SurgeryFound> surgery;
  TriangleMesh other_L;
  if (job.after_ct) {
    LEFORT_TRY(surgery, find_surgery(job.face, *job.after_ct, job.output / "cache", progress));
    other_L = surgery->skin_L;
  } else {
    LEFORT_TRY(other_L, read_face(*inputs.other, progress));
  }
  progress.begin_stage("measure the difference");
  LEFORT_TRY(const Measured measured, measure(faces, std::move(other_L), progress));

  std::vector<report::ComparePicture> pictures;
  if (job.pictures) {
    progress.begin_stage("draw");
    LEFORT_TRY(pictures, report::draw_difference(faces.face_L, measured.difference.signed_mm,
                                                 measured.rows.front().face.p95_mm, progress));
  }
  progress.begin_stage("write");
  LEFORT_TRY(nlohmann::json result, result_json(inputs, faces, measured, surgery));
  LEFORT_TRY_VOID(write_files(job, faces, measured, surgery, pictures));
  LEFORT_TRY_VOID(io::write_text(job.output / kResult, result.dump(2) + "\n"));

  std::string text = job.output.string() + ":\n" + regions_text(measured.rows);
  if (surgery) text += movements_text(*surgery);
  return Summary{std::move(text), std::move(result)};
}

}  // namespace lefort::pipeline
