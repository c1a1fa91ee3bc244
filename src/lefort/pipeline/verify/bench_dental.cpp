#include <lefort/anatomy/intraoral_scan.h>
#include <lefort/anatomy/parametric_head.h>
#include <lefort/anatomy/trace_nerve.h>
#include <lefort/core/units.h>
#include <lefort/dental/find_occlusion.h>
#include <lefort/dental/number_teeth.h>
#include <lefort/dental/register_arch.h>
#include <lefort/dental/register_bite.h>
#include <lefort/dental/splint.h>
#include <lefort/geometry/rigid_motion.h>
#include <lefort/geometry/transform_mesh.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/verify.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace lefort::pipeline {
namespace {

using geometry::TriangleMesh;

/// Figures of all heads and starts by name, and a table with one line for each.
class Figures {
 public:
  void add(std::uint64_t seed, int start, const std::string& name, double value) {
    values_[name].push_back(value);
    table_ += fmt::format("{},{},{},{:.4f}\n", seed, start, name, value);
  }
  [[nodiscard]] const std::map<std::string, std::vector<double>>& values() const { return values_; }
  [[nodiscard]] const std::string& table() const { return table_; }

 private:
  std::map<std::string, std::vector<double>> values_;
  std::string table_ = "seed,start,figure,value\n";
};

/// A number from -1 to 1.
double drawn(std::mt19937_64& bits) { return 2.0 * double(bits() >> 11) * 0x1p-53 - 1.0; }

Vec3 drawn_vector(std::mt19937_64& bits) {
  const double x = drawn(bits), y = drawn(bits), z = drawn(bits);  // In this order.
  return {x, y, z};
}

/// A random face with teeth, whose mandible is up to 5 mm from occlusion.
anatomy::HeadShape shape_of(std::uint64_t seed) {
  anatomy::HeadShape shape = anatomy::draw_head_shape(seed);
  std::mt19937_64 bits(seed);
  shape.dentition = seed;
  shape.jaw_offset_mm = Vec3(3.0, 5.0, 0.0).cwiseProduct(drawn_vector(bits));
  shape.opening_rad = anatomy::opening_with_clearance(shape, 1.0);
  return shape;
}

struct Difference {
  double max_mm = 0.0, deg = 0.0;
};

Difference between(const TriangleMesh& mesh, const RigidTransform& X, const RigidTransform& truth) {
  Difference difference;
  for (const Vec3& p : mesh.vertices)
    difference.max_mm = std::max(difference.max_mm, (X * p - truth * p).norm());
  difference.deg = degrees_from_radians(
      geometry::rotation_vector(Mat3(X.linear() * truth.linear().transpose())).norm());
  return difference;
}

/// Directions of the arches from the crowns of the upper jaw.
dental::ArchAxes axes_of(const dental::Crowns& upper) {
  return {-upper.occlusal_L, upper.anterior_L};
}

/// One head: its scan and what is found in it.
struct BenchHead {
  anatomy::ParametricHead head;
  std::uint64_t seed;
  anatomy::LabeledScan scan;
  anatomy::ToothMap teeth;
  std::array<dental::Crowns, 2> crowns;
  std::array<TriangleMesh, 2> arches_L;  ///< Intraoral scans where they truly are.
  TriangleMesh bite_L;                   ///< Scan of the bite, with noise of its own.
};

Result<BenchHead> make_head(std::uint64_t seed, double voxel_mm, double noise_hu,
                            Progress& progress) {
  constexpr double kBone_hu = 300.0, kSpacing_mm = 0.3, kNoise_mm = 0.03;
  const Box3 jaws(Vec3(-70, -122, -108), Vec3(70, 8, 16));  // With margins for turned heads.
  const anatomy::ParametricHead head(shape_of(seed));
  const Vec3 shift = head.X_LH().translation();
  BenchHead made{head,
                 seed,
                 anatomy::scan_of(head, Box3(jaws.min() + shift, jaws.max() + shift), voxel_mm,
                                  noise_hu, seed),
                 {},
                 {},
                 {},
                 {}};
  std::array<TriangleMesh, 2> again_L;
  made.teeth = anatomy::find_teeth(made.scan.ct, made.scan.labels, kBone_hu);
  for (const bool is_upper : {true, false}) {
    const std::size_t n = is_upper ? 0 : 1;
    LEFORT_TRY(
        made.crowns[n],
        dental::find_crowns(made.scan.ct, made.teeth,
                            is_upper ? anatomy::Tooth::kUpper : anatomy::Tooth::kLower, progress));
    const auto scanned = [&](std::uint64_t noise_seed) {
      return anatomy::scanned_arch(head, is_upper, kSpacing_mm, kNoise_mm, noise_seed, progress);
    };
    LEFORT_TRY(made.arches_L[n], scanned(seed + n));
    LEFORT_TRY(again_L[n], scanned(seed + 10 + n));
  }
  made.bite_L = anatomy::scanned_bite(head, again_L[0], again_L[1]);
  return made;
}

void number(const BenchHead& one, Figures& figures) {
  constexpr double kSame_mm = 3.5;  // Half of a narrow premolar.
  const Mat3 directions = one.head.X_LH().linear();
  const dental::NumberedTeeth numbered =
      dental::number_teeth(one.teeth, {directions.col(0), -directions.col(1), directions.col(2),
                                       one.head.X_LH() * Vec3(0, -80, -40)});
  double right = 0.0;
  for (const dental::NumberedTooth& found : numbered.teeth)
    for (const anatomy::ToothForm& tooth : one.head.dentition().teeth())
      if (tooth.fdi == found.fdi &&
          (found.crown_L - one.head.from_tooth_L(tooth, tooth.crown_M())).norm() < kSame_mm)
        right += 1.0;
  figures.add(one.seed, 0, "teeth with their number", right);
}

Result<void> trace(const BenchHead& one, Figures& figures) {
  std::map<std::string, Vec3> landmarks;
  for (const auto& [name, p_L] : anatomy::true_landmarks(one.head)) landmarks[name] = p_L;
  const Mat3 directions = one.head.X_LH().linear();
  for (const auto& [side, letter] : {std::pair(-1.0, "R"), std::pair(1.0, "L")}) {
    const auto canal = anatomy::trace_nerve(
        one.scan.ct, one.scan.labels,
        {side * directions.col(0), -directions.col(1), directions.col(2), landmarks.at("Pg"),
         landmarks.at(fmt::format("Go-{}", letter)), landmarks.at(fmt::format("Co-{}", letter))});
    if (!canal) return tl::unexpected(canal.error());
    const std::vector<Vec3> truth = one.head.canal_L(side);
    double sum_mm = 0.0;
    for (const Vec3& p : canal->line_L) {
      double distance_mm = 1e9;
      for (std::size_t i = 0; i + 1 < truth.size(); ++i) {
        const Vec3 along = truth[i + 1] - truth[i];
        const double t = std::clamp((p - truth[i]).dot(along) / along.squaredNorm(), 0.0, 1.0);
        distance_mm = std::min(distance_mm, (p - truth[i] - t * along).norm());
      }
      sum_mm += distance_mm;
    }
    figures.add(one.seed, 0, "canal, mean distance [mm]", sum_mm / double(canal->line_L.size()));
  }
  return {};
}

/// Registration of both arches, from a random frame.
Result<void> register_both(const BenchHead& one, int start, std::mt19937_64& bits, Figures& figures,
                           Progress& progress) {
  for (const std::size_t n : {std::size_t(0), std::size_t(1)}) {
    const RigidTransform X_scan_L = geometry::rigid_motion(
        80.0 * drawn_vector(bits), std::numbers::pi * drawn_vector(bits), Vec3::Zero());
    const TriangleMesh file = geometry::transformed(one.arches_L[n], X_scan_L);
    LEFORT_TRY(const dental::ArchFit fit,
               dental::register_arch(file, one.crowns[n], &one.crowns[1 - n], progress));
    const Difference off = between(file, fit.X_L_scan, X_scan_L.inverse());
    figures.add(one.seed, start, "intraoral scan in the CT [mm]", off.max_mm);
    figures.add(one.seed, start, "intraoral scan in the CT [degrees]", off.deg);
  }
  return {};
}

/// Occlusion by search and from a bite scan, of a lower arch disturbed by up to 5 mm and 8 degrees.
Result<void> occlude(const BenchHead& one, int start, std::mt19937_64& bits, Figures& figures,
                     Progress& progress) {
  const dental::ArchAxes axes = axes_of(one.crowns[0]);
  const RigidTransform closed = one.head.X_occlusion_L();
  Vec3 shift = drawn_vector(bits), turn = drawn_vector(bits);
  shift *= 5.0 / std::max(1.0, shift.norm());
  turn *= radians_from_degrees(8.0) / std::max(1.0, turn.norm());
  shift -= (shift.dot(axes.superior_L) + 2.0) * axes.superior_L;  // Open.
  const Vec3 center = geometry::transformed(one.arches_L[1], closed).vertices.front();
  const RigidTransform X = geometry::rigid_motion(shift, turn, center) * closed;
  const TriangleMesh lower_L = geometry::transformed(one.arches_L[1], X);
  const RigidTransform truth = closed * X.inverse();
  const auto found = dental::find_occlusion(one.arches_L[0], lower_L, axes, {}, progress);
  if (!found && found.error().code == ErrorCode::kCancelled) return tl::unexpected(found.error());
  const Difference off =
      found ? between(lower_L, found->X_L_lower, truth) : Difference{99.0, 180.0};
  figures.add(one.seed, start, "occlusion, search [mm]", off.max_mm);
  figures.add(one.seed, start, "occlusion, search [degrees]", off.deg);
  const std::vector<TriangleMesh> bite{geometry::transformed(one.bite_L, X.inverse())};
  LEFORT_TRY(const dental::Bite fit,
             dental::register_bite(one.arches_L[0], lower_L, axes, bite, progress));
  const Difference bite_off = between(lower_L, fit.X_L_lower, truth);
  figures.add(one.seed, start, "occlusion, bite scan [mm]", bite_off.max_mm);
  figures.add(one.seed, start, "occlusion, bite scan [degrees]", bite_off.deg);
  return {};
}

Result<void> make_one_splint(const BenchHead& one, Figures& figures, Progress& progress) {
  const dental::ArchAxes axes = axes_of(one.crowns[0]);
  RigidTransform X = one.head.X_occlusion_L();
  X.translation() -= 2.0 * axes.superior_L;
  LEFORT_TRY(const dental::Splint splint,
             dental::make_splint(one.arches_L[0], geometry::transformed(one.arches_L[1], X), axes,
                                 {}, progress));
  for (const dental::InsertionFit* fit : {&splint.upper, &splint.lower}) {
    figures.add(one.seed, 0, "splint, clearance [mm]", fit->median_mm);
    figures.add(one.seed, 0, "splint, penetration [mm]", fit->max_penetration_mm);
  }
  return {};
}

/// A function without a result counts as 99, out of range, in its figures.
Result<void> counted(Result<void> result, std::uint64_t seed,
                     std::initializer_list<const char*> names, Figures& figures) {
  if (result || result.error().code == ErrorCode::kCancelled) return result;
  for (const char* const name : names) figures.add(seed, 0, name, 99.0);
  return {};
}

/// What each figure should be.
struct Target {
  const char* name;
  double low, high;
};
constexpr std::array<Target, 10> kTargets{{
    {"teeth with their number", 28.0, 28.0},
    {"canal, mean distance [mm]", 0.0, 1.0},
    {"intraoral scan in the CT [mm]", 0.0, 0.2},
    {"intraoral scan in the CT [degrees]", 0.0, 0.5},
    {"occlusion, search [mm]", 0.0, 0.3},
    {"occlusion, search [degrees]", 0.0, 0.5},
    {"occlusion, bite scan [mm]", 0.0, 0.3},
    {"occlusion, bite scan [degrees]", 0.0, 0.5},
    {"splint, clearance [mm]", 0.05, 0.15},
    {"splint, penetration [mm]", 0.0, 0.05},
}};

Summary summarize(const DentalBenchJob& job, const Figures& figures) {
  Summary summary;
  summary.text = fmt::format(
      "{} synthetic heads from seed {}, {} starts each\n"
      "  figure                                  median      min      max   target        within",
      job.heads, job.seed, job.starts);
  nlohmann::json rows = nlohmann::json::object();
  for (const Target& target : kTargets) {
    const auto at = figures.values().find(target.name);
    if (at == figures.values().end()) continue;
    std::vector<double> sorted = at->second;
    std::sort(sorted.begin(), sorted.end());
    const auto within = std::count_if(sorted.begin(), sorted.end(), [&](double value) {
      return value >= target.low && value <= target.high;
    });
    const double median = sorted[sorted.size() / 2];
    summary.text += fmt::format("\n  {:<36} {:9.3f} {:8.3f} {:8.3f}   {:g} to {:g}   {} of {}",
                                target.name, median, sorted.front(), sorted.back(), target.low,
                                target.high, within, sorted.size());
    rows[target.name] = {{"median", median},     {"min", sorted.front()},
                         {"max", sorted.back()}, {"target", {target.low, target.high}},
                         {"within", within},     {"count", sorted.size()}};
  }
  summary.json = {{"heads", job.heads},
                  {"seed", job.seed},
                  {"starts", job.starts},
                  {"figures", std::move(rows)}};
  return summary;
}

}  // namespace

Result<Summary> bench_dental(const DentalBenchJob& job, Progress& progress) {
  if (job.output.extension() != ".csv")
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("output file {} must end in .csv", job.output.string()));
  Figures figures;
  for (int n = 0; n < job.heads; ++n) {
    const std::uint64_t seed = job.seed + std::uint64_t(n);
    std::mt19937_64 bits(seed * 7919);
    LEFORT_TRY(const BenchHead one, make_head(seed, job.voxel_mm, job.noise_hu, progress));
    number(one, figures);
    LEFORT_TRY_VOID(counted(trace(one, figures), seed, {"canal, mean distance [mm]"}, figures));
    LEFORT_TRY_VOID(counted(make_one_splint(one, figures, progress), seed,
                            {"splint, clearance [mm]", "splint, penetration [mm]"}, figures));
    for (int start = 0; start < job.starts; ++start) {
      LEFORT_TRY_VOID(counted(
          register_both(one, start, bits, figures, progress), seed,
          {"intraoral scan in the CT [mm]", "intraoral scan in the CT [degrees]"}, figures));
      LEFORT_TRY_VOID(counted(occlude(one, start, bits, figures, progress), seed,
                              {"occlusion, bite scan [mm]", "occlusion, bite scan [degrees]"},
                              figures));
      progress.note(
          fmt::format("head {} of {}, start {} of {}", n + 1, job.heads, start + 1, job.starts));
    }
  }
  LEFORT_TRY_VOID(io::write_text(job.output, figures.table()));
  return summarize(job, figures);
}

}  // namespace lefort::pipeline
