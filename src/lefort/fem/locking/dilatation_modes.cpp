#include <lefort/fem/locking/dilatation_modes.h>

#include <Eigen/Cholesky>

#include <cmath>

namespace lefort::fem {

template <class Element>
DilatationModes<Element> dilatation_modes(const ElementNodes<Element>& X,
                                          const ReferenceElement<Element>& points) {
  double volume = 0.0;
  for (int q = 0; q < Element::kPoints; ++q) volume += points[std::size_t(q)].volume_mm3;
  if constexpr (kDilatationModes<Element> == 1) {
    return DilatationModes<Element>::Constant(1.0 / std::sqrt(volume));
  } else {
    Eigen::Matrix<double, 3, Element::kPoints> at;
    const auto quadrature = Element::quadrature();
    Vec3 center = Vec3::Zero();
    for (int q = 0; q < Element::kPoints; ++q) {
      at.col(q) = X * quadrature[std::size_t(q)].N;
      center += points[std::size_t(q)].volume_mm3 / volume * at.col(q);
    }
    // raw^T dV raw = L L^T, so that the columns of raw L^-T are orthonormal.
    DilatationModes<Element> raw;
    Eigen::Matrix4d gram = Eigen::Matrix4d::Zero();
    for (int q = 0; q < Element::kPoints; ++q) {
      raw.row(q) << 1.0, ((at.col(q) - center) / std::cbrt(volume)).transpose();
      gram += points[std::size_t(q)].volume_mm3 * raw.row(q).transpose() * raw.row(q);
    }
    const Eigen::Matrix4d L = gram.llt().matrixL();
    return L.triangularView<Eigen::Lower>().solve(raw.transpose()).transpose();
  }
}

template <class Element>
std::optional<VolumeResponse<Element>> volume_response(
    const VolumetricSplit& volume, const ReferenceElement<Element>& points,
    const DilatationModes<Element>& modes,
    const Eigen::Matrix<double, Element::kPoints, 1>& change) {
  using Theta = Eigen::Matrix<double, kDilatationModes<Element>, 1>;
  Theta theta = Theta::Zero();
  for (int q = 0; q < Element::kPoints; ++q)
    theta += points[std::size_t(q)].volume_mm3 * change[q] * modes.row(q).transpose();
  VolumeResponse<Element> response;
  response.curvature.setZero();
  Theta pressure = Theta::Zero();
  for (int q = 0; q < Element::kPoints; ++q) {
    const Theta psi = modes.row(q).transpose();
    const double dV = points[std::size_t(q)].volume_mm3;
    const double mean_change = psi.dot(theta);
    if (!(mean_change > -1.0)) return std::nullopt;
    response.energy_mj += dV * volume.of_mean.energy_minus_one(mean_change);
    pressure += dV * volume.of_mean.dU_dJ(1.0 + mean_change) * psi;
    response.curvature += dV * volume.of_mean.d2U_dJ2(1.0 + mean_change) * psi * psi.transpose();
  }
  response.pressure = modes * pressure;
  response.curvature_at_points.setZero();
  if constexpr (kHasPointwiseBulk<Element>)
    for (int q = 0; q < Element::kPoints; ++q) {
      response.energy_mj +=
          points[std::size_t(q)].volume_mm3 * volume.at_points.energy_minus_one(change[q]);
      response.pressure[q] += volume.at_points.dU_dJ(1.0 + change[q]);
      response.curvature_at_points[q] = volume.at_points.d2U_dJ2(1.0 + change[q]);
    }
  return response;
}

template DilatationModes<Hex8> dilatation_modes<Hex8>(const ElementNodes<Hex8>&,
                                                      const ReferenceElement<Hex8>&);
template std::optional<VolumeResponse<Hex8>> volume_response<Hex8>(
    const VolumetricSplit&, const ReferenceElement<Hex8>&, const DilatationModes<Hex8>&,
    const Eigen::Matrix<double, Hex8::kPoints, 1>&);
template DilatationModes<Tet10> dilatation_modes<Tet10>(const ElementNodes<Tet10>&,
                                                        const ReferenceElement<Tet10>&);
template std::optional<VolumeResponse<Tet10>> volume_response<Tet10>(
    const VolumetricSplit&, const ReferenceElement<Tet10>&, const DilatationModes<Tet10>&,
    const Eigen::Matrix<double, Tet10::kPoints, 1>&);
template DilatationModes<Wedge15> dilatation_modes<Wedge15>(const ElementNodes<Wedge15>&,
                                                            const ReferenceElement<Wedge15>&);
template std::optional<VolumeResponse<Wedge15>> volume_response<Wedge15>(
    const VolumetricSplit&, const ReferenceElement<Wedge15>&, const DilatationModes<Wedge15>&,
    const Eigen::Matrix<double, Wedge15::kPoints, 1>&);
template DilatationModes<Hex20> dilatation_modes<Hex20>(const ElementNodes<Hex20>&,
                                                        const ReferenceElement<Hex20>&);
template std::optional<VolumeResponse<Hex20>> volume_response<Hex20>(
    const VolumetricSplit&, const ReferenceElement<Hex20>&, const DilatationModes<Hex20>&,
    const Eigen::Matrix<double, Hex20::kPoints, 1>&);

}  // namespace lefort::fem
