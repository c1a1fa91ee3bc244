#include <lefort/compare/register_surface.h>
#include <lefort/core/decompositions.h>
#include <lefort/core/parallel.h>
#include <lefort/core/units.h>
#include <lefort/dental/beyond_border.h>
#include <lefort/dental/coarse_alignment.h>
#include <lefort/dental/register_arch.h>
#include <lefort/geometry/bvh.h>
#include <lefort/geometry/mesh_properties.h>
#include <lefort/geometry/rigid_motion.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

namespace lefort::dental {
namespace {

using geometry::Bvh;
using geometry::TriangleMesh;

constexpr double kMinLength_mm = 25.0, kMaxLength_mm = 150.0;
/// A registration is accepted up to this RMS. On one labeled head, correct scans have up to 0.26 mm
/// and mirrored ones 0.44 or more; unrelated distances, uniform within 1 mm, would have 0.58.
constexpr double kMaxRms_mm = 0.4;
/// At least so much of the crowns has a counterpart; the rest may be metal or cropped.
constexpr double kMinFraction = 0.4;
constexpr double kMaxScaleError = 0.015;
/// A scan that fits only with a scale is called scaled up to this: with more, any scan may fit.
constexpr double kMaxKnownScale = 0.1;
/// Another jaw or the mirror image fits better if its RMS is below this part of the scan's own, and
/// at least this part of the own vertices has a counterpart.
constexpr double kClearlyBetter = 0.8;
constexpr int kTurns = 24;
/// Crowns within this angle of the anterior direction, seen from the middle of the arch.
constexpr double kAnterior_deg = 50.0;

Result<void> check_length(const TriangleMesh& scan) {
  const double length_mm = geometry::bounding_box(scan).diagonal().norm();
  if (length_mm >= kMinLength_mm && length_mm <= kMaxLength_mm) return {};
  for (const auto& [factor, unit] : {std::pair{1000.0, "meters"},
                                     {25.4, "inches"},
                                     {10.0, "centimeters"},
                                     {0.001, "micrometers"}})
    if (length_mm * factor >= kMinLength_mm && length_mm * factor <= kMaxLength_mm)
      return fail(
          ErrorCode::kInvalidArgument,
          fmt::format("the intraoral scan is {:.3g} mm long, must be {:g} to {:g}; its unit "
                      "may be {}: convert it to mm",
                      length_mm, kMinLength_mm, kMaxLength_mm, unit));
  return fail(ErrorCode::kInvalidArgument,
              fmt::format("the intraoral scan is {:.3g} mm long, must be {:g} to {:g}", length_mm,
                          kMinLength_mm, kMaxLength_mm));
}

/// Area, its center, the vector area, and the axis of least variance.
struct AreaMoments {
  double mm2 = 0.0;
  Vec3 center = Vec3::Zero();
  Vec3 vector_mm2 = Vec3::Zero();
  Vec3 thin = Vec3::UnitZ();
};

AreaMoments moments_of(const TriangleMesh& mesh) {
  AreaMoments all;
  Mat3 second = Mat3::Zero();
  for (Index t = 0; t < mesh.triangle_count(); ++t) {
    const Vec3 &a = mesh.corner(t, 0), &b = mesh.corner(t, 1), &c = mesh.corner(t, 2);
    const Vec3 vector = 0.5 * (b - a).cross(c - a);
    const Vec3 middle = (a + b + c) / 3.0;
    all.mm2 += vector.norm();
    all.vector_mm2 += vector;
    all.center += vector.norm() * middle;
    second += vector.norm() * middle * middle.transpose();
  }
  if (all.mm2 > 0.0) {
    all.center /= all.mm2;
    all.thin = symmetric_eigen(Mat3(second / all.mm2 - all.center * all.center.transpose()))
                   .vectors.col(0);
  }
  return all;
}

Mat3 axes_from(const Vec3& first, const Vec3& about) {
  Mat3 axes;
  axes.col(0) = first;
  axes.col(1) = about.cross(first);
  axes.col(2) = about;
  return axes;
}

/// Initial alignments of crowns with a scan.
std::vector<RigidTransform> alignments(const Crowns& crowns, const TriangleMesh& scan) {
  const AreaMoments moments = moments_of(scan);
  constexpr double kOpen = 0.1;  // Of the vector area of an open surface, relative to its area.
  std::vector<Vec3> directions{moments.thin, -moments.thin};
  if (moments.vector_mm2.norm() > kOpen * moments.mm2) {
    const Vec3 outward = moments.vector_mm2.normalized();
    directions = {outward.dot(moments.thin) > 0.0 ? moments.thin : Vec3(-moments.thin), outward};
  }
  const Vec3 crown_center = moments_of(crowns.surface_L).center;
  const Mat3 here = axes_from(crowns.anterior_L, crowns.occlusal_L);
  std::vector<RigidTransform> starts;
  for (const Vec3& direction : directions) {
    const Vec3 any = direction.unitOrthogonal();
    for (int turn = 0; turn < kTurns; ++turn) {
      const double angle = 2.0 * std::numbers::pi * turn / kTurns;
      const Vec3 front = std::cos(angle) * any + std::sin(angle) * direction.cross(any);
      RigidTransform X = RigidTransform::Identity();
      X.linear() = axes_from(front, direction) * here.transpose();
      X.translation() = moments.center - X.linear() * crown_center;
      starts.push_back(X);
    }
  }
  return starts;
}

/// Alignments about one: turned about the occlusal direction and shifted along the arch, because
/// teeth of similar size also fit beside each other.
std::vector<RigidTransform> alignments_near(const RigidTransform& X, const Crowns& crowns) {
  constexpr double kTurn_deg = 8.0, kShift_mm = 4.0;
  const Vec3 up = X.linear() * crowns.occlusal_L, front = X.linear() * crowns.anterior_L;
  std::vector<RigidTransform> starts{X};
  for (int turn = -1; turn <= 1; ++turn)
    for (int ahead = -1; ahead <= 1; ++ahead)
      for (int aside = -1; aside <= 1; ++aside)
        starts.push_back(geometry::rigid_motion(
                             kShift_mm * (ahead * front + aside * up.cross(front)),
                             radians_from_degrees(turn * kTurn_deg) * up, X * crowns.center_L) *
                         X);
  return starts;
}

/// \returns the ends from all starts, the closest first.
std::vector<Alignment> search(const Crowns& crowns, const Bvh& scan,
                              const std::vector<RigidTransform>& starts) {
  return align_coarsely(points_with_normals(crowns.surface_L, 300), scan, crowns.center_L, starts,
                        {.quantile = kMinFraction});
}

TriangleMesh reversed(TriangleMesh mesh) {
  for (geometry::Triangle& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  return mesh;
}

/// The mirror image, counter-clockwise again.
TriangleMesh mirrored(TriangleMesh mesh) {
  for (Vec3& p : mesh.vertices) p.x() = -p.x();
  return reversed(std::move(mesh));
}

/// Signed distance of each vertex of the crowns, NaN without a counterpart.
std::vector<double> distances_of(const Crowns& crowns, const Bvh& scan, const RigidTransform& X) {
  const TriangleMesh& mesh = crowns.surface_L;
  const geometry::Pseudonormals normals(mesh);
  std::vector<double> distances(mesh.vertices.size(), std::numeric_limits<double>::quiet_NaN());
  parallel_for(mesh.vertex_count(), [&](Index v) {
    const Vec3 p = X * mesh.vertices[std::size_t(v)];
    const auto nearest = scan.closest_point(p, kCounterpart_mm);
    if (!nearest) return;
    const Vec3 there =
        scan.pseudonormals().at(scan.mesh(), nearest->triangle, nearest->feature).normalized();
    if (!(there.dot(X.linear() * normals.at_vertex(mesh, v)) > 0.5)) return;
    const Vec3 offset = p - nearest->point;
    if (is_beyond_border(offset, there)) return;
    distances[std::size_t(v)] = there.dot(offset);
  });
  return distances;
}

/// Vertices of the crowns where the scan is missing: more than 1 mm away and beside it, as seen
/// along the normal at the closest point.
std::vector<std::uint8_t> beyond_scan(const TriangleMesh& crowns, const Bvh& scan,
                                      const RigidTransform& X) {
  std::vector<std::uint8_t> is_beyond(crowns.vertices.size(), 0);
  parallel_for(crowns.vertex_count(), [&](Index v) {
    const Vec3 p = X * crowns.vertices[std::size_t(v)];
    const auto nearest = scan.closest_point(p);
    if (!nearest) return;
    const Vec3 there =
        scan.pseudonormals().at(scan.mesh(), nearest->triangle, nearest->feature).normalized();
    is_beyond[std::size_t(v)] =
        nearest->distance_mm > kCounterpart_mm && is_beyond_border(p - nearest->point, there);
  });
  return is_beyond;
}

/// The crowns without the triangles where the scan is missing.
TriangleMesh within_scan(TriangleMesh crowns, const Bvh& scan, const RigidTransform& X) {
  const std::vector<std::uint8_t> is_beyond = beyond_scan(crowns, scan, X);
  std::erase_if(crowns.triangles, [&](const geometry::Triangle& triangle) {
    return std::any_of(triangle.begin(), triangle.end(),
                       [&](std::int32_t v) { return is_beyond[std::size_t(v)] != 0; });
  });
  return crowns;
}

Result<compare::Registration> fit(const Crowns& crowns, const TriangleMesh& mesh, const Bvh& scan,
                                  Progress& progress) {
  constexpr std::size_t kCandidates = 2;
  constexpr int kPasses = 3;
  std::vector<Alignment> ends = search(crowns, scan, alignments(crowns, mesh));
  std::vector<RigidTransform> near;
  for (std::size_t n = 0; n < std::min(kCandidates, ends.size()); ++n)
    for (const RigidTransform& X : alignments_near(ends[n].X, crowns)) near.push_back(X);
  if (progress.stop_requested())
    return fail(ErrorCode::kCancelled, "the registration was cancelled");
  const compare::RegisterOptions options{.max_points = 8000, .max_median_mm = kCounterpart_mm};
  Result<compare::Registration> found =
      compare::Registration{.X_onto_from = search(crowns, scan, near).front().X};
  // Where a part of the scan is missing, the closest points lie on its border, which pulls: such
  // pairs are left out, as by Turk & Levoy 1994.
  for (int pass = 0; found && pass < kPasses; ++pass) {
    const std::array<RigidTransform, 1> now{found->X_onto_from};
    found = compare::register_surface(within_scan(crowns.surface_L, scan, now[0]), scan, now,
                                      options, progress);
  }
  return found;
}

template <class Filter>
CrownDistances summarize(const Crowns& crowns, const std::vector<double>& distances_mm,
                         const Filter& belongs) {
  std::vector<double> sizes;
  double squared = 0.0;
  Index all = 0;
  for (std::size_t v = 0; v < distances_mm.size(); ++v) {
    if (!belongs(crowns.surface_L.vertices[v])) continue;
    ++all;
    if (std::isnan(distances_mm[v])) continue;
    sizes.push_back(std::abs(distances_mm[v]));
    squared += distances_mm[v] * distances_mm[v];
  }
  CrownDistances sum{.points = Index(sizes.size())};
  if (sizes.empty()) return sum;
  sum.fraction = double(sizes.size()) / double(all);
  sum.rms_mm = std::sqrt(squared / double(sizes.size()));
  const auto p95 = sizes.begin() + std::ptrdiff_t(0.95 * double(sizes.size() - 1));
  std::nth_element(sizes.begin(), p95, sizes.end());
  sum.p95_mm = *p95;
  return sum;
}

Sextant sextant_of(const Crowns& crowns, const Vec3& p_L) {
  const Vec3 arm = p_L - crowns.center_L;
  const Vec3 left = Vec3::UnitX();
  const double ahead = arm.dot(crowns.anterior_L), aside = arm.dot(left);
  if (ahead > 0.0 && std::abs(aside) < std::tan(radians_from_degrees(kAnterior_deg)) * ahead)
    return Sextant::kAnterior;
  return aside > 0.0 ? Sextant::kLeft : Sextant::kRight;
}

void measure(const Crowns& crowns, const Bvh& scan, const RigidTransform& X, ArchFit& found) {
  found.X_L_scan = X.inverse();
  found.distances_mm = distances_of(crowns, scan, X);
  found.all = summarize(crowns, found.distances_mm, [](const Vec3&) { return true; });
  for (const Sextant sextant : {Sextant::kRight, Sextant::kAnterior, Sextant::kLeft})
    found.sextants[std::size_t(sextant)] =
        summarize(crowns, found.distances_mm,
                  [&](const Vec3& p_L) { return sextant_of(crowns, p_L) == sextant; });
}

[[nodiscard]] bool is_acceptable(const CrownDistances& distances) {
  return distances.rms_mm <= kMaxRms_mm && distances.fraction >= kMinFraction;
}

/// Distances of the best fit; nothing if there is none.
Result<std::optional<CrownDistances>> distances_of_fit(const Crowns& crowns,
                                                       const TriangleMesh& scan,
                                                       Progress& progress) {
  const Bvh tree(scan);
  const auto found = fit(crowns, scan, tree, progress);
  if (progress.stop_requested())
    return fail(ErrorCode::kCancelled, "the registration was cancelled");
  if (!found) return std::nullopt;
  ArchFit arch;
  measure(crowns, tree, found->X_onto_from, arch);
  return arch.all;
}

/// Whether an alternative fits, and clearly better than the scan as it is, which may not fit.
[[nodiscard]] bool is_better(const std::optional<CrownDistances>& alternative,
                             const std::optional<CrownDistances>& own) {
  if (!alternative) return false;
  if (!own) return is_acceptable(*alternative);
  return alternative->rms_mm < kClearlyBetter * own->rms_mm &&
         alternative->fraction >= kClearlyBetter * own->fraction;
}

/// Scale of the CT relative to the scan, and the distances of the crowns with that scale.
struct ScaledFit {
  double scale = 1.0;
  CrownDistances distances;
};

/// The scale of the crowns about their center that fits best: a seventh unknown beside the six
/// motions, from the linearized distances along the normals.
ScaledFit fit_with_scale(const Crowns& crowns, const Bvh& scan, RigidTransform X) {
  using Mat7 = Eigen::Matrix<double, 7, 7>;
  using Vec7 = Eigen::Matrix<double, 7, 1>;
  constexpr double kRadius_mm = 20.0;  // Makes the unknowns comparable.
  double scale = 1.0;
  TriangleMesh scaled = crowns.surface_L;
  for (int iteration = 0; iteration < 10; ++iteration) {
    const Crowns now{.surface_L = scaled};
    const std::vector<double> off = distances_of(now, scan, X);
    const Vec3 center = X * crowns.center_L;
    Mat7 A = Mat7::Identity() * 1e-9;
    Vec7 b = Vec7::Zero();
    for (std::size_t v = 0; v < off.size(); ++v) {
      if (std::isnan(off[v])) continue;
      const Vec3 p = X * scaled.vertices[v];
      const auto nearest = scan.closest_point(p, kCounterpart_mm);
      if (!nearest) continue;
      const Vec3 n =
          scan.pseudonormals().at(scan.mesh(), nearest->triangle, nearest->feature).normalized();
      const Vec3 arm = p - center;
      Vec7 row;
      row << arm.cross(n) / kRadius_mm, n, arm.dot(n) / kRadius_mm;
      A += row * row.transpose();
      b -= off[v] * row;
    }
    const Vec7 step = A.ldlt().solve(b);
    X = geometry::rigid_motion(step.segment<3>(3), step.head<3>() / kRadius_mm, center) * X;
    const double factor = 1.0 + step[6] / kRadius_mm;
    scale *= factor;
    for (Vec3& p : scaled.vertices) p = crowns.center_L + factor * (p - crowns.center_L);
    if (std::abs(factor - 1.0) < 1e-5) break;
  }
  const Crowns last{.surface_L = scaled};
  return {1.0 / scale,
          summarize(last, distances_of(last, scan, X), [](const Vec3&) { return true; })};
}

/// \param own  distances of the scan as it is; nothing if it does not fit.
Result<void> check_alternatives(const TriangleMesh& scan, const Crowns& crowns, const Crowns* other,
                                const std::optional<CrownDistances>& own, Progress& progress) {
  if (other) {
    LEFORT_TRY(const auto other_jaw, distances_of_fit(*other, scan, progress));
    if (is_better(other_jaw, own))
      return fail(
          ErrorCode::kInvalidArgument,
          fmt::format("the intraoral scan of the {} jaw fits the {} teeth: the files may be "
                      "swapped",
                      name_of(crowns.jaw), name_of(other->jaw)));
  }
  LEFORT_TRY(const auto mirror_image, distances_of_fit(crowns, mirrored(scan), progress));
  if (is_better(mirror_image, own))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("the mirror image of the intraoral scan fits the {} teeth: it is "
                            "mirrored, or of another patient",
                            name_of(crowns.jaw)));
  return {};
}

/// As register_arch(), for triangles that face outward.
Result<ArchFit> register_outward(const TriangleMesh& scan, const Crowns& crowns,
                                 const Crowns* other, Progress& progress) {
  ArchFit found;
  const Bvh tree(scan);
  auto registration = fit(crowns, scan, tree, progress);
  if (progress.stop_requested())
    return fail(ErrorCode::kCancelled, "the registration was cancelled");
  if (registration) measure(crowns, tree, registration->X_onto_from, found);
  const bool fits = registration && is_acceptable(found.all);
  LEFORT_TRY_VOID(check_alternatives(scan, crowns, other,
                                     fits ? std::optional(found.all) : std::nullopt, progress));
  if (!registration)
    return fail(ErrorCode::kNotConverged,
                fmt::format("the intraoral scan does not fit the {} teeth: {}", name_of(crowns.jaw),
                            registration.error().message));
  const ScaledFit scaled = fit_with_scale(crowns, tree, registration->X_onto_from);
  const double off = std::abs(scaled.scale - 1.0);
  if (!(off <= kMaxScaleError) &&
      (fits || (off < kMaxKnownScale && is_acceptable(scaled.distances))))
    return fail(
        fits ? ErrorCode::kInvalidArgument : ErrorCode::kNotConverged,
        fmt::format("the intraoral scan is scaled, or of another patient: it fits the {} teeth "
                    "with a factor of {:.3f}, must be 1 within {:g}",
                    name_of(crowns.jaw), scaled.scale, kMaxScaleError));
  if (!fits)
    return fail(ErrorCode::kNotConverged,
                fmt::format("the intraoral scan does not fit the {} teeth: {:.0f} % of the crowns "
                            "have a counterpart, RMS {:.2f} mm; must be {:.0f} % and {:g} mm",
                            name_of(crowns.jaw), 100.0 * found.all.fraction, found.all.rms_mm,
                            100.0 * kMinFraction, kMaxRms_mm));
  found.scale = scaled.scale;
  return found;
}

}  // namespace

Result<ArchFit> register_arch(const TriangleMesh& scan, const Crowns& crowns, const Crowns* other,
                              Progress& progress) {
  LEFORT_TRY_VOID(geometry::check_surface(scan));
  LEFORT_TRY_VOID(check_length(scan));
  LEFORT_TRY_VOID(geometry::check_surface(crowns.surface_L));
  if (other) LEFORT_TRY_VOID(geometry::check_surface(other->surface_L));
  auto found = register_outward(scan, crowns, other, progress);
  if (found || found.error().code != ErrorCode::kNotConverged) return found;
  LEFORT_TRY(const auto turned_fit, distances_of_fit(crowns, reversed(scan), progress));
  if (!turned_fit || !is_acceptable(*turned_fit)) return found;
  LEFORT_TRY(ArchFit turned, register_outward(reversed(scan), crowns, other, progress));
  turned.is_reversed = true;
  return turned;
}

}  // namespace lefort::dental
