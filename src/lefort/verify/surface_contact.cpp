#include <lefort/contact/measure_gap.h>
#include <lefort/contact/penalty.h>
#include <lefort/core/check.h>
#include <lefort/fem/faces/all_faces.h>
#include <lefort/verify/surface_contact.h>

#include <utility>
#include <variant>

namespace lefort::verify {
namespace {

using contact::Derivatives;

/// Calls visit(shape functions, their values at rest times area) at the points of one face.
template <class Shape, class Visit>
void for_each_point(const Vec3* rest_L, const Visit& visit) {
  static const auto kQuadrature = Shape::quadrature();
  const Eigen::Map<const fem::FaceNodes<Shape>> X(rest_L->data());
  for (const auto& point : kQuadrature)
    visit(point.N, fem::area_mm2(fem::tangents<Shape>(X, point), point.weight).norm());
}

}  // namespace

SurfaceContact::SurfaceContact(std::span<const Vec3> nodes_L, std::vector<mesh::Face> faces,
                               contact::BoneObstacle obstacle, double stiffness_mpa_per_mm)
    : faces_(std::move(faces)),
      obstacle_(std::move(obstacle)),
      stiffness_mpa_per_mm_(stiffness_mpa_per_mm) {
  LEFORT_CHECK(stiffness_mpa_per_mm_ > 0.0);
  for (const mesh::Face& face : faces_) {
    std::array<Vec3, 8>& rest = rest_L_.emplace_back();
    for (std::size_t a = 0; a < mesh::nodes_of(face).size(); ++a)
      rest[a] = nodes_L[std::size_t(face.nodes[a])];
  }
}

bool SurfaceContact::evaluate(Index item, std::span<const Vec3> x_L,
                              fem::LocalEquations& local) const {
  bool admissible = true;
  const auto add = [&]<class Shape>(const Shape&) {
    const Eigen::Map<const fem::FaceNodes<Shape>> x(x_L.data()->data());
    for_each_point<Shape>(rest_L_[std::size_t(item)].data(), [&](const auto& N, double area_mm2) {
      const contact::Gap gap = contact::measure_gap(
          obstacle_, x * N, local.wants_stiffness() ? Derivatives::kSecond : Derivatives::kFirst);
      if (gap.zone == field::Zone::kInside) admissible = false;
      if (gap.zone != field::Zone::kBand || !(gap.gap_mm < 0.0)) return;
      const contact::PenaltyResponse response = contact::penalty_response(
          -gap.gap_mm, gap.gradient_L, gap.hessian_L, {stiffness_mpa_per_mm_});
      local.energy_mj += area_mm2 * response.energy_mj_per_mm2;
      for (int a = 0; a < Shape::kNodes; ++a)
        local.residual_n.segment<3>(3 * a) += area_mm2 * N[a] * response.gradient_mpa;
      if (!local.wants_stiffness()) return;
      const Mat3 hessian = local.tangent == fem::Tangent::kExact
                               ? response.hessian_mpa_per_mm
                               : contact::convex_hessian(-gap.gap_mm, gap.gradient_L, gap.hessian_L,
                                                         {stiffness_mpa_per_mm_});
      for (int a = 0; a < Shape::kNodes; ++a)
        for (int b = 0; b < Shape::kNodes; ++b)
          local.stiffness_n_per_mm.block<3, 3>(3 * a, 3 * b) += area_mm2 * N[a] * N[b] * hessian;
    });
  };
  std::visit(add, fem::face_of(faces_[std::size_t(item)].shape));
  return admissible;
}

std::vector<SurfaceContact::Point> SurfaceContact::points_in_contact(
    std::span<const Vec3> x_L) const {
  std::vector<Point> points;
  for (std::size_t item = 0; item < faces_.size(); ++item)
    std::visit(
        [&]<class Shape>(const Shape&) {
          const fem::FaceNodes<Shape> x = fem::face_nodes<Shape>(faces_[item], x_L);
          for_each_point<Shape>(rest_L_[item].data(), [&](const auto& N, double area_mm2) {
            const Vec3 at = x * N;
            const contact::Gap gap = contact::measure_gap(obstacle_, at, Derivatives::kFirst);
            if (gap.zone != field::Zone::kBand || !(gap.gap_mm < 0.0)) return;
            const Vec3 traction_mpa =
                -contact::penalty_response(-gap.gap_mm, gap.gradient_L, gap.hessian_L,
                                           {stiffness_mpa_per_mm_})
                     .gradient_mpa;
            points.push_back({.x_L = at,
                              .pressure_mpa = traction_mpa.norm(),
                              .force_n = area_mm2 * traction_mpa});
          });
        },
        fem::face_of(faces_[item].shape));
  return points;
}

}  // namespace lefort::verify
