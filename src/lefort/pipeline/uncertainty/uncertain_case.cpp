#include <lefort/compare/surface_difference.h>
#include <lefort/core/isolate.h>
#include <lefort/core/parallel.h>
#include <lefort/core/random_draws.h>
#include <lefort/core/version.h>
#include <lefort/io/deprecated_keys.h>
#include <lefort/io/plan_inputs.h>
#include <lefort/io/sha256.h>
#include <lefort/pipeline/prepare/coarse_face.h>
#include <lefort/pipeline/prepare/find_head_landmarks.h>
#include <lefort/pipeline/uncertainty/inputs_json.h>
#include <lefort/pipeline/uncertainty/uncertain_case.h>
#include <lefort/predict/embed_skin.h>
#include <lefort/uncertainty/latin_hypercube.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <set>
#include <system_error>
#include <utility>

namespace lefort::pipeline {
namespace {

// Increase when samples of the same inputs change.
constexpr const char* kSampleRevision = "uncertainty-2";
constexpr double kMovedSkin_mm = 0.5;  ///< As in the summary of a prediction.

/// Only requests to stop pass; it may be used by several threads.
class QuietProgress : public Progress {
 public:
  explicit QuietProgress(const Progress& outer) : outer_(outer) {}
  [[nodiscard]] bool stop_requested() const override { return outer_.stop_requested(); }

 private:
  const Progress& outer_;
};

/// Errors of one standard deviation of all landmarks: normal numbers of Box and Muller.
plan::Landmarks displaced_landmarks(plan::Landmarks landmarks, double factor_mm,
                                    std::uint64_t seed) {
  std::mt19937_64 bits(seed ^ 0x6c616e646d61726bULL);  // "landmark"
  for (plan::Landmark& landmark : landmarks)
    for (int axis = 0; axis < 3; ++axis) {
      const double radius = std::sqrt(-2.0 * std::log(draw_unit(bits)));
      landmark.point_L[axis] +=
          factor_mm * radius * std::cos(2.0 * std::numbers::pi * draw_unit(bits));
    }
  return landmarks;
}

std::vector<Vec3> unit_normals(const geometry::TriangleMesh& mesh_L) {
  std::vector<Vec3> normals(mesh_L.vertices.size(), Vec3::Zero());
  for (const auto& triangle : mesh_L.triangles) {
    const Vec3& a = mesh_L.vertices[std::size_t(triangle[0])];
    const Vec3 area = (mesh_L.vertices[std::size_t(triangle[1])] - a)
                          .cross(mesh_L.vertices[std::size_t(triangle[2])] - a);
    for (int corner = 0; corner < 3; ++corner)
      normals[std::size_t(triangle[std::size_t(corner)])] += area;
  }
  for (Vec3& normal : normals)
    if (normal.norm() > 0.0) normal.normalize();
  return normals;
}

/// The coarse mesh, with the skin of the plan: its stiffness may be an input.
predict::TissueOptions coarse_with_skin(const predict::TissueOptions& fine) {
  predict::TissueOptions options = coarse_tissue(fine);
  options.skin = fine.skin;
  return options;
}

/// SHA-256 of a scan that is one file; nothing for a folder.
Result<std::optional<std::string>> sha256_of_scan(const std::filesystem::path& ct) {
  std::error_code error;
  if (std::filesystem::is_directory(ct, error)) return std::nullopt;
  LEFORT_TRY(std::string sha256, io::sha256_of_file(ct));
  return sha256;
}

std::vector<Index> range(Index begin, Index end) {
  std::vector<Index> numbers;
  for (Index i = begin; i < end; ++i) numbers.push_back(i);
  return numbers;
}

}  // namespace

Result<std::unique_ptr<UncertainCase>> UncertainCase::open(const UncertaintyJob& job,
                                                           Progress& progress) {
  std::unique_ptr<UncertainCase> opened(new UncertainCase(job));
  LEFORT_TRY(io::PlanText text, read_plan_of_scan(job.plan, job.ct, opened->cache_, progress));
  io::note_warnings(text.plan.warnings, progress);
  LEFORT_TRY(opened->ct_, io::scan_of(job.plan, text.plan, job.ct));
  opened->plan_ = std::move(text.plan);
  opened->plan_text_ = std::move(text.json);
  LEFORT_TRY(opened->ct_file_sha256_, sha256_of_scan(opened->ct_));
  LEFORT_TRY(opened->plan_files_, io::fingerprints(opened->plan_text_, job.plan));
  if (job.inputs) {
    LEFORT_TRY(opened->entries_, read_inputs(*job.inputs));
  } else {
    opened->entries_ = default_inputs(opened->plan_);
  }
  LEFORT_TRY(opened->inputs_, inputs_of_plan(opened->entries_, opened->plan_));
  for (const std::string& why : opened->inputs_.without_effect)
    progress.note("input without effect: " + why);
  std::vector<uncertainty::Distribution> sampled;
  std::vector<double> center;
  for (const UncertainInput& input : opened->inputs_.inputs) {
    sampled.push_back(input.sampled);
    center.push_back(input.center());
  }
  opened->points_ = uncertainty::points_at(
      sampled, uncertainty::nested_latin_hypercube(Index(sampled.size()), job.samples, job.seed));
  LEFORT_TRY_VOID(check_design(opened->inputs_.inputs, opened->points_));
  opened->middle_key_ = variant_of(opened->inputs_.inputs, center);
  LEFORT_TRY_VOID(opened->prepare(progress));
  return opened;
}

Result<PreparedCase> UncertainCase::prepare_anatomy(const VariantKey& key, Progress& progress) {
  io::PlanFile plan = plan_;
  std::string text = plan_text_;
  if (key.landmark_mm != 0.0) {
    text =
        io::with_landmarks(text, displaced_landmarks(plan_.landmarks, key.landmark_mm, job_.seed));
    LEFORT_TRY(io::PlanText changed, io::parse_completed_plan(job_.plan, text));
    plan = std::move(changed.plan);
  }
  plan.segmentation.bone_hu += key.threshold_hu;
  if (key != middle_key_ || job_.fine_samples == 0) plan.tissue = coarse_with_skin(plan.tissue);
  return prepare_case(std::move(plan), io::Sha256().add(text).hex(), ct_, cache_, progress);
}

Result<void> UncertainCase::prepare(Progress& progress) {
  LEFORT_TRY(prepared_, prepare_anatomy(middle_key_, progress));
  prepared_->provenance.plan_files = plan_files_;
  LEFORT_TRY(FaceVariant middle,
             make_variant(*prepared_, coarse_with_skin(plan_.tissue), middle_key_.margin_mm,
                          prepared_->skin_L, cache_, progress));
  variants_[middle_key_] = std::make_unique<FaceVariant>(std::move(middle));
  find_skin();
  io::Sha256 key;
  key.add(kSampleRevision).add(kVersion).add(plan_text_).add(prepared_->provenance.ct_sha256);
  for (const io::InputFile& file : plan_files_) key.add(file.name).add(file.sha256);
  key.add(pipeline::as_json(entries_).dump()).add(std::to_string(job_.seed));
  store_ = SampleStore(job_.output / "samples", key.hex());
  return {};
}

Result<void> UncertainCase::check_unchanged() const {
  LEFORT_TRY(const std::vector<io::InputFile> files, io::fingerprints(plan_text_, job_.plan));
  LEFORT_TRY(const std::optional<std::string> ct_sha256, sha256_of_scan(ct_));
  if (files == plan_files_ && ct_sha256 == ct_file_sha256_) return {};
  return fail(ErrorCode::kPlanInvalid,
              "the scan or a file that the plan names was changed while samples were solved: run "
              "again");
}

void UncertainCase::find_skin() {
  skin_.skin_L = prepared_->skin_L;
  skin_.nominal_mm = nominal_skin_mm(*variants_.at(middle_key_));
  const geometry::TriangleMesh moved_L = predict::displaced(skin_.skin_L, skin_.nominal_mm);
  skin_.normals_L = unit_normals(moved_L);
  const std::vector<double> areas_mm2 = compare::vertex_areas(skin_.skin_L);
  const auto& embedded = variants_.at(middle_key_)->embedding.embedded_vertices;
  for (std::size_t v = 0; v < embedded.size(); ++v) {
    if (!(embedded[v].weights.sum() + embedded[v].middle_weights.sum() > 0.0)) continue;
    if (!(areas_mm2[v] > 0.0)) continue;
    skin_.vertices.push_back(std::int32_t(v));
    skin_.area_mm2.push_back(areas_mm2[v]);
    skin_.is_moved.push_back(skin_.nominal_mm[v].norm() > kMovedSkin_mm ? 1 : 0);
  }
}

VariantKey UncertainCase::key_of(Index sample) const {
  return variant_of(inputs_.inputs, values_of(sample));
}

std::size_t UncertainCase::model_count() const {
  std::set<VariantKey> keys;
  for (Index i = 0; i < points_.rows(); ++i) keys.insert(key_of(i));
  return keys.size();
}

std::vector<double> UncertainCase::values_of(Index sample) const {
  const VectorX row = points_.row(sample);
  return {row.data(), row.data() + row.size()};
}

Result<void> UncertainCase::prepare_variants(std::span<const Index> samples, Progress& progress) {
  std::set<VariantKey> wanted;
  for (const Index sample : samples) wanted.insert(key_of(sample));
  // Those of the same anatomy follow each other: it is prepared once.
  std::vector<VariantKey> ordered(wanted.begin(), wanted.end());
  const auto anatomy = [](const VariantKey& key) {
    return std::pair(key.threshold_hu, key.landmark_mm);
  };
  std::stable_sort(ordered.begin(), ordered.end(), [&](const VariantKey& a, const VariantKey& b) {
    return anatomy(a) < anatomy(b);
  });
  std::optional<std::pair<double, double>> current;
  Result<PreparedCase> other = fail(ErrorCode::kInvalidArgument, "");
  for (const VariantKey& key : ordered) {
    if (variants_.contains(key) || failed_variants_.contains(key)) continue;
    const bool is_middle = anatomy(key) == anatomy(middle_key_);
    if (!is_middle && current != anatomy(key)) {
      current = anatomy(key);
      QuietProgress quiet(progress);
      progress.begin_stage(
          fmt::format("prepare the case with bone from {:+.0f} HU, landmarks "
                      "{:+.1f} mm",
                      key.threshold_hu, key.landmark_mm));
      other = prepare_anatomy(key, quiet);
    }
    const auto make = [&]() -> Result<FaceVariant> {
      if (!is_middle && !other) return tl::unexpected(other.error());
      QuietProgress quiet(progress);
      progress.begin_stage("model of another level");
      return make_variant(is_middle ? *prepared_ : *other, coarse_with_skin(plan_.tissue),
                          key.margin_mm, skin_.skin_L, cache_, quiet);
    };
    Result<FaceVariant> made = make();
    if (made)
      variants_[key] = std::make_unique<FaceVariant>(*std::move(made));
    else if (made.error().code == ErrorCode::kCancelled ||
             made.error().code == ErrorCode::kOutOfMemory ||
             made.error().code == ErrorCode::kFileUnwritable)
      return tl::unexpected(made.error());
    else
      failed_variants_[key] = made.error().message;
  }
  return {};
}

Result<SampleResult> UncertainCase::solve_one(const FaceVariant& variant, Index sample,
                                              StartState start, Progress& progress) const {
  const std::vector<double> values = values_of(sample);
  SampleResult result;
  Result<SampleSolution> solved = solve_sample(variant, inputs_.inputs, values, start, progress);
  const auto is_transient = [&] {
    return progress.stop_requested() || solved.error().code == ErrorCode::kOutOfMemory;
  };
  if (!solved && start == StartState::kNominal && !is_transient()) {
    result.is_from_rest = true;
    solved = solve_sample(variant, inputs_.inputs, values, StartState::kRest, progress);
  }
  if (!solved && is_transient()) return tl::unexpected(solved.error());
  if (!solved) {
    result.failure = solved.error().message;
    return result;
  }
  result.newton_iterations = solved->newton_iterations;
  for (const std::int32_t v : skin_.vertices)
    result.normal_mm.push_back(
        float(solved->skin_mm[std::size_t(v)].dot(skin_.normals_L[std::size_t(v)])));
  return result;
}

/// \param variant  null: that of each sample.
Result<SolvedSamples> UncertainCase::solve(const std::string& kind, std::vector<Index> numbers,
                                           const FaceVariant* variant, StartState start,
                                           Progress& progress) {
  SolvedSamples solved{std::move(numbers), {}};
  solved.results.resize(solved.numbers.size());
  std::vector<std::size_t> open;
  for (std::size_t n = 0; n < solved.numbers.size(); ++n) {
    if (auto stored = store_.read(kind, solved.numbers[n], skin_.vertices.size()))
      solved.results[n] = *std::move(stored);
    else
      open.push_back(n);
  }
  if (open.size() < solved.numbers.size())
    progress.note(fmt::format("{} of {} {} samples were solved by an earlier run",
                              solved.numbers.size() - open.size(), solved.numbers.size(), kind));
  std::vector<Index> samples;
  for (const std::size_t n : open) samples.push_back(solved.numbers[n]);
  if (variant == nullptr) LEFORT_TRY_VOID(prepare_variants(samples, progress));
  progress.begin_stage(fmt::format("solve {} samples, {} model", open.size(), kind));
  QuietProgress quiet(progress);
  std::vector<Result<void>> written(open.size());
  // Samples are independent: one on each thread. The sums within a sample have the same bits.
  constexpr std::size_t kBatch = 16;
  for (std::size_t begin = 0; begin < open.size(); begin += kBatch) {
    if (progress.stop_requested()) return fail(ErrorCode::kCancelled, "stopped");
    const std::size_t end = std::min(open.size(), begin + kBatch);
    parallel_for(
        Index(end - begin),
        [&](Index k) {
          const std::size_t n = open[begin + std::size_t(k)];
          SampleResult& result = solved.results[n];
          const VariantKey key = key_of(solved.numbers[n]);
          if (const auto failed = failed_variants_.find(key);
              variant == nullptr && failed != failed_variants_.end())
            result.failure = failed->second;
          else
            isolate([&] {
              Result<SampleResult> one = solve_one(variant ? *variant : *variants_.at(key),
                                                   solved.numbers[n], start, quiet);
              if (one)
                result = *std::move(one);
              else
                written[begin + std::size_t(k)] = tl::unexpected(one.error());
            });
          if (written[begin + std::size_t(k)] && !quiet.stop_requested())
            written[begin + std::size_t(k)] = store_.write(kind, solved.numbers[n], result);
        },
        1);
    for (std::size_t k = begin; k < end; ++k) LEFORT_TRY_VOID(written[k]);
    progress.report(double(end) / double(open.size()));
  }
  if (progress.stop_requested()) return fail(ErrorCode::kCancelled, "stopped");
  return solved;
}

Result<SolvedSamples> UncertainCase::solve_coarse(Progress& progress) {
  Index begin = 0, end = job_.samples;
  if (job_.chunk) {
    begin = Index(job_.chunk->number - 1) * job_.samples / job_.chunk->count;
    end = Index(job_.chunk->number) * job_.samples / job_.chunk->count;
  }
  return solve("coarse", range(begin, end), nullptr, StartState::kNominal, progress);
}

Result<SolvedSamples> UncertainCase::solve_fine(Progress& progress) {
  std::vector<Index> numbers;
  for (Index i = 0; i < points_.rows() && Index(numbers.size()) < job_.fine_samples; ++i)
    if (key_of(i) == middle_key_) numbers.push_back(i);
  if (job_.chunk)
    std::erase_if(numbers, [&](Index i) {
      return i * job_.chunk->count / job_.samples != job_.chunk->number - 1;
    });
  if (numbers.empty()) return SolvedSamples{};
  const bool are_stored = std::all_of(numbers.begin(), numbers.end(), [&](Index i) {
    return store_.read("fine", i, skin_.vertices.size()).has_value();
  });
  if (are_stored) return solve("fine", numbers, &middle(), StartState::kNominal, progress);
  progress.begin_stage("nominal equilibrium on the mesh of the plan");
  LEFORT_TRY(const FaceVariant fine, make_variant(*prepared_, plan_.tissue, middle_key_.margin_mm,
                                                  skin_.skin_L, cache_, progress));
  return solve("fine", numbers, &fine, StartState::kNominal, progress);
}

Result<SolvedSamples> UncertainCase::solve_paths(Progress& progress) {
  return solve("path", range(0, std::min<Index>(job_.path_checks, points_.rows())), nullptr,
               StartState::kRest, progress);
}

}  // namespace lefort::pipeline
