#include <lefort/contact/pose_derivative.h>

#include <optional>

namespace lefort::contact {
namespace {

/// Force and exact stiffness of an item.
struct ItemEquations {
  VectorX r;
  Eigen::MatrixXd K;
};

/// \returns nothing if both are zero, or the item is inadmissible.
std::optional<ItemEquations> equations_of(const fem::ForceTerm& term, Index item,
                                          std::span<const Vec3> x_L) {
  const auto size = 3 * Index(x_L.size());
  ItemEquations of{VectorX::Zero(size), Eigen::MatrixXd::Zero(size, size)};
  fem::LocalEquations local{
      .residual_n = Eigen::Map<VectorX>(of.r.data(), size),
      .stiffness_n_per_mm = Eigen::Map<Eigen::MatrixXd>(of.K.data(), size, size)};
  if (!term.evaluate(item, x_L, local)) return std::nullopt;
  if (of.r.isZero(0.0) && of.K.isZero(0.0)) return std::nullopt;
  return of;
}

}  // namespace

Eigen::MatrixXd pose_derivatives_n(const fem::ForceTerm& term, Index item,
                                   std::span<const Vec3> x_L,
                                   std::span<const geometry::MotionRate> rates) {
  const auto size = 3 * Index(x_L.size());
  Eigen::MatrixXd derivatives = Eigen::MatrixXd::Zero(size, Index(rates.size()));
  const std::optional<ItemEquations> of = equations_of(term, item, x_L);
  if (!of) return derivatives;
  VectorX velocity(size);
  for (std::size_t k = 0; k < rates.size(); ++k) {
    auto column = derivatives.col(Index(k));
    for (std::size_t a = 0; a < x_L.size(); ++a) {
      const Vec3 force_n = of->r.segment<3>(3 * Index(a));
      velocity.segment<3>(3 * Index(a)) = rates[k].at(x_L[a]);
      column.segment<3>(3 * Index(a)) = rates[k].rotation_rad.cross(force_n);
    }
    column.noalias() -= of->K * velocity;
  }
  return derivatives;
}

Eigen::MatrixXd following_derivatives_n(const fem::ForceTerm& term, Index item,
                                        std::span<const Vec3> x_L,
                                        std::span<const geometry::MotionRate> rates,
                                        double fraction, const Vec3& point_L) {
  const auto size = 3 * Index(x_L.size());
  Eigen::MatrixXd derivatives = Eigen::MatrixXd::Zero(size, Index(rates.size()));
  const std::optional<ItemEquations> of = equations_of(term, item, x_L);
  for (std::size_t k = 0; of && k < rates.size(); ++k) {
    const VectorX moved = (fraction * rates[k].at(point_L)).replicate(Index(x_L.size()), 1);
    derivatives.col(Index(k)).noalias() = -(of->K * moved);
  }
  return derivatives;
}

}  // namespace lefort::contact
