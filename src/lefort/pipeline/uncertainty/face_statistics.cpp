#include <lefort/compare/face_regions.h>
#include <lefort/core/parallel.h>
#include <lefort/pipeline/prepare/find_head_landmarks.h>
#include <lefort/pipeline/uncertainty/face_statistics.h>
#include <lefort/uncertainty/latin_hypercube.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

namespace lefort::pipeline {
namespace {

using uncertainty::FieldSurrogate;
using uncertainty::FittedField;

/// Seeds of different purposes differ.
constexpr std::uint64_t kDrawSeed = 0x9e3779b97f4a7c15ULL, kBootstrapSeed = 0xbf58476d1ce4e5b9ULL;

/// 128 MB; each thread has a copy. The set of three terms per sample fits up to 2364 samples.
constexpr std::size_t kMaxBasisValues = std::size_t(1) << 24;

double weighted_mean(std::span<const double> weights, std::span<const double> values) {
  double sum = 0.0, total = 0.0;
  for (std::size_t v = 0; v < values.size(); ++v) {
    sum += weights[v] * values[v];
    total += weights[v];
  }
  return total > 0.0 ? sum / total : 0.0;
}

std::vector<double> widths(const uncertainty::FieldBand& band) {
  std::vector<double> width(band.quantiles.front().size());
  for (std::size_t v = 0; v < width.size(); ++v)
    width[v] = band.quantiles.back()[v] - band.quantiles.front()[v];
  return width;
}

/// Mean band width of a region from a part of its vertices: at most 400, evenly spread over the
/// list.
class BandMeasure {
 public:
  BandMeasure(const std::vector<double>& weights, Eigen::MatrixXd points)
      : points_(std::move(points)) {
    constexpr std::size_t kMost = 400;
    std::vector<Index> inside;
    for (std::size_t v = 0; v < weights.size(); ++v)
      if (weights[v] > 0.0) inside.push_back(Index(v));
    const std::size_t stride = std::max<std::size_t>(1, inside.size() / kMost);
    for (std::size_t k = 0; k < inside.size(); k += stride) {
      rows_.push_back(inside[k]);
      weights_.push_back(weights[std::size_t(inside[k])]);
    }
  }

  [[nodiscard]] double operator()(const FieldSurrogate& surrogate) const {
    FieldSurrogate part{.basis = surrogate.basis,
                        .mean = VectorX(Index(rows_.size())),
                        .modes = Eigen::MatrixXd(Index(rows_.size()), surrogate.modes.cols()),
                        .coefficients = surrogate.coefficients};
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      part.mean[Index(k)] = surrogate.mean[rows_[k]];
      part.modes.row(Index(k)) = surrogate.modes.row(rows_[k]);
    }
    return weighted_mean(weights_,
                         widths(uncertainty::field_band(part, uncertainty::scores_at(part, points_),
                                                        kBandProbabilities)
                                    .value()));  // Nothing stops it.
  }

 private:
  Eigen::MatrixXd points_;
  std::vector<Index> rows_;
  std::vector<double> weights_;
};

std::vector<uncertainty::ChaosInput> chaos_inputs(std::span<const UncertainInput> inputs) {
  std::vector<uncertainty::ChaosInput> chaos;
  for (const UncertainInput& input : inputs)
    chaos.push_back({input.distribution, input.max_degree()});
  return chaos;
}

/// Points of the inputs, drawn from their distributions, not from their levels.
Eigen::MatrixXd draw_points(std::span<const UncertainInput> inputs, Index count,
                            std::uint64_t seed) {
  std::vector<uncertainty::Distribution> distributions;
  for (const UncertainInput& input : inputs) distributions.push_back(input.distribution);
  return uncertainty::points_at(
      distributions, uncertainty::nested_latin_hypercube(Index(distributions.size()), count, seed));
}

/// Candidate sets of at most three terms per sample, whose values at the samples fit into
/// kMaxBasisValues.
uncertainty::FieldFitOptions fit_options(std::size_t samples) {
  return {.variance_fraction = 0.999,
          .basis = {.max_terms = Index(std::min(3 * samples, kMaxBasisValues / samples))}};
}

double cross_validated_q2(const FittedField& fitted, const Eigen::MatrixXd& gram) {
  double errors = 0.0, squares = 0.0;
  for (Index i = 0; i < fitted.cv_errors.rows(); ++i) {
    const VectorX error = fitted.cv_errors.row(i), value = fitted.modes.scores.row(i);
    errors += error.dot(gram * error);
    squares += value.dot(gram * value);
  }
  return squares > 0.0 ? 1.0 - errors / squares : 1.0;
}

/// Inputs by group, in the order of first appearance.
std::vector<std::vector<Index>> find_groups(std::span<const UncertainInput> inputs,
                                            std::vector<std::string>& names) {
  std::vector<std::vector<Index>> groups;
  for (std::size_t n = 0; n < inputs.size(); ++n) {
    const std::string name = inputs[n].parameter->group;
    const auto at = std::find(names.begin(), names.end(), name) - names.begin();
    if (std::size_t(at) == names.size()) {
      names.push_back(name);
      groups.emplace_back();
    }
    groups[std::size_t(at)].push_back(Index(n));
  }
  return groups;
}

std::vector<std::vector<Index>> each_alone(std::size_t count) {
  std::vector<std::vector<Index>> alone;
  for (std::size_t n = 0; n < count; ++n) alone.push_back({Index(n)});
  return alone;
}

CorrectionStatistics describe_correction(const FaceStatistics& all, const BandMeasure& measure,
                                         const std::vector<std::vector<float>>& differences,
                                         const std::vector<std::vector<float>>& coarse) {
  const std::vector<double>& weights = all.regions.front().weights;
  CorrectionStatistics found{.samples = Index(differences.size())};
  const auto of = [&](auto value) {
    std::vector<double> values(weights.size());
    for (std::size_t v = 0; v < values.size(); ++v) values[v] = value(v);
    return weighted_mean(weights, values);
  };
  const uncertainty::FittedField& fit = *all.correction;
  found.mean_mm = of([&](std::size_t v) { return std::abs(fit.modes.mean[Index(v)]); });
  double fine_square = 0.0, coarse_square = 0.0, product = 0.0;
  const double count = double(differences.size());
  for (std::size_t v = 0; v < weights.size(); ++v) {
    double coarse_mean = 0.0;
    for (const std::vector<float>& one : coarse) coarse_mean += double(one[v]) / count;
    for (std::size_t i = 0; i < coarse.size(); ++i) {
      const double c = double(coarse[i][v]) - coarse_mean;
      const double d = double(differences[i][v]) - fit.modes.mean[Index(v)];
      fine_square += weights[v] * (c + d) * (c + d);
      coarse_square += weights[v] * c * c;
      product += weights[v] * c * (c + d);
    }
  }
  if (fine_square > 0.0 && coarse_square > 0.0)
    found.correlation = product / std::sqrt(fine_square * coarse_square);
  const Eigen::MatrixXd gram = uncertainty::gram_of(fit.surrogate.modes, weights);
  const auto mean_square = [&](const Eigen::MatrixXd& rows) {
    double sum = 0.0;
    for (Index i = 0; i < rows.rows(); ++i) {
      const VectorX row = rows.row(i);
      sum += row.dot(gram * row);
    }
    return std::sqrt(sum / double(rows.rows()));
  };
  found.deviation_mm = mean_square(fit.modes.scores);
  found.cv_error_mm = mean_square(fit.cv_errors);
  found.band_change_mm = measure(all.total) - measure(all.coarse.surrogate);
  return found;
}

/// Removes the dependence of a mode on the inputs if the mean of the samples predicts a sample that
/// was left out as well: few samples then show no dependence. Three never do: two of them determine
/// no slope with an error, so that both predictions are the mean, up to round-off.
void keep_what_predicts(FittedField& correction) {
  constexpr double kSame = 1e-9;
  const Index count = correction.cv_errors.rows();
  for (Index k = 0; k < correction.cv_errors.cols(); ++k) {
    // Scores have the mean 0; that of the others is -score / (count - 1).
    const VectorX of_mean =
        -correction.modes.scores.col(k) * double(count) / double(std::max<Index>(1, count - 1));
    if (correction.cv_errors.col(k).squaredNorm() < (1.0 - kSame) * of_mean.squaredNorm()) continue;
    correction.cv_errors.col(k) = of_mean;
    correction.surrogate.coefficients.col(k).setZero();
  }
}

/// Fits the correction to the differences of fine and coarse samples with the same numbers.
Result<void> fit_correction(const UncertainCase& face, const SolvedSamples& coarse,
                            const SolvedSamples& fine, const BandMeasure& measure,
                            FaceStatistics& all, Progress& progress) {
  std::vector<std::vector<float>> differences, rough;
  std::vector<Index> rows;
  for (std::size_t k = 0; k < fine.numbers.size(); ++k) {
    const auto at = std::lower_bound(coarse.numbers.begin(), coarse.numbers.end(), fine.numbers[k]);
    const SampleResult& of_coarse = coarse.results[std::size_t(at - coarse.numbers.begin())];
    if (!fine.results[k].is_solved() || !of_coarse.is_solved()) continue;
    rough.push_back(of_coarse.normal_mm);
    differences.push_back(fine.results[k].normal_mm);
    for (std::size_t v = 0; v < rough.back().size(); ++v) differences.back()[v] -= rough.back()[v];
    rows.push_back(fine.numbers[k]);
  }
  constexpr std::size_t kFewest = 3;
  if (differences.size() < kFewest) return {};
  Eigen::MatrixXd points(Index(rows.size()), face.points().cols());
  for (std::size_t k = 0; k < rows.size(); ++k) points.row(Index(k)) = face.points().row(rows[k]);
  // Few samples: linear, and only what they show. Inputs in levels are at their middle in all.
  LEFORT_TRY(
      all.correction,
      uncertainty::fit_field(
          chaos_inputs(face.inputs().inputs), points, differences, face.skin().area_mm2,
          {.variance_fraction = 0.99, .basis = {.max_degree = 1}, .folds = Index(rows.size())},
          progress));
  keep_what_predicts(*all.correction);
  all.total = uncertainty::add(all.coarse.surrogate, all.correction->surrogate);
  all.correction_results = describe_correction(all, measure, differences, rough);
  return {};
}

Result<std::vector<ConvergenceRow>> find_convergence(const UncertainCase& face,
                                                     const std::vector<Index>& rows,
                                                     const std::vector<std::vector<float>>& samples,
                                                     const FaceStatistics& all,
                                                     const BandMeasure& measure, std::uint64_t seed,
                                                     Progress& progress) {
  std::vector<ConvergenceRow> found;
  std::vector<Index> counts;
  for (Index n = uncertainty::kFirstDesign; n < Index(rows.size()); n *= 2) counts.push_back(n);
  counts.push_back(Index(rows.size()));
  for (const Index n : counts) {
    progress.begin_stage(fmt::format("convergence, {} samples", n));
    if (progress.stop_requested()) return fail(ErrorCode::kCancelled, "stopped");
    Eigen::MatrixXd points(n, face.points().cols());
    for (Index i = 0; i < n; ++i) points.row(i) = face.points().row(rows[std::size_t(i)]);
    FittedField fit = all.coarse;
    if (n < Index(rows.size())) {
      LEFORT_TRY(
          fit, uncertainty::fit_field(chaos_inputs(face.inputs().inputs), points,
                                      std::span(samples).first(std::size_t(n)),
                                      face.skin().area_mm2, fit_options(std::size_t(n)), progress));
    }
    FieldSurrogate total =
        all.correction ? uncertainty::add(fit.surrogate, all.correction->surrogate) : fit.surrogate;
    ConvergenceRow row{.samples = n, .band_mm = measure(total)};
    LEFORT_TRY(const uncertainty::SurrogateReplicates replicates,
               uncertainty::draw_surrogates(fit, all.correction ? &*all.correction : nullptr,
                                            kBandReplicates, seed ^ kBootstrapSeed, progress));
    std::vector<double> draws;
    for (const Eigen::MatrixXd& coefficients : replicates.coefficients) {
      if (progress.stop_requested()) return fail(ErrorCode::kCancelled, "stopped");
      total.coefficients = coefficients;
      draws.push_back(measure(total));
      progress.report(double(draws.size()) / kBandReplicates);
    }
    row.low_mm = uncertainty::sample_quantile(draws, 0.5 * (1.0 - kIntervalLevel));
    row.high_mm = uncertainty::sample_quantile(draws, 0.5 * (1.0 + kIntervalLevel));
    row.q2 = cross_validated_q2(
        fit, uncertainty::gram_of(fit.surrogate.modes, all.regions.front().weights));
    found.push_back(row);
  }
  return found;
}

RegionStatistics statistics_of_region(const FaceStatistics& all, const SkinRegion& region,
                                      std::span<const std::vector<Index>> alone,
                                      std::span<const std::vector<Index>> groups,
                                      const uncertainty::SurrogateReplicates& replicates) {
  RegionStatistics found{.name = region.name};
  const std::vector<double> width = widths(all.band);
  found.band_mm = weighted_mean(region.weights, width);
  found.deviation_mm = weighted_mean(region.weights, all.band.standard_deviation);
  for (std::size_t v = 0; v < width.size(); ++v) {
    found.area_mm2 += region.weights[v];
    if (region.weights[v] > 0.0) found.max_band_mm = std::max(found.max_band_mm, width[v]);
  }
  const Eigen::MatrixXd total = uncertainty::gram_of(all.total.modes, region.weights);
  const Eigen::MatrixXd rough = uncertainty::gram_of(all.coarse.surrogate.modes, region.weights);
  found.inputs = uncertainty::sobol_indices(all.total.basis, all.total.coefficients, total, alone);
  found.groups = uncertainty::sobol_indices(all.total.basis, all.total.coefficients, total, groups);
  found.interval = uncertainty::sobol_interval(replicates, total, alone, kIntervalLevel);
  found.q2 = cross_validated_q2(all.coarse, rough);
  return found;
}

}  // namespace

Result<FaceStatistics> face_statistics(const UncertainCase& face, std::vector<SkinRegion> regions,
                                       const SolvedSamples& coarse, const SolvedSamples& fine,
                                       std::uint64_t seed, Progress& progress) {
  constexpr std::size_t kFewest = 20;
  progress.begin_stage("fit the surrogate");
  std::vector<Index> rows;
  std::vector<std::vector<float>> samples;
  for (std::size_t k = 0; k < coarse.numbers.size(); ++k)
    if (coarse.results[k].is_solved()) {
      rows.push_back(coarse.numbers[k]);
      samples.push_back(coarse.results[k].normal_mm);
    }
  if (samples.size() < kFewest)
    return fail(ErrorCode::kNotConverged,
                fmt::format("{} of {} samples have an equilibrium, at least {} are needed",
                            samples.size(), coarse.numbers.size(), kFewest));
  FaceStatistics all;
  all.solved = Index(samples.size());
  all.regions = std::move(regions);
  Eigen::MatrixXd points(Index(rows.size()), face.points().cols());
  for (std::size_t k = 0; k < rows.size(); ++k) points.row(Index(k)) = face.points().row(rows[k]);
  const std::vector<UncertainInput>& inputs = face.inputs().inputs;
  LEFORT_TRY(all.coarse,
             uncertainty::fit_field(chaos_inputs(inputs), points, samples, face.skin().area_mm2,
                                    fit_options(samples.size()), progress));
  all.total = all.coarse.surrogate;
  const BandMeasure measure(all.regions.front().weights,
                            draw_points(inputs, 1000, seed ^ kDrawSeed));
  LEFORT_TRY_VOID(fit_correction(face, coarse, fine, measure, all, progress));
  progress.begin_stage("quantiles of the surrogate");
  LEFORT_TRY(all.band, uncertainty::field_band(
                           all.total,
                           uncertainty::scores_at(
                               all.total, draw_points(inputs, kSurrogateDraws, seed ^ kDrawSeed)),
                           kBandProbabilities, progress));
  all.band_mm = weighted_mean(all.regions.front().weights, widths(all.band));
  progress.begin_stage("bootstrap of the surrogate");
  LEFORT_TRY(const uncertainty::SurrogateReplicates replicates,
             uncertainty::draw_surrogates(all.coarse, all.correction ? &*all.correction : nullptr,
                                          kReplicates, seed ^ kBootstrapSeed, progress));
  progress.begin_stage("Sobol indices");
  const std::vector<std::vector<Index>> groups = find_groups(inputs, all.groups);
  for (const SkinRegion& region : all.regions) {
    if (progress.stop_requested()) return fail(ErrorCode::kCancelled, "stopped");
    all.region_results.push_back(
        statistics_of_region(all, region, each_alone(inputs.size()), groups, replicates));
    progress.report(double(all.region_results.size()) / double(all.regions.size()));
  }
  LEFORT_TRY(all.convergence, find_convergence(face, rows, samples, all, measure, seed, progress));
  return all;
}

double statistics_memory_gb(std::size_t samples, std::size_t vertices) {
  constexpr double kCopies = 2.0, kPairs = 3.0, kGigabyte = 1e9;
  const double n = double(samples);
  return (kCopies * n * double(vertices) * sizeof(float) + kPairs * n * n * sizeof(double) +
          double(std::min(samples * 3 * samples, kMaxBasisValues)) * sizeof(double) *
              double(ThreadLimit::current())) /
         kGigabyte;
}

Result<void> check_statistics_memory(std::size_t samples, std::size_t vertices, double machine_gb) {
  const double needed_gb = statistics_memory_gb(samples, vertices);
  if (needed_gb <= machine_gb) return {};
  return fail(ErrorCode::kOutOfMemory,
              fmt::format("statistics of {} samples at {} vertices need about {:.1f} GB, this "
                          "machine has {:.1f} GB: give fewer --samples",
                          samples, vertices, needed_gb, machine_gb));
}

std::vector<SkinRegion> skin_regions(const UncertainCase& face, Progress& progress) {
  const SampledSkin& skin = face.skin();
  std::vector<SkinRegion> regions{{"moved skin", std::vector<double>(skin.vertices.size(), 0.0)}};
  for (std::size_t v = 0; v < skin.vertices.size(); ++v)
    if (skin.is_moved[v] != 0) regions.front().weights[v] = skin.area_mm2[v];
  plan::Landmarks landmarks_L = face.prepared().plan.landmarks;
  Result<compare::FaceRegions> found = compare::FaceRegions::from(landmarks_L);
  if (!found || found->missing().size() >= compare::kFaceRegions.size() || landmarks_L.empty()) {
    const ScannedHead& head = face.prepared().head;
    const Result<plan::LandmarkSearch> search =
        find_head_landmarks(head.scan.ct, head.labels, head.levels, progress);
    if (search) found = compare::FaceRegions::from(search->landmarks());
  }
  if (!found) {
    progress.note("no regions of the face: " + found.error().message);
    return regions;
  }
  for (const compare::FaceRegion region : compare::kFaceRegions) {
    SkinRegion one{compare::name_of(region), std::vector<double>(skin.vertices.size(), 0.0)};
    double area_mm2 = 0.0;
    for (std::size_t v = 0; v < skin.vertices.size(); ++v)
      if (found->at(skin.skin_L.vertices[std::size_t(skin.vertices[v])]) == region)
        area_mm2 += one.weights[v] = skin.area_mm2[v];
    if (area_mm2 > 0.0) regions.push_back(std::move(one));
  }
  return regions;
}

}  // namespace lefort::pipeline
