#include <lefort/anatomy/parametric_head.h>
#include <lefort/io/landmarks_file.h>
#include <lefort/io/output_folder.h>
#include <lefort/io/segmentation_file.h>
#include <lefort/io/volume_files.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/prepare/find_head_landmarks.h>
#include <lefort/pipeline/verify.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

namespace lefort::pipeline {
namespace {

namespace fs = std::filesystem;

struct Errors {
  std::vector<double> distances_mm;
  double uncertainty_mm = 0.0;  ///< Sum.
  Index missing = 0;
};

/// The value below which a fraction of the sorted values lies.
double quantile(const std::vector<double>& sorted, double fraction) {
  if (sorted.empty()) return std::nan("");
  const double at = fraction * double(sorted.size() - 1);
  const auto low = std::size_t(at);
  const std::size_t high = std::min(low + 1, sorted.size() - 1);
  return sorted[low] + (at - double(low)) * (sorted[high] - sorted[low]);
}

Result<void> write_scan(const fs::path& folder, std::uint64_t seed,
                        const anatomy::LabeledScan& scan,
                        const std::vector<anatomy::NamedPoint>& truth) {
  plan::Landmarks landmarks;
  for (const auto& [name, p_L] : truth) landmarks.push_back({name, p_L});
  LEFORT_TRY_VOID(io::make_output_folder(folder));
  LEFORT_TRY_VOID(io::write_volume(folder / fmt::format("head_{}.nrrd", seed), scan.ct));
  LEFORT_TRY_VOID(
      io::write_segmentation(folder / fmt::format("head_{}.seg.nrrd", seed), scan.labels));
  return io::write_landmarks(folder / fmt::format("head_{}.mrk.json", seed), landmarks);
}

Summary summarize(std::map<std::string, Errors>& errors, int heads) {
  Summary summary;
  std::vector<double> all;
  Index missing = 0;
  summary.text = "  landmark   median mm   P95 mm   max mm   mean uncertainty mm   missing";
  nlohmann::json rows = nlohmann::json::object();
  for (auto& [name, one] : errors) {
    std::vector<double>& sorted = one.distances_mm;
    std::sort(sorted.begin(), sorted.end());
    all.insert(all.end(), sorted.begin(), sorted.end());
    missing += one.missing;
    const double median_mm = quantile(sorted, 0.5), p95_mm = quantile(sorted, 0.95);
    const double mean_mm = one.uncertainty_mm / double(std::max<std::size_t>(1, sorted.size()));
    summary.text += fmt::format("\n  {:<8} {:10.2f} {:10.2f} {:8.2f} {:14.2f} {:14}", name,
                                median_mm, p95_mm, quantile(sorted, 1.0), mean_mm, one.missing);
    rows[name] = {{"median_mm", median_mm},
                  {"p95_mm", p95_mm},
                  {"mean_uncertainty_mm", mean_mm},
                  {"missing", one.missing}};
  }
  std::sort(all.begin(), all.end());
  summary.text =
      fmt::format(
          "{} heads, {} landmarks: median {:.2f} mm, P95 {:.2f} mm, max {:.2f} "
          "mm; {} not found\n",
          heads, all.size(), quantile(all, 0.5), quantile(all, 0.95), quantile(all, 1.0), missing) +
      summary.text;
  summary.json = {{"heads", heads},
                  {"landmarks", all.size()},
                  {"median_mm", quantile(all, 0.5)},
                  {"p95_mm", quantile(all, 0.95)},
                  {"missing", missing},
                  {"by_landmark", rows}};
  return summary;
}

}  // namespace

Result<Summary> bench_landmarks(const LandmarkBenchJob& job, Progress& progress) {
  if (job.output.extension() != ".csv")
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("output file {} must end in .csv", job.output.string()));
  std::map<std::string, Errors> errors;
  std::string table = "seed,landmark,error_mm,x_mm,y_mm,z_mm,uncertainty_mm,reason\n";
  for (int n = 0; n < job.heads; ++n) {
    const std::uint64_t seed = job.seed + std::uint64_t(n);
    const anatomy::ParametricHead head(anatomy::draw_head_shape(seed));
    const std::vector<anatomy::NamedPoint> truth = anatomy::true_landmarks(head);
    const anatomy::LabeledScan scan = anatomy::scan_of(head, job.voxel_mm, job.noise_hu, seed);
    if (job.scans) LEFORT_TRY_VOID(write_scan(*job.scans, seed, scan, truth));
    LEFORT_TRY(const plan::LandmarkSearch search,
               find_head_landmarks(scan.ct, scan.labels, {}, progress));
    for (const auto& [name, p_L] : truth) {
      Errors& one = errors[name];
      const auto found =
          std::find_if(search.found.begin(), search.found.end(),
                       [&](const auto& landmark) { return landmark.landmark.name == name; });
      if (found == search.found.end()) {
        ++one.missing;
        const auto why = std::find_if(search.missing.begin(), search.missing.end(),
                                      [&](const auto& landmark) { return landmark.name == name; });
        table += fmt::format("{},{},,,,,,{}\n", seed, name,
                             why == search.missing.end() ? "" : why->reason);
        continue;
      }
      // In the directions of the head.
      const Vec3 offset = head.X_LH().linear().transpose() * (found->landmark.point_L - p_L);
      one.distances_mm.push_back(offset.norm());
      one.uncertainty_mm += found->uncertainty_mm;
      table += fmt::format("{},{},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f},\n", seed, name, offset.norm(),
                           offset.x(), offset.y(), offset.z(), found->uncertainty_mm);
    }
    progress.report(double(n + 1) / double(job.heads));
  }
  LEFORT_TRY_VOID(io::write_text(job.output, table));
  return summarize(errors, job.heads);
}

}  // namespace lefort::pipeline
