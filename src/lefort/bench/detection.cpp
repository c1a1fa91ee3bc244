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
#include <nlohmann/json.hpp>

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

/// A pose with a rotation about all axes.
RigidTransform moved() {
  RigidTransform X_LB = RigidTransform::Identity();
  X_LB.linear() = Eigen::AngleAxisd(0.2, Vec3(1.0, 2.0, -1.0).normalized()).toRotationMatrix();
  X_LB.translation() = Vec3(3.0, -12.0, -5.0);
  return X_LB;
}

/// Time of one run. On a busy machine ratios of processor time are more reliable.
struct Time {
  double wall_s = std::numeric_limits<double>::infinity();
  double processor_s = std::numeric_limits<double>::infinity();
};

/// One method and its results.
struct Measured {
  std::string name;
  Time time = {};
  std::vector<double> depth_mm = {};  ///< NaN without a result.
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

/// Differences from the exact distances, both unsigned: CGAL's have no sign.
struct Difference {
  double p50_mm, p99_mm, max_mm;
  Index none;  ///< Points without a result.
};

Difference difference(const Measured& measured, const Measured& exact) {
  std::vector<double> errors_mm;
  Index none = 0;
  for (std::size_t i = 0; i < exact.depth_mm.size(); ++i) {
    if (std::isnan(measured.depth_mm[i]))
      ++none;
    else
      errors_mm.push_back(std::abs(std::abs(measured.depth_mm[i]) - std::abs(exact.depth_mm[i])));
  }
  std::sort(errors_mm.begin(), errors_mm.end());
  const auto at = [&](double fraction) {
    return errors_mm[std::size_t(fraction * double(errors_mm.size() - 1))];
  };
  return {at(0.5), at(0.99), at(1.0), none};
}

/// Samples of a field closest to some points. The tolerance of the field holds there; between
/// samples, edges of the surface are rounded.
std::vector<Vec3> nearest_samples(const field::FieldFrame& frame, std::span<const Vec3> points_B) {
  std::vector<Vec3> samples;
  for (const Vec3& p : points_B)
    samples.emplace_back(frame.origin_B +
                         frame.cell_mm *
                             ((p - frame.origin_B) / frame.cell_mm).array().round().matrix());
  return samples;
}

Index wrong_signs(const Measured& measured, const Measured& exact) {
  Index wrong = 0;
  for (std::size_t i = 0; i < exact.depth_mm.size(); ++i)
    if (measured.depth_mm[i] * exact.depth_mm[i] < 0.0) ++wrong;
  return wrong;
}

using contact::Derivatives;
using DistanceQueryPtr = std::shared_ptr<const contact::DistanceQuery>;

/// The distance queries that are compared.
struct Queries {
  std::shared_ptr<const field::DistanceField> field_B;
  DistanceQueryPtr trilinear, smooth, tree;
};

Result<Queries> build_queries(const geometry::TriangleMesh& skull_B, int resolution,
                              Progress& progress) {
  LEFORT_TRY(
      field::DistanceField built,
      field::build_distance_field(
          skull_B, {.resolution = resolution, .band_mm = kBand_mm, .smooth = true}, progress));
  Queries queries;
  queries.field_B = std::make_shared<const field::DistanceField>(std::move(built));
  LEFORT_TRY(queries.trilinear,
             contact::field_distance_query(queries.field_B, contact::DetectionMethod::kTrilinear));
  LEFORT_TRY(queries.smooth,
             contact::field_distance_query(queries.field_B, contact::DetectionMethod::kSmooth));
  queries.tree =
      contact::bvh_distance_query(std::make_shared<const geometry::Bvh>(skull_B), kBand_mm);
  return queries;
}

/// Indices in the result of measure_all().
constexpr std::size_t kExact = 4, kCgal = 5;

std::vector<Measured> measure_all(const Queries& queries, const geometry::TriangleMesh& skull_B,
                                  std::span<const Vec3> points_L, int repeats) {
  return {measure("field, trilinear", queries.trilinear, points_L, Derivatives::kFirst, repeats),
          measure("field, trilinear, with Hessian", queries.trilinear, points_L,
                  Derivatives::kSecond, repeats),
          measure("field, smooth", queries.smooth, points_L, Derivatives::kFirst, repeats),
          measure("field, smooth, with Hessian", queries.smooth, points_L, Derivatives::kSecond,
                  repeats),
          measure("our BVH", queries.tree, points_L, Derivatives::kFirst, repeats),
          measure_cgal(skull_B, points_L, repeats)};
}

std::string methods_table(const std::vector<Measured>& all, const Queries& queries,
                          const geometry::TriangleMesh& skull_B, const DetectionOptions& options) {
  const Measured &exact = all[kExact], &cgal = all[kCgal];
  std::string table = fmt::format(
      "# Contact detection\n\nlefort {}, `lefort bench detection`: {} points within {:g} mm of a "
      "moved skull of {} triangles, {} threads, best of {}; field {}³ (cell {:.2f} mm, band {:g} "
      "mm). Ratios are those of processor time. Differences are those of unsigned distance from "
      "our BVH's.\n\n"
      "| method | ms | processor µs a point | our BVH / it | CGAL / it | P50 / P99 / max "
      "difference mm | wrong sign | no result |\n|---|---|---|---|---|---|---|---|\n",
      kVersion, options.points, options.max_distance_mm, skull_B.triangle_count(), options.threads,
      options.repeats, options.resolution, queries.field_B->cell_mm(), kBand_mm);
  for (const Measured& measured : all) {
    const Difference error = difference(measured, exact);
    table += fmt::format(
        "| {} | {:.2f} | {:.3f} | {:.1f} | {:.1f} | {:.4f} / {:.3f} / {:.3f} | {} | {} |\n",
        measured.name, 1e3 * measured.time.wall_s,
        1e6 * measured.time.processor_s / double(options.points),
        exact.time.processor_s / measured.time.processor_s,
        cgal.time.processor_s / measured.time.processor_s, error.p50_mm, error.p99_mm, error.max_mm,
        &measured == &cgal ? std::string("–") : fmt::format("{}", wrong_signs(measured, exact)),
        error.none);
  }
  return table;
}

std::string samples_table(const Queries& queries, std::span<const Vec3> samples_L) {
  const Measured exact = measure("our BVH", queries.tree, samples_L, Derivatives::kFirst, 1);
  std::string table = fmt::format(
      "\nAt the samples closest to those points, where the tolerance of the field is {:g} mm:\n\n"
      "| method | P50 / P99 / max difference mm |\n|---|---|\n",
      queries.field_B->frame().tolerance_mm);
  for (const Measured& measured :
       {measure("field, trilinear", queries.trilinear, samples_L, Derivatives::kFirst, 1),
        measure("field, smooth", queries.smooth, samples_L, Derivatives::kFirst, 1)}) {
    const Difference error = difference(measured, exact);
    table += fmt::format("| {} | {:.4f} / {:.4f} / {:.4f} |\n", measured.name, error.p50_mm,
                         error.p99_mm, error.max_mm);
  }
  return table;
}

}  // namespace

Result<std::string> run_detection(const DetectionOptions& options, Progress& progress) {
  LEFORT_TRY(const auto skull_file, prepare_skull(options.ct, options.output, progress));
  LEFORT_TRY(const geometry::TriangleMesh skull_B, io::read_surface(skull_file));
  progress.begin_stage("build the field and the trees");
  LEFORT_TRY(const Queries queries, build_queries(skull_B, options.resolution, progress));

  progress.begin_stage("measure");
  const ThreadLimit limit(options.threads);
  std::vector<Vec3> points_L =
      points_near_surface(skull_B, options.points, options.max_distance_mm, kSeed);
  std::vector<Vec3> samples_L = nearest_samples(queries.field_B->frame(), points_L);
  for (Vec3& p : points_L) p = moved() * p;
  for (Vec3& p : samples_L) p = moved() * p;
  const std::vector<Measured> all = measure_all(queries, skull_B, points_L, options.repeats);
  const std::string table =
      methods_table(all, queries, skull_B, options) + samples_table(queries, samples_L);
  nlohmann::ordered_json methods = nlohmann::ordered_json::object();
  for (const Measured& one : all)
    methods[one.name] = {{"wall_s", one.time.wall_s}, {"processor_s", one.time.processor_s}};
  const nlohmann::ordered_json document{{"points", options.points}, {"methods", methods}};
  LEFORT_TRY_VOID(io::write_text(options.output / "detection.json", document.dump(1) + "\n"));
  LEFORT_TRY_VOID(io::write_text(options.output / "detection.md", table));
  return table;
}

}  // namespace lefort::bench
