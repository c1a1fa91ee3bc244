#include <lefort/bench/competitors.h>
#include <lefort/bench/detection.h>
#include <lefort/bench/field_process.h>
#include <lefort/bench/stopwatch.h>
#include <lefort/bench/surface_points.h>
#include <lefort/contact/measure_gap.h>
#include <lefort/core/parallel.h>
#include <lefort/core/version.h>
#include <lefort/field/build/build_distance_field.h>
#include <lefort/io/surface_files.h>
#include <lefort/io/write_atomically.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <vector>

namespace lefort::bench {
namespace {

constexpr double kBand_mm = 5.0;
constexpr std::uint32_t kSeed = 3;

/// Somewhere else, turned about all axes.
RigidTransform moved() {
  RigidTransform X_LB = RigidTransform::Identity();
  X_LB.linear() = Eigen::AngleAxisd(0.2, Vec3(1.0, 2.0, -1.0).normalized()).toRotationMatrix();
  X_LB.translation() = Vec3(3.0, -12.0, -5.0);
  return X_LB;
}

/// Of one run. Processor time tells a busy machine's ratios truer: others only lengthen the wait.
struct Time {
  double wall_s = std::numeric_limits<double>::infinity();
  double processor_s = std::numeric_limits<double>::infinity();
};

/// One way to detect, and what it found.
struct Measured {
  std::string name;
  Time time = {};
  std::vector<double> depth_mm = {};  ///< NaN where there is no answer.
};

Time best_of(int repeats, const std::function<void()>& run) {
  Time best;
  for (int n = 0; n < repeats; ++n) {
    const double before_s = processor_seconds();
    const Stopwatch watch;
    run();
    best.wall_s = std::min(best.wall_s, watch.seconds());
    best.processor_s = std::min(best.processor_s, processor_seconds() - before_s);
  }
  return best;
}

Measured measure(const std::string& name,
                 std::shared_ptr<const contact::DistanceQuery> distance_query_B,
                 std::span<const Vec3> points_L, contact::Derivatives derivatives, int repeats) {
  const contact::RigidObstacle bone{std::move(distance_query_B), moved()};
  std::vector<contact::Gap> gaps(points_L.size());
  Measured measured{.name = name};
  measured.time =
      best_of(repeats, [&] { contact::measure_gaps(bone, points_L, derivatives, gaps); });
  for (const contact::Gap& gap : gaps)
    measured.depth_mm.push_back(gap.zone == field::Zone::kBand ? gap.gap_mm : std::nan(""));
  return measured;
}

Measured measure_cgal(const geometry::TriangleMesh& skull_B, std::span<const Vec3> points_L,
                      int repeats) {
  const CgalTree tree(skull_B);
  const RigidTransform X_BL = moved().inverse();
  std::vector<Vec3> points_B(points_L.size());
  Measured measured{.name = "CGAL AABB tree, unsigned",
                    .depth_mm = std::vector<double>(points_L.size())};
  measured.time = best_of(repeats, [&] {
    parallel_for_blocks(Index(points_L.size()), [&](Index begin, Index end) {
      const auto at = std::size_t(begin), count = std::size_t(end - begin);
      for (std::size_t i = at; i < at + count; ++i) points_B[i] = X_BL * points_L[i];
      tree.distances(std::span<const Vec3>(points_B).subspan(at, count),
                     std::span(measured.depth_mm).subspan(at, count));
    });
  });
  return measured;
}

/// Differences of distance from the exact ones, both without their sign: CGAL's have none.
struct Difference {
  double p50_mm, p99_mm, max_mm;
  Index none;  ///< Points without an answer.
};

Difference difference(const Measured& measured, const Measured& exact) {
  std::vector<double> off_mm;
  Index none = 0;
  for (std::size_t i = 0; i < exact.depth_mm.size(); ++i) {
    if (std::isnan(measured.depth_mm[i]))
      ++none;
    else
      off_mm.push_back(std::abs(std::abs(measured.depth_mm[i]) - std::abs(exact.depth_mm[i])));
  }
  std::sort(off_mm.begin(), off_mm.end());
  const auto at = [&](double fraction) {
    return off_mm[std::size_t(fraction * double(off_mm.size() - 1))];
  };
  return {at(0.5), at(0.99), at(1.0), none};
}

/// The samples of a field that lie nearest to some points: there it promises its tolerance; between
/// them, edges of the surface are rounded off.
std::vector<Vec3> nearest_samples(const field::FieldFrame& frame, std::span<const Vec3> points_B) {
  std::vector<Vec3> samples;
  for (const Vec3& p : points_B)
    samples.emplace_back(frame.origin_B +
                         frame.cell_mm *
                             ((p - frame.origin_B) / frame.cell_mm).array().round().matrix());
  return samples;
}

Index wrong_sides(const Measured& measured, const Measured& exact) {
  Index wrong = 0;
  for (std::size_t i = 0; i < exact.depth_mm.size(); ++i)
    if (measured.depth_mm[i] * exact.depth_mm[i] < 0.0) ++wrong;
  return wrong;
}

}  // namespace

Result<std::string> run_detection(const DetectionOptions& options, Progress& progress) {
  LEFORT_TRY(const auto skull_file, prepare_skull(options.ct, options.output, progress));
  LEFORT_TRY(const geometry::TriangleMesh skull_B, io::read_surface(skull_file));
  progress.begin_stage("build the field and the trees");
  LEFORT_TRY(field::DistanceField built,
             field::build_distance_field(
                 skull_B, {.resolution = options.resolution, .band_mm = kBand_mm, .smooth = true},
                 progress));
  const auto field_B = std::make_shared<const field::DistanceField>(std::move(built));
  LEFORT_TRY(const auto trilinear,
             contact::field_distance_query(field_B, contact::DetectionMethod::kTrilinear));
  LEFORT_TRY(const auto smooth,
             contact::field_distance_query(field_B, contact::DetectionMethod::kSmooth));
  const auto tree =
      contact::bvh_distance_query(std::make_shared<const geometry::Bvh>(skull_B), kBand_mm);

  progress.begin_stage("measure");
  const ThreadLimit limit(options.threads);
  std::vector<Vec3> points_L =
      points_near_surface(skull_B, options.points, options.reach_mm, kSeed);
  std::vector<Vec3> samples_L = nearest_samples(field_B->frame(), points_L);
  for (Vec3& p : points_L) p = moved() * p;
  for (Vec3& p : samples_L) p = moved() * p;
  using enum contact::Derivatives;
  const std::vector<Measured> all{
      measure("field, trilinear", trilinear, points_L, kFirst, options.repeats),
      measure("field, trilinear, with Hessian", trilinear, points_L, kSecond, options.repeats),
      measure("field, smooth", smooth, points_L, kFirst, options.repeats),
      measure("field, smooth, with Hessian", smooth, points_L, kSecond, options.repeats),
      measure("our BVH", tree, points_L, kFirst, options.repeats),
      measure_cgal(skull_B, points_L, options.repeats)};
  const Measured& exact = all[4];

  std::string table = fmt::format(
      "# Detection of contact\n\nlefort {}, `lefort bench detection`: {} points within {:g} mm of "
      "a "
      "moved skull of {} triangles, {} threads, best of {}; field {}³ (cell {:.2f} mm, band {:g} "
      "mm). Ratios are those of processor time. Differences are those of unsigned distance from "
      "our "
      "BVH's.\n\n"
      "| detected by | ms | processor µs a point | our BVH / it | CGAL / it | P50 / P99 / max "
      "difference mm | "
      "wrong side | no answer |\n|---|---|---|---|---|---|---|---|\n",
      kVersion, options.points, options.reach_mm, skull_B.triangle_count(), options.threads,
      options.repeats, options.resolution, field_B->cell_mm(), kBand_mm);
  for (const Measured& measured : all) {
    const Difference off = difference(measured, exact);
    table += fmt::format(
        "| {} | {:.2f} | {:.3f} | {:.1f} | {:.1f} | {:.4f} / {:.3f} / {:.3f} | {} | {} |\n",
        measured.name, 1e3 * measured.time.wall_s,
        1e6 * measured.time.processor_s / double(options.points),
        exact.time.processor_s / measured.time.processor_s,
        all[5].time.processor_s / measured.time.processor_s, off.p50_mm, off.p99_mm, off.max_mm,
        &measured == &all[5] ? std::string("–") : fmt::format("{}", wrong_sides(measured, exact)),
        off.none);
  }
  const Measured exact_there = measure("our BVH", tree, samples_L, kFirst, 1);
  table += fmt::format(
      "\nAt the samples nearest to those points, which the field is to keep to {:g} mm:\n\n"
      "| detected by | P50 / P99 / max difference mm |\n|---|---|\n",
      field_B->frame().tolerance_mm);
  for (const Measured& measured : {measure("field, trilinear", trilinear, samples_L, kFirst, 1),
                                   measure("field, smooth", smooth, samples_L, kFirst, 1)}) {
    const Difference off = difference(measured, exact_there);
    table += fmt::format("| {} | {:.4f} / {:.4f} / {:.4f} |\n", measured.name, off.p50_mm,
                         off.p99_mm, off.max_mm);
  }
  LEFORT_TRY_VOID(io::write_text(options.output / "detection.md", table));
  return table;
}

}  // namespace lefort::bench
