#include <lefort/bench/competitors.h>
#include <lefort/bench/measure_field.h>
#include <lefort/bench/stopwatch.h>
#include <lefort/bench/surface_points.h>
#include <lefort/core/parallel.h>
#include <lefort/field/build/build_distance_field.h>
#include <lefort/geometry/bvh.h>
#include <lefort/geometry/mesh_properties.h>
#include <lefort/geometry/winding_number.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <vector>

namespace lefort::bench {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint32_t kQuerySeed = 1, kErrorSeed = 2;
/// Rates are the best of these runs: disturbances only slow a run.
constexpr int kQueryRuns = 5;

field::DistanceFieldOptions field_options(const FieldTask& task, field::FieldMethod method) {
  field::DistanceFieldOptions options;
  options.method = method;
  options.resolution = task.resolution;
  options.side_mm = task.side_mm;
  options.band_mm = task.half_band_cells * task.side_mm / task.resolution;
  options.relative_tolerance = task.relative_tolerance;
  return options;
}

/// Lowest corner of the cube of build_distance_field().
Vec3 cube_origin(const geometry::TriangleMesh& mesh, double side_mm) {
  return geometry::bounding_box(mesh).center() - Vec3::Constant(0.5 * side_mm);
}

/// Lattice points within the band, at which the other libraries are queried.
std::vector<Vec3> band_points(const geometry::TriangleMesh& mesh, const FieldTask& task) {
  const auto field =
      field::build_distance_field(mesh, field_options(task, field::FieldMethod::kBricks)).value();
  const auto& bricks = std::get<field::BrickSamples>(field.samples());
  const field::FieldFrame& frame = field.frame();
  std::vector<Vec3> points;
  for (int z = 0; z <= task.resolution; ++z)
    for (int y = 0; y <= task.resolution; ++y)
      for (int x = 0; x <= task.resolution; ++x)
        if (field::BrickSamples::is_distance(
                field::BrickSamples::read_code(bricks.code_address({x, y, z}))))
          points.push_back(frame.origin_B + frame.cell_mm * Vec3(x, y, z));
  return points;
}

double rate(Index count, const std::function<void()>& run) {
  double best = std::numeric_limits<double>::infinity();
  for (int n = 0; n < kQueryRuns; ++n) {
    const double start = now_seconds();
    run();
    best = std::min(best, now_seconds() - start);
  }
  return double(count) / best;
}

/// Builds `repeats` times and keeps the last.
template <class Build>
auto timed(const FieldTask& task, const Build& build, Json& result) {
  std::vector<double> seconds, user;
  decltype(build()) built;
  for (int n = 0; n < task.repeats; ++n) {
    built = {};
    const std::size_t before = resident_bytes();
    reset_peak_memory();
    const double start = now_seconds(), user_start = processor_seconds();
    built = build();
    seconds.push_back(now_seconds() - start);
    user.push_back(processor_seconds() - user_start);
    if (n == 0) result["peak_bytes"] = peak_resident_bytes() - before;
  }
  result["seconds"] = median(seconds);
  result["processor_seconds"] = median(user);
  return built;
}

/// Distances at points by a method; not finite without a result.
using Distances = std::function<void(std::span<const Vec3>, std::span<double>)>;

void measure_errors(const geometry::TriangleMesh& mesh, const geometry::Bvh& exact,
                    const FieldTask& task, const Distances& distances, Json& result) {
  const std::vector<Vec3> points =
      points_near_surface(mesh, task.error_points, kQueryReach_mm, kErrorSeed);
  std::vector<double> found(points.size()), truth(points.size());
  distances(points, found);
  parallel_for(Index(points.size()), [&](Index i) {
    truth[std::size_t(i)] = exact.signed_distance(points[std::size_t(i)]).distance_mm;
  });
  std::vector<double> errors;
  Index unknown = 0, wrong_signs = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!std::isfinite(found[i])) {
      ++unknown;
      continue;
    }
    errors.push_back(std::abs(found[i] - truth[i]));
    if ((found[i] < 0.0) != (truth[i] < 0.0)) ++wrong_signs;
  }
  result["unknown"] = unknown;
  result["wrong_signs"] = wrong_signs;
  if (errors.empty()) return;
  std::sort(errors.begin(), errors.end());
  double sum = 0.0;
  for (const double e : errors) sum += e;
  result["error_mm"] = {{"mean", sum / double(errors.size())},
                        {"p99", errors[errors.size() * 99 / 100]},
                        {"max", errors.back()}};
}

/// Compares `task.error_points` samples with exact distances.
void measure_lattice(const field::DistanceField& field, const geometry::Bvh& exact,
                     const FieldTask& task, const std::vector<Vec3>& band, Json& result) {
  const field::FieldFrame& frame = field.frame();
  const std::size_t stride = std::max<std::size_t>(1, band.size() / std::size_t(task.error_points));
  const Index count = Index((band.size() + stride - 1) / stride);
  std::vector<double> error(std::size_t(count), 0.0);
  std::vector<std::uint8_t> wrong(std::size_t(count), 0);
  parallel_for(count, [&](Index n) {
    const Vec3& p = band[std::size_t(n) * stride];
    field::LatticePoint at{};
    for (int k = 0; k < 3; ++k)
      at[std::size_t(k)] = std::min(int(std::lround((p[k] - frame.origin_B[k]) / frame.cell_mm)),
                                    frame.resolution - 1);
    const field::FieldSample found = field.sample(p);
    if (found.zone != field::Zone::kBand) return;  // A neighbor of the sample is not known.
    const double truth = exact.signed_distance(p).distance_mm;
    error[std::size_t(n)] = std::abs(std::abs(found.distance_mm) - std::abs(truth));
    const bool inside = found.distance_mm < 0.0;
    if (inside == (truth < 0.0) || std::abs(truth) <= 1e-6) return;
    wrong[std::size_t(n)] = inside == (geometry::winding_number(exact.mesh(), p) > 0.5) ? 0 : 1;
  });
  result["lattice_error_mm"] = *std::max_element(error.begin(), error.end());
  result["lattice_wrong_signs"] = std::count(wrong.begin(), wrong.end(), 1);
}

Result<Json> measure_ours(const geometry::TriangleMesh& mesh, const FieldTask& task,
                          field::FieldMethod method) {
  Json result;
  std::optional<Result<field::DistanceField>> built = timed(
      task,
      [&] { return std::optional(field::build_distance_field(mesh, field_options(task, method))); },
      result);
  LEFORT_TRY(const field::DistanceField field, *std::move(built));
  result["retained_bytes"] = field.sample_bytes();
  result["tolerance_mm"] = field.frame().tolerance_mm;
  result["triangles"] = mesh.triangle_count();
  if (task.only_build) return result;

  const std::vector<Vec3> points =
      points_near_surface(mesh, task.query_points, kQueryReach_mm, kQuerySeed);
  std::vector<float> values(points.size());
  std::vector<field::FieldSample> samples(points.size());
  const auto count = Index(points.size());
  result["rates"] = {{"value", rate(count, [&] { field.distances(points, values); })},
                     {"value_and_gradient", rate(count, [&] { field.sample(points, samples); })},
                     {"single", rate(count, [&] {
                        for (std::size_t i = 0; i < points.size(); ++i)
                          samples[i] = field.sample(points[i]);
                      })}};

  const geometry::Bvh exact(mesh);
  measure_errors(
      mesh, exact, task,
      [&](std::span<const Vec3> at, std::span<double> found) {
        std::vector<float> reported(at.size());
        field.distances(at, reported);
        std::copy(reported.begin(), reported.end(), found.begin());
      },
      result);
  const std::vector<Vec3> band = band_points(mesh, task);
  result["samples"] = band.size();
  measure_lattice(field, exact, task, band, result);
  return result;
}

Json measure_openvdb(const geometry::TriangleMesh& mesh, const FieldTask& task) {
  Json result;
  const double cell_mm = task.side_mm / task.resolution;
  const auto field = timed(
      task,
      [&] {
        return std::make_unique<OpenVdbField>(mesh, cube_origin(mesh, task.side_mm), cell_mm,
                                              task.half_band_cells);
      },
      result);
  result["retained_bytes"] = field->bytes();
  result["triangles"] = mesh.triangle_count();
  if (task.only_build) return result;
  const std::vector<Vec3> points =
      points_near_surface(mesh, task.query_points, kQueryReach_mm, kQuerySeed);
  std::vector<double> values(points.size());
  std::vector<Vec3> gradients(points.size());
  result["rates"] = {
      {"value", rate(Index(points.size()), [&] { field->distances(points, values); })},
      {"value_and_gradient",
       rate(Index(points.size()), [&] { field->gradients(points, values, gradients); })}};
  const geometry::Bvh exact(mesh);
  measure_errors(
      mesh, exact, task,
      [&](std::span<const Vec3> at, std::span<double> found) { field->distances(at, found); },
      result);
  return result;
}

/// An exact tree: time to query all samples of the band, and its rate near the surface.
template <class Tree>
Json measure_tree(
    const geometry::TriangleMesh& mesh, const FieldTask& task, Index at_most,
    const std::function<void(const Tree&, std::span<const Vec3>, double, std::span<double>)>& ask) {
  Json result;
  const std::vector<Vec3> band = band_points(mesh, task);
  const double max_distance_mm = task.half_band_cells * task.side_mm / task.resolution * 1.001;
  std::vector<Vec3> requested = band;
  if (at_most > 0 && Index(band.size()) > at_most) {
    requested.clear();
    for (Index i = 0; i < at_most; ++i)
      requested.push_back(band[std::size_t(double(i) * double(band.size()) / double(at_most))]);
  }
  std::vector<double> found(requested.size());
  std::vector<double> build, query;
  std::unique_ptr<Tree> tree;
  for (int n = 0; n < task.repeats; ++n) {
    double start = now_seconds();
    tree = std::make_unique<Tree>(mesh);
    build.push_back(now_seconds() - start);
    start = now_seconds();
    ask(*tree, requested, max_distance_mm, found);
    query.push_back(now_seconds() - start);
  }
  const double fraction = double(band.size()) / double(requested.size());
  result["seconds"] = median(build) + fraction * median(query);
  result["samples"] = band.size();
  result["samples_asked"] = requested.size();
  const std::vector<Vec3> points =
      points_near_surface(mesh, task.query_points, kQueryReach_mm, kQuerySeed);
  std::vector<double> values(points.size());
  result["rates"] = {{"value", rate(Index(points.size()), [&] {
                        ask(*tree, points, std::numeric_limits<double>::infinity(), values);
                      })}};
  return result;
}

}  // namespace

Result<Json> measure_field(const geometry::TriangleMesh& skull, const FieldTask& task) {
  const ThreadLimit limit(task.threads);
  static const std::map<std::string, field::FieldMethod> kOurs = {
      {"bricks", field::FieldMethod::kBricks},
      {"hybrid", field::FieldMethod::kHybrid},
      {"adaptive", field::FieldMethod::kAdaptive},
      {"uniform", field::FieldMethod::kUniform}};
  if (const auto ours = kOurs.find(task.method); ours != kOurs.end())
    return measure_ours(skull, task, ours->second);
  if (task.method == "openvdb") return measure_openvdb(skull, task);
  if (task.method == "embree")
    return measure_tree<EmbreePoints>(
        skull, task, 0,
        [](const EmbreePoints& tree, std::span<const Vec3> points, double max_distance_mm,
           std::span<double> found) { tree.distances(points, max_distance_mm, found); });
  if (task.method == "cgal")
    return measure_tree<CgalTree>(skull, task, task.exact_points,
                                  [](const CgalTree& tree, std::span<const Vec3> points, double,
                                     std::span<double> found) { tree.distances(points, found); });
  return fail(ErrorCode::kInvalidArgument,
              fmt::format("method {} is not one of bricks, hybrid, adaptive, uniform, openvdb, "
                          "embree, cgal",
                          task.method));
}

}  // namespace lefort::bench
