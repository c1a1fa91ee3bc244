#include <lefort/contact/pose_derivative.h>

namespace lefort::contact {

Eigen::MatrixXd pose_derivatives_n(const fem::ForceTerm& term, Index item,
                                   std::span<const Vec3> x_L,
                                   std::span<const geometry::MotionRate> rates) {
  const auto size = 3 * Index(x_L.size());
  VectorX r = VectorX::Zero(size);
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(size, size);
  Eigen::MatrixXd derivatives = Eigen::MatrixXd::Zero(size, Index(rates.size()));
  fem::LocalEquations local{
      .residual_n = Eigen::Map<VectorX>(r.data(), size),
      .stiffness_n_per_mm = Eigen::Map<Eigen::MatrixXd>(K.data(), size, size)};
  if (!term.evaluate(item, x_L, local)) return derivatives;
  if (r.isZero(0.0) && K.isZero(0.0)) return derivatives;
  VectorX velocity(size);
  for (std::size_t k = 0; k < rates.size(); ++k) {
    auto column = derivatives.col(Index(k));
    for (std::size_t a = 0; a < x_L.size(); ++a) {
      velocity.segment<3>(3 * Index(a)) = rates[k].at(x_L[a]);
      column.segment<3>(3 * Index(a)) =
          rates[k].rotation_rad.cross(Vec3(r.segment<3>(3 * Index(a))));
    }
    column.noalias() -= K * velocity;
  }
  return derivatives;
}

}  // namespace lefort::contact
