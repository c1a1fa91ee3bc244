#include <lefort/contact/contact_surface.h>
#include <lefort/field/build/build_distance_field.h>
#include <lefort/mesh/box_grid.h>
#include <lefort/verify/case_model.h>
#include <lefort/verify/cases.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

namespace lefort::verify {
namespace {

constexpr double kPunchMu_mpa = 0.005;  // As soft tissue.
constexpr double kPunchKappa_mpa = 0.1;
constexpr double kPunchStiffness_mpa_per_mm =
    0.06;  // Ten times Young's modulus over an element edge.
constexpr double kPunchTolerance = 1e-8;
/// Three or four for quadratic convergence; the rest for points that come into contact.
constexpr int kMaxIterations = 20;
constexpr std::array<double, 3> kBlock_mm{24.0, 16.0, 10.0};

/// Surface of a box.
geometry::TriangleMesh box(const Vec3& low, const Vec3& high) {
  geometry::TriangleMesh mesh;
  for (int corner = 0; corner < 8; ++corner)
    mesh.vertices.emplace_back((corner & 1) != 0 ? high.x() : low.x(),
                               (corner & 2) != 0 ? high.y() : low.y(),
                               (corner & 4) != 0 ? high.z() : low.z());
  constexpr std::array<std::array<std::int32_t, 4>, 6> kSides{
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
  for (const auto& [a, b, c, d] : kSides) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  }
  return mesh;
}

/// A cylinder along y whose lowest line is z = 0.
geometry::TriangleMesh roller(double radius_mm, double from_y, double to_y) {
  constexpr int kAround = 96;
  geometry::TriangleMesh mesh;
  for (const double y : {from_y, to_y})
    for (int n = 0; n < kAround; ++n) {
      const double angle = 2.0 * std::numbers::pi * n / kAround;
      mesh.vertices.emplace_back(radius_mm * std::sin(angle), y,
                                 radius_mm * (1.0 - std::cos(angle)));
    }
  mesh.vertices.emplace_back(0.0, from_y, radius_mm);
  mesh.vertices.emplace_back(0.0, to_y, radius_mm);
  for (std::int32_t n = 0; n < kAround; ++n) {
    const std::int32_t m = (n + 1) % kAround;
    mesh.triangles.push_back({n, kAround + m, m});
    mesh.triangles.push_back({n, kAround + n, kAround + m});
    mesh.triangles.push_back({2 * kAround, n, m});
    mesh.triangles.push_back({2 * kAround + 1, kAround + m, kAround + n});
  }
  return mesh;
}

/// Result of one increment.
struct Increment {
  double fraction = 0.0;
  Vec3 force_n = Vec3::Zero();  ///< On the body.
  Index iterations = 0;
  Index late_rises = 0;  ///< Iterations after the third that increased the residual.
};

struct Followed {
  std::vector<Increment> increments;
  Index failed = 0;  ///< Increments that had to be reduced.
};

/// Presses a rigid body into a block of hexahedra that is fixed below.
Result<Followed> press(const geometry::TriangleMesh& body, int cells_per_10mm, int increments,
                       const std::function<Vec3(double fraction)>& shift_mm, Progress& progress) {
  const auto cells = [&](double mm) { return int(std::lround(mm * 0.1 * cells_per_10mm)); };
  CaseModel model{
      .mesh = mesh::make_box(mesh::ElementShape::kHex8,
                             {cells(kBlock_mm[0]), cells(kBlock_mm[1]), cells(kBlock_mm[2])},
                             Vec3(kBlock_mm[0], kBlock_mm[1], kBlock_mm[2])),
      .materials = {{0, decoupled_neo_hookean(kPunchMu_mpa, kPunchKappa_mpa)}},
      .prescribed = {}};
  std::vector<fem::PrescribedDisplacement> prescribed;
  for (int axis = 0; axis < 3; ++axis)
    prescribe(model.mesh.node_sets.at("z0"), axis, 0.0, prescribed);
  model.prescribed = [prescribed](double) { return prescribed; };

  LEFORT_TRY(field::DistanceField field,
             field::build_distance_field(body, {.resolution = 64, .band_mm = 2.5, .smooth = true},
                                         progress));
  LEFORT_TRY(
      const auto distance_query_B,
      contact::field_distance_query(std::make_shared<const field::DistanceField>(std::move(field)),
                                    contact::DetectionMethod::kSmooth));
  contact::ContactTerm contact(model.mesh.nodes_L, model.mesh.face_sets.at("z1"),
                               {distance_query_B},
                               {.law = {.penalty_mpa_per_mm = kPunchStiffness_mpa_per_mm}});
  model.extra.push_back({&contact, [&](double fraction) {
                           RigidTransform X_LB = RigidTransform::Identity();
                           X_LB.translation() = shift_mm(fraction);
                           contact.set_pose(X_LB);
                         }});
  Followed followed;
  const auto on_increment = [&](double fraction, const VectorX& u) {
    const std::vector<Vec3> x_L = contact::displaced(model.mesh.nodes_L, u);
    contact.note_clearances(x_L);
    followed.increments.push_back(
        {.fraction = fraction, .force_n = contact.summarize(x_L).force_L_n});
  };
  LEFORT_TRY(const Equilibrium found, solve(model,
                                            {.increments = increments,
                                             .relative_tolerance = kPunchTolerance,
                                             .on_increment = on_increment},
                                            progress));
  std::size_t n = 0;
  for (const fem::LoadAttempt& attempt : found.attempts) {
    if (attempt.stop != fem::NewtonStop::kConverged) {
      ++followed.failed;
      continue;
    }
    Increment& increment = followed.increments[n++];
    increment.iterations = Index(attempt.history.size()) - 1;
    for (std::size_t i = 4; i < attempt.history.size(); ++i)
      if (attempt.history[i].residual_n > attempt.history[i - 1].residual_n) ++increment.late_rises;
  }
  return followed;
}

/// Adds the checks common to both cases, and the table of increments.
void check_increments(const Followed& followed, Section& section) {
  Table table{.title = "Force on the body and Newton's iterations, by increment",
              .header = {"fraction", "x [N]", "y [N]", "z [N]", "iterations", "late rises"}};
  Index maximum = 0, rises = 0;
  for (const Increment& increment : followed.increments) {
    maximum = std::max(maximum, increment.iterations);
    rises += increment.late_rises;
    table.rows.push_back(
        {fmt::format("{:.3f}", increment.fraction), fmt::format("{:.4f}", increment.force_n.x()),
         fmt::format("{:.4f}", increment.force_n.y()), fmt::format("{:.4f}", increment.force_n.z()),
         fmt::format("{}", increment.iterations), fmt::format("{}", increment.late_rises)});
  }
  section.tables.push_back(std::move(table));
  section.checks.push_back({.name = "increments that failed",
                            .measured = double(followed.failed),
                            .comparison = Comparison::kAtMost,
                            .expected = 0.0,
                            .reason = "none needs to be reduced"});
  section.checks.push_back({.name = "max iterations of an increment",
                            .measured = double(maximum),
                            .comparison = Comparison::kAtMost,
                            .expected = kMaxIterations,
                            .reason = "an oscillating one runs into the hundreds"});
  section.checks.push_back(
      {.name = "iterations after the third that increased the residual, per increment",
       .measured = double(rises) / double(followed.increments.size()),
       .comparison = Comparison::kAtMost,
       .expected = 1.0,
       .reason = "points that come into contact may increase it once in an increment; an "
                 "oscillation does so every second time"});
}

Section failed_section(Section section, const Error& error) {
  section.checks.push_back(not_measured("path", error.message));
  return section;
}

}  // namespace

Section verify_punch(Extent extent, Progress& progress) {
  Section section{
      .name = "punch",
      .title = "Flat punch",
      .text =
          "A rigid box of 8 x 8 mm with sharp edges is pressed 1 mm flat into a soft block (nu = "
          "0.475), with the smooth field and the contact term of lefort. There is no closed form. "
          "Newton's method must not oscillate, the force must increase with depth, and it must be "
          "vertical, because the problem is symmetric."};
  const Vec3 middle(0.5 * kBlock_mm[0], 0.5 * kBlock_mm[1], kBlock_mm[2]);
  const auto followed = press(
      box(middle + Vec3(-4, -4, 0), middle + Vec3(4, 4, 6)), extent == Extent::kShort ? 5 : 10, 10,
      [](double fraction) { return Vec3(0.0, 0.0, -fraction); }, progress);
  if (!followed) return failed_section(std::move(section), followed.error());
  check_increments(*followed, section);
  double min_rise_n = std::numeric_limits<double>::infinity(), last_n = 0.0;
  double max_sideways = 0.0;
  for (const Increment& increment : followed->increments) {
    max_sideways = std::max(max_sideways,
                            increment.force_n.head<2>().norm() / std::abs(increment.force_n.z()));
    min_rise_n = std::min(min_rise_n, -increment.force_n.z() - last_n);
    last_n = -increment.force_n.z();
  }
  section.checks.push_back({.name = "min increase of the force from increment to increment",
                            .measured = min_rise_n,
                            .comparison = Comparison::kAtLeast,
                            .expected = 0.0,
                            .unit = "N",
                            .reason = "the force increases with depth"});
  section.checks.push_back(
      {.name = "max sideways force over downward force",
       .measured = max_sideways,
       .comparison = Comparison::kAtMost,
       .expected = 0.0,
       .tolerance = 1e-3,
       .reason = "block, punch and path are symmetric",
       .known_failure =
           "tissue under the sharp edges of the punch slips out on one side before the other; "
           "whether the equilibrium is unstable there or the field is asymmetric is not known"});
  return section;
}

Section verify_ironing(Extent extent, Progress& progress) {
  constexpr double kPunchRadius_mm = 4.0, kPressed_mm = 1.0, kSlid_mm = 10.0, kPressing = 0.2;
  Section section{
      .name = "ironing",
      .title = "Ironing: a roller pressed in and slid along",
      .text = fmt::format(
          "A rigid cylinder of {} mm lies across a soft block (nu = 0.475), is pressed in by {} mm "
          "and slides {} mm along without friction, with the smooth field and the contact term of "
          "lefort. Nodes come into contact in front and leave it behind: if normals jump, the "
          "force jumps and Newton cycles. Over the middle of the path the force must be constant.",
          kPunchRadius_mm, kPressed_mm, kSlid_mm)};
  geometry::TriangleMesh cylinder = roller(kPunchRadius_mm, -2.0, kBlock_mm[1] + 2.0);
  for (Vec3& v : cylinder.vertices) v += Vec3(7.0, 0.0, kBlock_mm[2]);
  const auto followed = press(
      cylinder, extent == Extent::kShort ? 5 : 10, 25,
      [&](double fraction) {
        const double pressed = std::min(fraction / kPressing, 1.0);
        const double slid = std::max(fraction - kPressing, 0.0) / (1.0 - kPressing);
        return Vec3(slid * kSlid_mm, 0.0, -pressed * kPressed_mm);
      },
      progress);
  if (!followed) return failed_section(std::move(section), followed.error());
  check_increments(*followed, section);
  report::PlotLine down{.name = "down"}, along{.name = "against the motion"};
  double min_n = std::numeric_limits<double>::infinity(), max_n = 0.0;
  for (const Increment& increment : followed->increments) {
    down.x.push_back(increment.fraction);
    down.y.push_back(-increment.force_n.z());
    along.x.push_back(increment.fraction);
    along.y.push_back(increment.force_n.x());
    if (increment.fraction < 0.4 || increment.fraction > 0.8)
      continue;  // Away from the ends of the block.
    min_n = std::min(min_n, -increment.force_n.z());
    max_n = std::max(max_n, -increment.force_n.z());
  }
  section.plots.push_back({.title = "Force on the block",
                           .x_label = "path fraction",
                           .y_label = "force [N]",
                           .lines = {std::move(down), std::move(along)}});
  section.checks.push_back(
      {.name = "variation of the force over the middle of the path, relative to its mean",
       .measured = (max_n - min_n) / (0.5 * (max_n + min_n)),
       .comparison = Comparison::kAtMost,
       .expected = 0.0,
       .tolerance = 0.05,
       .reason = "the block is uniform there",
       .known_failure = extent == Extent::kShort ? "nodes enter and leave contact one by one; "
                                                   "elements of the short form are 2 mm wide"
                                                 : ""});
  return section;
}

}  // namespace lefort::verify
