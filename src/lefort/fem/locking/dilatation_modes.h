/// \file
/// The mean change of volume of one element, and what it costs (volumetric_integration.h).
#pragma once

#include <lefort/core/types.h>
#include <lefort/fem/elements/all_elements.h>
#include <lefort/fem/elements/reference_element.h>
#include <lefort/fem/locking/volumetric_integration.h>
#include <lefort/fem/materials/material_response.h>
#include <lefort/fem/materials/volumetric.h>

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <optional>

namespace lefort::fem {

/// How many functions the mean of one element is made of; 0 where means are taken around nodes.
template <class Element>
inline constexpr int kDilatationModes = 1;
template <>
inline constexpr int kDilatationModes<Hex20> = 4;
template <>
inline constexpr int kDilatationModes<Tet4> = 0;
template <>
inline constexpr int kDilatationModes<Wedge6> = 0;
template <>
inline constexpr int kDilatationModes<Pyramid5> = 0;

/// The functions of one element's mean at its points, column by column: 1, or 1, X, Y, Z, made
/// orthonormal: the sum over points of psi_i psi_j dV is 1 for i = j, else 0.
template <class Element>
using DilatationModes = Eigen::Matrix<double, Element::kPoints, kDilatationModes<Element>>;

/// \param X  reference positions of the nodes [mm].
template <class Element>
[[nodiscard]] DilatationModes<Element> dilatation_modes(const ElementNodes<Element>& X,
                                                        const ReferenceElement<Element>& points) {
  Eigen::Matrix<double, Element::kPoints, 1> volume;
  Eigen::Matrix<double, 3, Element::kPoints> at;
  const auto quadrature = Element::quadrature();
  for (int q = 0; q < Element::kPoints; ++q) {
    volume[q] = points[std::size_t(q)].volume_mm3;
    at.col(q) = X * quadrature[std::size_t(q)].N;
  }
  constexpr int kModes = kDilatationModes<Element>;
  const Vec3 center = at * volume / volume.sum();
  const double size = std::cbrt(volume.sum());
  DilatationModes<Element> raw;
  raw.col(0).setOnes();
  if constexpr (kModes > 1)
    raw.template rightCols<kModes - 1>() = ((at.colwise() - center) / size).transpose();
  // raw^T dV raw = L L^T, so that the columns of raw L^-T are orthonormal.
  const Eigen::Matrix<double, kModes, kModes> gram = raw.transpose() * volume.asDiagonal() * raw;
  const Eigen::Matrix<double, kModes, kModes> L = gram.llt().matrixL();
  return L.template triangularView<Eigen::Lower>().solve(raw.transpose()).transpose();
}

/// Bulk modulus that stays at the points, in shear moduli, since one mean does not see what is
/// linear in an element.
struct PointwiseBulkFraction {
  double inside =
      0.0;  ///< Where the body is more than a layer thick (elements_with_interior_nodes.h).
  double in_layer = 0.0;  ///< Where it is not: no means above and below, which bending tells apart.
};
template <class Element>
inline constexpr PointwiseBulkFraction kPointwiseBulkFraction{};
template <>
inline constexpr PointwiseBulkFraction kPointwiseBulkFraction<Tet10>{0.25, 1.0};
template <>
inline constexpr PointwiseBulkFraction kPointwiseBulkFraction<Wedge15>{0.5, 1.25};

template <class Element>
inline constexpr bool kHasBulkAtPoints = kPointwiseBulkFraction<Element>.in_layer > 0.0;

/// Likewise of shapes with means around nodes, where the shear part is taken: those means do not
/// see what changes sign from one side of a node to the other.
inline constexpr double kNodalStabilizationFraction = 1.0;

/// U in two parts: of the mean, and at the points.
struct SharedVolume {
  Volumetric of_mean;
  Volumetric at_points;  ///< Bulk modulus 0 where `bulk_at_points` is.
};

/// \param shear_mpa       the law's shear modulus at rest.
/// \param bulk_at_points  in shear moduli, >= 0.
[[nodiscard]] inline SharedVolume share_volume(const Volumetric& volume, double shear_mpa,
                                               double bulk_at_points) {
  SharedVolume shared{volume, volume};
  shared.at_points.kappa_mpa = std::min(volume.kappa_mpa, bulk_at_points * shear_mpa);
  shared.of_mean.kappa_mpa -= shared.at_points.kappa_mpa;
  return shared;
}

/// What an element with means of its own asks of a law.
template <class Element>
[[nodiscard]] SharedVolume share_volume(const Material& material, bool has_interior_node) {
  const Volumetric* volume = volumetric_part(material);
  if (volume == nullptr) return {};
  constexpr PointwiseBulkFraction kBulk = kPointwiseBulkFraction<Element>;
  return share_volume(*volume, shear_modulus_at_rest(material),
                      has_interior_node ? kBulk.inside : kBulk.in_layer);
}

/// What shapes with means around nodes ask of a law at the strain of elements and their neighbors:
/// all but the volume's part of the means. Laws that are not in split form are whole.
[[nodiscard]] inline Material element_law_without_nodal_part(const Material& material) {
  const Volumetric* volume = volumetric_part(material);
  if (volume == nullptr) return material;
  const double shear_mpa = shear_modulus_at_rest(material);
  return with_bulk_modulus(
      material, share_volume(*volume, shear_mpa, kNodalStabilizationFraction).at_points.kappa_mpa);
}

/// How an element answers to a change of its volume.
template <class Element>
struct VolumeResponse {
  using PerPoint = Eigen::Matrix<double, Element::kPoints, 1>;
  double energy_mj = 0.0;  ///< Sum of U(J_mean) dV and of U(J) dV, each with its part of U.
  PerPoint pressure;       ///< At its points [MPa], tension positive.
  /// d2/dtheta2 of the energy of the mean, theta_i being the sum of psi_i J dV.
  Eigen::Matrix<double, kDilatationModes<Element>, kDilatationModes<Element>> curvature;
  PerPoint curvature_at_points;  ///< d2U/dJ2 of the rest [MPa].
};

/// \param change  J - 1 at the points, > -1.
/// \returns nothing if a mean volume ratio is not positive.
template <class Element>
[[nodiscard]] std::optional<VolumeResponse<Element>> volume_response(
    const SharedVolume& volume, const ReferenceElement<Element>& points,
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
  if constexpr (kHasBulkAtPoints<Element>)
    for (int q = 0; q < Element::kPoints; ++q) {
      response.energy_mj +=
          points[std::size_t(q)].volume_mm3 * volume.at_points.energy_minus_one(change[q]);
      response.pressure[q] += volume.at_points.dU_dJ(1.0 + change[q]);
      response.curvature_at_points[q] = volume.at_points.d2U_dJ2(1.0 + change[q]);
    }
  return response;
}

}  // namespace lefort::fem
