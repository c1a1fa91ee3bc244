/// \file
/// One function per stage, file to file. The command line calls nothing else; a server or a Python
/// module would call the same.
#pragma once

#include <lefort/anatomy/segment_tissue.h>
#include <lefort/app/finish_surface.h>
#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/field/build_distance_field.h>
#include <lefort/predict/check_plan.h>
#include <lefort/predict/face_prediction.h>

#include <nlohmann/json.hpp>

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace lefort::app {

/// What a stage says when it is done.
struct Summary {
  std::string text;     ///< For people: a few lines.
  nlohmann::json json;  ///< For programs.
};

struct ImportJob {
  std::filesystem::path source;
  std::filesystem::path output;    ///< .nrrd, .nii.gz or .mha.
  int series = 0;                  ///< Of a DICOM folder or study; 0: the only CT there is.
  std::string user{}, password{};  ///< Of a DICOMweb server, unless its address has them.
};
/// Scan in any format -> volume in HU and L.
[[nodiscard]] Result<Summary> import_scan(const ImportJob& job, Progress& progress);

/// DICOM folder or study -> what series there are; the job's output is not used.
[[nodiscard]] Result<Summary> list_scans(const ImportJob& job, Progress& progress);

/// How the scanner takes the synthetic head.
enum class PhantomVariant { kPlain, kTilted, kShuffled, kOblique, kFeetFirst };
struct PhantomJob {
  std::filesystem::path output;  ///< A folder; made if missing.
  PhantomVariant variant = PhantomVariant::kPlain;
  double voxel_mm = 1.4;
  double noise_hu = 12.0;
};
/// Nothing -> DICOM files of a synthetic head (anatomy/synthetic_head.h), and its true labels.
[[nodiscard]] Result<Summary> make_phantom(const PhantomJob& job, Progress& progress);

struct SegmentJob {
  std::filesystem::path ct;
  std::filesystem::path output;  ///< A folder; made if missing.
  anatomy::SegmentationOptions options;
  SurfaceFinish finish;
  bool auto_thresholds = false;  ///< From the histogram, instead of those of the options.
  std::optional<std::filesystem::path> labels;  ///< Surfaces of these, instead of segmenting.
};
/// Scan -> labels.seg.nrrd, skull.vtp, skin.vtp.
[[nodiscard]] Result<Summary> segment_scan(const SegmentJob& job, Progress& progress);

struct BuildFieldJob {
  std::filesystem::path surface;
  std::filesystem::path output;
  field::DistanceFieldOptions options;
};
/// Surface -> distance field.
[[nodiscard]] Result<Summary> build_field(const BuildFieldJob& job, Progress& progress);

struct QueryFieldJob {
  std::filesystem::path field;
  std::filesystem::path points;  ///< Text: x, y, z in mm a line, separated by commas or spaces.
  std::filesystem::path output;  ///< CSV.
  bool smooth = false;           ///< The differentiable reconstruction.
};
/// Field and points -> distance, gradient and zone of each point.
[[nodiscard]] Result<Summary> query_field(const QueryFieldJob& job, Progress& progress);

struct ExportFieldJob {
  std::filesystem::path field;
  std::filesystem::path output;   ///< .vdb or .nrrd.
  std::vector<double> region_mm;  ///< Empty, or from and to along x, y and z.
  int every = 1;                  ///< Each n-th sample along each axis.
};
/// Field -> the same in a format that other programs read.
[[nodiscard]] Result<Summary> export_field(const ExportFieldJob& job, Progress& progress);

struct SliceFieldJob {
  std::filesystem::path field;
  std::filesystem::path output;  ///< .png.
  int axis = 2;                  ///< Across the plane: 0 x, 1 y, 2 z.
  double at_mm = 0.0;
  int width_px = 1200;                        ///< Pixels across the plane.
  std::optional<int> every;                   ///< Instead: pixels of so many cells of the field.
  std::vector<double> region_mm;              ///< Empty, or from and to along x, y and z.
  std::optional<std::filesystem::path> mesh;  ///< Surface whose section is drawn, too.
  bool smooth = false;                        ///< The differentiable reconstruction.
};
/// Field -> picture of a plane through it.
[[nodiscard]] Result<Summary> slice_field(const SliceFieldJob& job, Progress& progress);

/// Field -> what it is, how large, and whether the file is whole.
[[nodiscard]] Result<Summary> describe_field(const std::filesystem::path& field,
                                             Progress& progress);

struct LandmarksJob {
  std::filesystem::path before;                 ///< .mrk.json or .csv.
  std::optional<std::filesystem::path> after;   ///< Likewise.
  std::optional<std::filesystem::path> output;  ///< .csv.
  std::optional<std::filesystem::path> save;    ///< .mrk.json or .csv.
};
/// Landmarks -> angles and distances between them.
[[nodiscard]] Result<Summary> measure_landmarks(const LandmarksJob& job, Progress& progress);

struct CheckPlanJob {
  std::filesystem::path plan;
  std::optional<std::filesystem::path> ct;     ///< Instead of the plan's.
  std::optional<std::filesystem::path> skull;  ///< A closed surface, instead of any scan.
  std::filesystem::path output;                ///< A folder; made if missing.
  std::optional<std::filesystem::path> cache;  ///< A folder; cache/ of the output unless given.
  predict::PlanLimits limits;
  bool pictures = true;
};
struct PlanCheckSummary {
  Summary summary;
  bool has_findings = false;  ///< Something was found against the plan.
};
/// Plan -> cut bones where they end, and what keeps them from going there.
[[nodiscard]] Result<PlanCheckSummary> check_plan_file(const CheckPlanJob& job, Progress& progress);

struct CutJob {
  std::filesystem::path plan;
  std::filesystem::path ct;
  std::filesystem::path cache;   ///< A folder that keeps what stages share.
  std::filesystem::path output;  ///< A folder; made if missing.
};
/// Plan -> its bones where they are before they move, and their distance fields: what a page needs
/// to move them. cut.json, which is written last, names the files.
[[nodiscard]] Result<Summary> cut_plan(const CutJob& job, Progress& progress);

struct PreviewJob {
  std::filesystem::path plan;
  std::filesystem::path ct;
  std::filesystem::path cache;   ///< As of CutJob.
  std::filesystem::path skin;    ///< The surface whose displacement is wanted: segment_scan()'s.
  std::filesystem::path output;  ///< A folder; made if missing.
};
/// Plan -> how the face answers its segment's motion to first order; preview.json is written last.
[[nodiscard]] Result<Summary> prepare_preview(const PreviewJob& job, Progress& progress);

struct PredictJob {
  std::filesystem::path plan;
  std::optional<std::filesystem::path> ct;  ///< Instead of the plan's.
  std::filesystem::path output;             ///< A folder; made if missing.
  bool pictures = true;
  /// Told each step of the path as it is found; may be empty.
  std::function<void(const predict::PredictionStep&, int steps)> on_step{};
  /// Likewise each of Newton's iterations.
  std::function<void(const predict::PredictionIterate&, int steps)> on_iterate{};
};
/// Plan -> predicted face, with everything that documents it.
[[nodiscard]] Result<Summary> predict_case(const PredictJob& job, Progress& progress);

struct CompareJob {
  std::filesystem::path face;                      ///< A surface, or the folder of a prediction.
  std::optional<std::filesystem::path> other;      ///< Likewise: what it is held against.
  std::optional<std::filesystem::path> after_ct;   ///< Instead: a scan after surgery.
  std::optional<std::filesystem::path> before;     ///< The skin before surgery, for the baseline.
  std::optional<std::filesystem::path> landmarks;  ///< Before surgery: they tell the regions.
  std::filesystem::path output;                    ///< A folder; made if missing.
  bool pictures = true;
};
/// Two faces -> how far they are apart, by region; with a scan after surgery also how each segment
/// was moved.
[[nodiscard]] Result<Summary> compare_faces(const CompareJob& job, Progress& progress);

struct SolveJob {
  bool quiet = false;  ///< Do not tell each increment.
  std::filesystem::path deck;
  std::filesystem::path output;  ///< A folder; made if missing.
  bool check_only = false;       ///< Read and check, no more.
};
/// Deck and mesh -> displacement, stress and reactions over time.
[[nodiscard]] Result<Summary> solve_deck(const SolveJob& job, Progress& progress);
struct ConvergenceJob {
  std::vector<std::filesystem::path> plans;
  std::optional<std::filesystem::path> ct;  ///< Instead of the plans'.
  std::filesystem::path output;             ///< A folder; made if missing.
  std::vector<std::string> methods;         ///< Names; empty: all.
  std::optional<double> element_size_mm;    ///< Instead of the plans'; far elements likewise.
  std::vector<int> steps;                   ///< Each plan with each of them; empty: its own.
  bool synthetic = true;                    ///< Also the cases that need no scan.
};
/// Plans -> how Newton's residual falls by each way of detecting contact (the paper's Figure 5).
[[nodiscard]] Result<Summary> bench_convergence(const ConvergenceJob& job, Progress& progress);

struct VerifyJob {
  std::filesystem::path output;  ///< A folder, made if missing; empty: no report.
  bool full = false;
  std::string only;  ///< Name of one case; empty for all.
};
struct VerifySummary {
  Summary summary;
  bool passed = false;  ///< Every check.
};
/// Runs the solver's verification suite; writes verification.md and its plots.
[[nodiscard]] Result<VerifySummary> verify_solver(const VerifyJob& job, Progress& progress);

}  // namespace lefort::app
