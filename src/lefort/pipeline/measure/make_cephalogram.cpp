#include <lefort/core/version.h>
#include <lefort/image/radiograph.h>
#include <lefort/io/landmarks_file.h>
#include <lefort/io/output_folder.h>
#include <lefort/io/plan_file.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/cephalogram.h>
#include <lefort/pipeline/measure/head_tracing.h>
#include <lefort/pipeline/plan/cephalometric_table.h>
#include <lefort/pipeline/prepare/oriented_head.h>
#include <lefort/plan/cephalometrics.h>
#include <lefort/report/draw_cephalogram.h>
#include <lefort/report/sheet_pdf.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace lefort::pipeline {
namespace {

constexpr double kPixel_mm = 0.25;
constexpr int kMaxSide = 1400;
constexpr report::Rgb kPointBefore{1.0, 0.95, 0.3}, kPointAfter{1.0, 0.5, 0.2};

/// The scan without what lies outside of the patient (table, head holder).
image::CtVolume patient_only(const ScannedLabels& scanned) {
  image::CtVolume ct = scanned.scan.ct;
  constexpr std::int16_t kAir_hu = -1000;
  for (std::size_t v = 0; v < ct.values.size(); ++v)
    if (scanned.labels.values[v] == anatomy::Tissue::kBackground) ct.values[v] = kAir_hu;
  return ct;
}

/// Box of the patient along the directions of the head, from the center.
struct PatientBox {
  Vec3 center_L;
  double anterior_mm, left_mm, superior_mm;  ///< Half sizes.
};

PatientBox patient_box(const OrientedHead& head) {
  const image::Grid& grid = head.scanned.labels.grid;
  Mat3 R;
  R << head.directions.anterior_L, head.directions.left_L, head.directions.superior_L;
  Box3 box;
  for (std::size_t v = 0; v < head.scanned.labels.values.size(); v += 3) {
    if (head.scanned.labels.values[v] == anatomy::Tissue::kBackground) continue;
    const Index row = Index(v) / grid.size[0];
    const Index i = Index(v) % grid.size[0], j = row % grid.size[1], k = row / grid.size[1];
    box.extend(Vec3(R.transpose() * grid.point_L({double(i), double(j), double(k)})));
  }
  if (box.isEmpty()) box.extend(Vec3::Zero());
  Vec3 center = box.center();
  // The mid-sagittal plane passes through the midline landmarks.
  for (const char* const name : {"N", "ANS", "Sn", "Prn"})
    if (const auto p_L = plan::find_landmark(head.landmarks, name)) {
      center.y() = head.directions.left_L.dot(*p_L);
      break;
    }
  constexpr double kBorder_mm = 10.0;
  const Vec3 half = 0.5 * box.sizes() + Vec3::Constant(kBorder_mm);
  return {R * center, half.x(), half.y(), half.z()};
}

LateralView lateral_view(const OrientedHead& head, const PatientBox& box) {
  LateralView view;
  view.center_L = box.center_L;
  view.directions = head.directions;
  const double larger_mm = 2.0 * std::max(box.anterior_mm, box.superior_mm);
  view.pixel_mm = std::max(kPixel_mm, larger_mm / kMaxSide);
  view.columns = int(std::ceil(2.0 * box.anterior_mm / view.pixel_mm));
  view.rows = int(std::ceil(2.0 * box.superior_mm / view.pixel_mm));
  return view;
}

std::string scale_note(const std::optional<double>& source_mm, const char* plane) {
  if (!source_mm) return fmt::format("parallel projection; scale of the {} plane", plane);
  return fmt::format("central projection, source {:g} mm from the {} plane; scale of that plane",
                     *source_mm, plane);
}

/// The radiograph of one view.
report::CephalogramDrawing drawing_of(const image::CtVolume& ct,
                                      const image::RadiographView& view) {
  report::CephalogramDrawing drawing;
  drawing.columns = view.columns;
  drawing.rows = view.rows;
  drawing.pixel_mm = view.pixel_mm;
  drawing.water_mm = image::radiograph(ct, view, 0.7 * ct.grid.spacing_mm.minCoeff());
  return drawing;
}

report::CephalogramDrawing lateral_drawing(const image::CtVolume& ct, const LateralView& view,
                                           const CephalogramJob& job) {
  image::RadiographView rays;
  rays.center_L = view.center_L;
  rays.right_L = view.directions.anterior_L;
  rays.down_L = -view.directions.superior_L;
  rays.columns = view.columns;
  rays.rows = view.rows;
  rays.pixel_mm = view.pixel_mm;
  rays.source_mm = job.source_mm;
  report::CephalogramDrawing drawing = drawing_of(ct, rays);
  drawing.caption = "Lateral cephalogram, from the patient's right";
  drawing.scale_note = scale_note(job.source_mm, "mid-sagittal");
  return drawing;
}

report::CephalogramDrawing frontal_drawing(const image::CtVolume& ct, const OrientedHead& head,
                                           const PatientBox& box, const LateralView& lateral,
                                           const CephalogramJob& job) {
  image::RadiographView rays;
  rays.center_L = box.center_L;
  rays.right_L = head.directions.left_L;
  rays.down_L = -head.directions.superior_L;
  rays.pixel_mm = lateral.pixel_mm;
  rays.columns = int(std::ceil(2.0 * box.left_mm / rays.pixel_mm));
  rays.rows = lateral.rows;
  rays.source_mm = job.source_mm;
  report::CephalogramDrawing drawing = drawing_of(ct, rays);
  drawing.caption = "Frontal cephalogram (anteroposterior), the patient's right on the left";
  drawing.scale_note = scale_note(job.source_mm, "coronal middle");
  return drawing;
}

void add_points(const plan::Landmarks& landmarks, const LateralView& view, const report::Rgb& color,
                bool has_names, report::CephalogramDrawing& drawing) {
  std::vector<std::string> done;
  for (const plan::Landmark& one : landmarks) {
    const plan::LandmarkKind* const kind = plan::landmark_definition(one.name);
    if (kind == nullptr) continue;
    const std::string name = kind->abbreviation;
    if (std::find(done.begin(), done.end(), name) != done.end()) continue;
    done.push_back(name);
    drawing.points.push_back({has_names ? name : std::string(), color,
                              view.pixel_of(*plan::pair_midpoint(landmarks, name))});
  }
}

/// One line per norm: analysis, measurement, norm, value and deviation before and after.
report::ReportTable norms_table(const std::vector<plan::Measurement>& before,
                                const std::vector<plan::Measurement>& after, plan::Sex sex) {
  report::ReportTable table{
      sex == plan::Sex::kFemale ? "Published norms, women" : "Published norms, men",
      {"analysis", "measurement", "unit", "norm", "before", "deviations", "after", "deviations",
       "source"}};
  const auto cells = [&](const plan::CephalometricNorm& norm,
                         const std::vector<plan::Measurement>& values, std::size_t row) {
    std::pair<std::string, std::string> pair;
    if (values.empty() || !values[row].value) return pair;
    pair.first = fmt::format("{:.1f}", *values[row].value);
    if (const auto d = plan::deviation_from(norm, sex, *values[row].value))
      pair.second = fmt::format("{:+.1f}", *d);
    return pair;
  };
  for (const plan::CephalometricNorm& norm : plan::cephalometric_norms()) {
    const auto at = std::find_if(before.begin(), before.end(), [&](const plan::Measurement& one) {
      return one.name == norm.measurement;
    });
    if (at == before.end()) continue;
    const auto row = std::size_t(at - before.begin());
    const plan::NormValue& expected = sex == plan::Sex::kFemale ? norm.female : norm.male;
    const auto [value, deviation] = cells(norm, before, row);
    const auto [value_after, deviation_after] = cells(norm, after, row);
    table.rows.push_back({norm.analysis, norm.measurement, at->unit,
                          expected.deviation
                              ? fmt::format("{:.1f} +- {:.1f}", expected.mean, *expected.deviation)
                              : fmt::format("{:.1f}", expected.mean),
                          value, deviation, value_after, deviation_after, norm.source});
  }
  return table;
}

report::ReportTable measurements_table(const std::vector<plan::Measurement>& before,
                                       const std::vector<plan::Measurement>& after) {
  report::ReportTable table{"All measurements",
                            {"measurement", "unit", "before", "after", "meaning"}};
  const auto cell = [](const std::vector<plan::Measurement>& values, std::size_t row) {
    return values.empty() || !values[row].value ? std::string()
                                                : fmt::format("{:.1f}", *values[row].value);
  };
  for (std::size_t row = 0; row < before.size(); ++row)
    if (before[row].value)
      table.rows.push_back({before[row].name, before[row].unit, cell(before, row), cell(after, row),
                            before[row].meaning});
  return table;
}

/// Landmarks that no search finds: with this name in the list, all others are searched.
constexpr const char* kNeverInFile = "";

/// The head with the landmarks of the plan, if results of the plan are given, so that landmarks
/// before and after surgery are the same points.
Result<OrientedHead> head_before(const CephalogramJob& job, Progress& progress) {
  const std::array<std::string, 1> needed{kNeverInFile};
  if (job.check && !job.landmarks && !job.prediction)
    return fail(ErrorCode::kInvalidArgument,
                "with --check give the landmarks of the plan, too (--landmarks): others would be "
                "compared with them");
  if (!job.prediction || job.landmarks)
    return oriented_head({job.ct, job.labels, job.landmarks}, needed, progress);
  LEFORT_TRY(const io::PlanFile plan, io::read_plan(*job.prediction / "plan.json"));
  LEFORT_TRY(OrientedHead head, oriented_head({job.ct, job.labels, {}}, needed, progress));
  if (plan.landmarks.empty()) return head;
  head.landmarks = plan.landmarks;
  LEFORT_TRY(head.directions, plan::head_directions(head.landmarks));
  return head;
}

std::string csv_of(const report::ReportTable& table) {
  std::string text;
  const auto add = [&](const std::vector<std::string>& cells) {
    for (std::size_t c = 0; c < cells.size(); ++c) {
      const bool quote = cells[c].find(',') != std::string::npos;
      text +=
          fmt::format("{}{}{}{}", c > 0 ? "," : "", quote ? "\"" : "", cells[c], quote ? "\"" : "");
    }
    text += "\n";
  };
  add(table.heads);
  for (const auto& row : table.rows) add(row);
  return text;
}

/// What the command writes.
struct Cephalogram {
  std::string lateral_png, frontal_png, tracing_png, pdf, measurements_csv, norms_csv;
};

report::Sheet sheet_of(const Cephalogram& made, const OrientedHead& head,
                       const report::ReportTable& norms, const report::ReportTable& all) {
  report::Sheet sheet;
  sheet.title = "Cephalometric analysis";
  sheet.lines = {
      "Landmarks and projections were computed from a CT; check each landmark in the pictures. "
      "Deviations are in standard deviations of the norm. Norms are of Caucasian samples; lengths "
      "of McNamara are reduced to life size. The vertical is perpendicular to the Frankfurt "
      "horizontal, not that of the natural head position. Not verified: not compared with the "
      "printed paper."};
  sheet.lines.push_back(head.directions.has_frankfurt_horizontal
                            ? "Vertical: perpendicular to the Frankfurt horizontal."
                            : "The Frankfurt horizontal is not known: directions are of the scan.");
  sheet.lines.push_back(fmt::format("CT: SHA-256 {}", head.scanned.ct_sha256.substr(0, 16)));
  sheet.pictures = {{"lateral, with tracing", "", made.tracing_png},
                    {"frontal", "", made.frontal_png}};
  sheet.tables = {norms, all};
  return sheet;
}

Result<Cephalogram> draw_all(const OrientedHead& head, const HeadAfter& after,
                             const CephalogramJob& job, Progress& progress) {
  const PatientBox box = patient_box(head);
  const LateralView view = lateral_view(head, box);
  progress.begin_stage("trace bone and skin");
  LEFORT_TRY(auto tracings, trace_head(head, after, view, progress));
  progress.begin_stage("compute the cephalograms");
  const image::CtVolume ct = patient_only(head.scanned);
  Cephalogram made;
  report::CephalogramDrawing lateral = lateral_drawing(ct, view, job);
  LEFORT_TRY(const report::Picture plain, report::draw_cephalogram(lateral));
  LEFORT_TRY(made.lateral_png, report::encode_png(plain));
  lateral.caption = "Lateral cephalogram with tracing of the mid-sagittal plane";
  lateral.tracings = std::move(tracings);
  add_points(head.landmarks, view, kPointBefore, true, lateral);
  add_points(after.landmarks, view, kPointAfter, false, lateral);
  LEFORT_TRY(const report::Picture traced, report::draw_cephalogram(lateral));
  LEFORT_TRY(made.tracing_png, report::encode_png(traced));
  LEFORT_TRY(const report::Picture frontal,
             report::draw_cephalogram(frontal_drawing(ct, head, box, view, job)));
  LEFORT_TRY(made.frontal_png, report::encode_png(frontal));
  return made;
}

Result<void> write_all(const CephalogramJob& job, const Cephalogram& made, const Summary& summary) {
  LEFORT_TRY_VOID(io::make_output_folder(job.output));
  for (const auto& [name, text] : {std::pair{"lateral.png", &made.lateral_png},
                                   {"frontal.png", &made.frontal_png},
                                   {"tracing.png", &made.tracing_png},
                                   {"cephalometry.pdf", &made.pdf},
                                   {"measurements.csv", &made.measurements_csv},
                                   {"norms.csv", &made.norms_csv}})
    LEFORT_TRY_VOID(io::write_text(job.output / name, *text));
  return io::write_text(job.output / "cephalogram.json", summary.json.dump(1) + "\n");
}

}  // namespace

Result<Summary> make_cephalogram(const CephalogramJob& job, Progress& progress) {
  LEFORT_TRY(const OrientedHead head, head_before(job, progress));
  LEFORT_TRY(const HeadAfter after, read_after(job, head.landmarks, progress));
  LEFORT_TRY(const auto before_table, plan::measure(head.landmarks));
  std::vector<plan::Measurement> after_table;
  if (!after.landmarks.empty()) {
    LEFORT_TRY(after_table, plan::measure(after.landmarks, head.landmarks));
  }
  LEFORT_TRY(Cephalogram made, draw_all(head, after, job, progress));
  const report::ReportTable norms = norms_table(before_table, after_table, job.sex);
  LEFORT_TRY(made.pdf, report::sheet_pdf(sheet_of(made, head, norms,
                                                  measurements_table(before_table, after_table))));
  made.measurements_csv = io::cephalometric_csv(before_table, after_table);
  made.norms_csv = csv_of(norms);
  Summary summary;
  summary.text = fmt::format("{}: cephalograms and analysis of {} landmarks{}\n{}",
                             job.output.string(), head.landmarks.size(),
                             cephalometric_text(before_table, after_table), kNotForClinicalUse);
  summary.json = {{"lefort_cephalogram", 1},
                  {"notice", kNotForClinicalUse},
                  {"source_mm", job.source_mm ? nlohmann::json(*job.source_mm) : nlohmann::json()},
                  {"has_frankfurt_horizontal", head.directions.has_frankfurt_horizontal},
                  {"measurements", cephalometric_json(before_table, after_table)}};
  LEFORT_TRY_VOID(write_all(job, made, summary));
  return summary;
}

}  // namespace lefort::pipeline
