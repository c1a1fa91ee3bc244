#include <lefort/anatomy/parametric_head.h>
#include <lefort/anatomy/synthetic_head.h>
#include <lefort/core/units.h>
#include <lefort/io/landmarks_file.h>
#include <lefort/io/output_folder.h>
#include <lefort/io/segmentation_file.h>
#include <lefort/io/write_dicom.h>
#include <lefort/pipeline/import.h>
#include <lefort/pipeline/scan/dentition_files.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

namespace lefort::pipeline {
namespace fs = std::filesystem;

namespace {

constexpr double kGantryTilt_deg = 15.0;   // Gantries tilt by up to 30.
const Vec3 kOblique_deg(-11.0, 5.0, 8.0);  // About x, y, z; the chin stays in the scanned volume.

/// `grid` rotated about its center.
image::Grid turned(image::Grid grid, const Mat3& rotation) {
  const Vec3 last(double(grid.size[0] - 1), double(grid.size[1] - 1), double(grid.size[2] - 1));
  const Vec3 middle_L = grid.point_L(0.5 * last);
  grid.direction = rotation * grid.direction;
  grid.origin_L = middle_L - grid.direction * (0.5 * last).cwiseProduct(grid.spacing_mm);
  return grid;
}

/// The grid of each slice, in the order of the scanner.
std::vector<image::Grid> slices_of(PhantomVariant variant, double voxel_mm) {
  image::Grid grid = anatomy::synthetic_grid(voxel_mm);
  const auto about = [](double angle_deg, const Vec3& axis) {
    return Eigen::AngleAxisd(radians_from_degrees(angle_deg), axis).toRotationMatrix();
  };
  if (variant == PhantomVariant::kOblique)
    grid = turned(grid, about(kOblique_deg.z(), Vec3::UnitZ()) *
                            about(kOblique_deg.y(), Vec3::UnitY()) *
                            about(kOblique_deg.x(), Vec3::UnitX()));
  if (variant == PhantomVariant::kFeetFirst) grid = turned(grid, about(180.0, Vec3::UnitY()));
  const Vec3 feed_mm = grid.direction.col(2) * grid.spacing_mm.z();
  // The gantry is tilted and the table moves along the patient: the slices are sheared.
  if (variant == PhantomVariant::kTilted)
    grid = turned(grid, about(kGantryTilt_deg, Vec3::UnitX()));
  std::vector<image::Grid> slices;
  const Index count = grid.size[2];
  const Vec3 middle_L = grid.point_L({0.0, 0.0, 0.5 * double(count - 1)});
  for (Index k = 0; k < count; ++k) {
    image::Grid slice = grid;
    slice.size[2] = 1;
    slice.origin_L = middle_L + (double(k) - 0.5 * double(count - 1)) * feed_mm;
    slices.push_back(slice);
  }
  return slices;
}

/// Shuffled names have no ending, and their order is not that of the slices.
std::string name_of(PhantomVariant variant, Index k, Index count) {
  if (variant != PhantomVariant::kShuffled) return fmt::format("slice-{:04}.dcm", k + 1);
  Index step = count / 2 + 1;  // Coprime to the count, so that all names differ.
  while (std::gcd(step, count) != 1) ++step;
  return fmt::format("IM{:06}", k * step % count);
}

/// Slices, labels and, if they are known, landmarks.
struct Phantom {
  std::vector<image::CtVolume> slices;
  anatomy::LabelMap labels;
  plan::Landmarks landmarks;
};

Phantom simple_head(const PhantomJob& job) {
  anatomy::SyntheticMaterials materials;
  materials.noise_hu = job.noise_hu;
  Phantom phantom;
  const std::vector<image::Grid> slices = slices_of(job.variant, job.voxel_mm);
  for (std::size_t k = 0; k < slices.size(); ++k)
    phantom.slices.push_back(anatomy::synthetic_scan(slices[k], materials, k + 1));
  phantom.labels = anatomy::synthetic_labels(anatomy::synthetic_grid(job.voxel_mm));
  return phantom;
}

anatomy::HeadShape shape_of(const PhantomJob& job) {
  constexpr double kOpenBite_deg = 4.0, kClearance_mm = 1.0;
  anatomy::HeadShape shape;
  if (job.head == PhantomHead::kOpenBite) shape.opening_rad = radians_from_degrees(kOpenBite_deg);
  if (job.head != PhantomHead::kDentition) return shape;
  if (job.shape > 0) shape = anatomy::draw_head_shape(job.shape);
  shape.dentition = job.shape + 1;
  shape.jaw_offset_mm = Vec3(job.deviation_mm, job.retrusion_mm, 0.0);
  shape.opening_rad = anatomy::opening_with_clearance(shape, kClearance_mm);
  return shape;
}

Phantom head_with_teeth(const PhantomJob& job, const anatomy::ParametricHead& head) {
  anatomy::LabeledScan scan = anatomy::scan_of(head, job.voxel_mm, job.noise_hu, 1);
  constexpr std::int16_t kMin_hu = -1024;  // Of scanners; noise in air is cut off.
  Phantom phantom;
  for (Index k = 0; k < scan.ct.grid.size[2]; ++k) {
    image::CtVolume slice{scan.ct.grid, {}};
    slice.grid.size[2] = 1;
    slice.grid.origin_L = scan.ct.grid.point_L({0.0, 0.0, double(k)});
    const auto first = scan.ct.values.begin() + std::ptrdiff_t(scan.ct.grid.offset(0, 0, k));
    slice.values.assign(first, first + std::ptrdiff_t(slice.grid.voxel_count()));
    for (std::int16_t& value_hu : slice.values) value_hu = std::max(value_hu, kMin_hu);
    phantom.slices.push_back(std::move(slice));
  }
  phantom.labels = std::move(scan.labels);
  for (const auto& [name, p_L] : anatomy::true_landmarks(head))
    phantom.landmarks.push_back({name, p_L});
  return phantom;
}

}  // namespace

Result<Summary> make_phantom(const PhantomJob& job, Progress& progress) {
  if (job.head != PhantomHead::kSimple && job.variant != PhantomVariant::kPlain)
    return fail(ErrorCode::kInvalidArgument, "a head with teeth has the variant plain only");
  const fs::path dicom = job.output / "dicom";
  std::error_code error;
  if (fs::exists(dicom, error) && !fs::is_empty(dicom, error))
    return fail(ErrorCode::kFileUnwritable,
                fmt::format("{} is not empty, expected an empty folder", dicom.string()));
  const io::EmptyFolderCleanup none_left(dicom);
  LEFORT_TRY_VOID(io::make_output_folder(job.output));
  LEFORT_TRY_VOID(io::make_output_folder(dicom));

  progress.begin_stage("scan the synthetic head");
  const anatomy::ParametricHead head(shape_of(job));
  const Phantom phantom =
      job.head == PhantomHead::kSimple ? simple_head(job) : head_with_teeth(job, head);
  const io::DicomSeriesText text{.patient_name = "SYNTHETIC^HEAD",
                                 .description = "computed, not a patient",
                                 .number = 1 + std::uint64_t(job.variant)};
  const Index count = std::ssize(phantom.slices);
  for (Index k = 0; k < count; ++k) {
    if (progress.stop_requested()) return fail(ErrorCode::kCancelled, "the phantom was stopped");
    progress.report(double(k) / double(count));
    LEFORT_TRY_VOID(io::write_dicom_slice(dicom / name_of(job.variant, k, count),
                                          phantom.slices[std::size_t(k)], k + 1, text));
  }
  progress.begin_stage("write the labels");
  LEFORT_TRY_VOID(io::write_segmentation(job.output / "labels.seg.nrrd", phantom.labels));
  if (!phantom.landmarks.empty())
    LEFORT_TRY_VOID(io::write_landmarks(job.output / "landmarks.mrk.json", phantom.landmarks));
  if (head.has_dentition()) LEFORT_TRY_VOID(write_dentition_files(head, job.output, progress));
  Summary summary;
  summary.text = fmt::format(
      "{}: {} slices in dicom, and their labels in labels.seg.nrrd{}{}", job.output.string(), count,
      phantom.landmarks.empty() ? "" : "; landmarks in landmarks.mrk.json",
      head.has_dentition() ? "; intraoral scans, and what is true in truth.json" : "");
  summary.json = {{"output", job.output.string()}, {"slices", count}};
  return summary;
}

}  // namespace lefort::pipeline
