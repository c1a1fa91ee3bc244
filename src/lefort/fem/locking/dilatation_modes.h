/// \file
/// Average of J in one element and its energy (volumetric_integration.h).
#pragma once

#include <lefort/core/types.h>
#include <lefort/fem/elements/all_elements.h>
#include <lefort/fem/elements/reference_element.h>
#include <lefort/fem/locking/volumetric_integration.h>
#include <lefort/fem/materials/material_response.h>
#include <lefort/fem/materials/volumetric.h>

#include <algorithm>
#include <optional>

namespace lefort::fem {

/// Number of modes of J_mean in one element; 0 for shapes that average around nodes.
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

/// Modes psi_i of J_mean at the points of one element, column by column: 1, or 1, X, Y, Z,
/// orthonormalized so that the sum over points of psi_i psi_j dV is 1 for i = j, else 0.
template <class Element>
using DilatationModes = Eigen::Matrix<double, Element::kPoints, kDilatationModes<Element>>;

/// Instances of this function and of volume_response(): the shapes with modes.
/// \param X       reference positions of the nodes [mm].
/// \param points  reference_element(X).
template <class Element>
[[nodiscard]] DilatationModes<Element> dilatation_modes(const ElementNodes<Element>& X,
                                                        const ReferenceElement<Element>& points);

/// Bulk modulus of the part of U that stays at the points, as a multiple of the shear modulus.
/// docs/studies/locking-remedies.md compares values.
struct PointwiseBulkFactor {
  /// In parts of the body more than one layer thick (elements_in_thick_parts.h).
  double interior = 0.0;
  /// In a single layer, whose averages do not resist bending.
  double single_layer = 0.0;
};
template <class Element>
inline constexpr PointwiseBulkFactor kPointwiseBulkFactor{};
template <>
inline constexpr PointwiseBulkFactor kPointwiseBulkFactor<Tet10>{0.25, 1.0};
template <>
inline constexpr PointwiseBulkFactor kPointwiseBulkFactor<Wedge15>{0.5, 1.25};

template <class Element>
inline constexpr bool kHasPointwiseBulk = kPointwiseBulkFactor<Element>.single_layer > 0.0;

/// Bulk modulus of the part of U that stays in the elements of shapes that average around nodes, as
/// a multiple of the shear modulus. Nodal averages do not resist a change of volume that alternates
/// between the elements around a node.
inline constexpr double kNodalStabilizationFactor = 1.0;

/// U divided into a part of J_mean and a part of J.
struct VolumetricSplit {
  Volumetric of_mean;
  Volumetric at_points;  ///< Bulk modulus 0 if `pointwise_bulk` is 0.
};

/// \param volume          U.
/// \param shear_mpa       shear modulus of the law in the reference configuration.
/// \param pointwise_bulk  bulk modulus at the points, as a multiple of `shear_mpa`, >= 0.
/// \returns the two parts; the sum of their bulk moduli is that of U.
[[nodiscard]] inline VolumetricSplit split_volumetric(const Volumetric& volume, double shear_mpa,
                                                      double pointwise_bulk) {
  VolumetricSplit split{volume, volume};
  split.at_points.kappa_mpa = std::min(volume.kappa_mpa, pointwise_bulk * shear_mpa);
  split.of_mean.kappa_mpa -= split.at_points.kappa_mpa;
  return split;
}

/// \param is_in_thick_part  whether the element or one that shares a corner with it has an
///   interior corner (elements_in_thick_parts()).
/// \returns the two parts for an element with modes; zero if the law is not decoupled.
template <class Element>
[[nodiscard]] VolumetricSplit split_volumetric(const Material& material, bool is_in_thick_part) {
  const Volumetric* volume = volumetric_part(material);
  if (volume == nullptr) return {};
  constexpr PointwiseBulkFactor kBulk = kPointwiseBulkFactor<Element>;
  return split_volumetric(*volume, shear_modulus_at_rest(material),
                          is_in_thick_part ? kBulk.interior : kBulk.single_layer);
}

/// \returns the law without the volumetric part of the nodal averages; it is evaluated at the F of
///   elements and smoothing domains. A law that is not decoupled is returned unchanged.
[[nodiscard]] inline Material element_law_without_nodal_part(const Material& material) {
  const Volumetric* volume = volumetric_part(material);
  if (volume == nullptr) return material;
  const double shear_mpa = shear_modulus_at_rest(material);
  return with_bulk_modulus(
      material,
      split_volumetric(*volume, shear_mpa, kNodalStabilizationFactor).at_points.kappa_mpa);
}

/// Energy, pressure and stiffness of the volumetric part of one element.
template <class Element>
struct VolumeResponse {
  using PerPoint = Eigen::Matrix<double, Element::kPoints, 1>;
  double energy_mj = 0.0;  ///< Sum of U_mean(J_mean) dV and U_points(J) dV.
  PerPoint pressure;       ///< At the points [MPa], tension positive.
  /// Second derivative of the energy of J_mean with respect to theta_i = sum of psi_i J dV.
  Eigen::Matrix<double, kDilatationModes<Element>, kDilatationModes<Element>> curvature;
  PerPoint curvature_at_points;  ///< d2U/dJ2 of the part at the points [MPa].
};

/// \param volume  the two parts of U.
/// \param points  of the element.
/// \param modes   of the element.
/// \param change  J - 1 at the points, > -1.
/// \returns the response, or nothing if J_mean <= 0 at a point.
template <class Element>
[[nodiscard]] std::optional<VolumeResponse<Element>> volume_response(
    const VolumetricSplit& volume, const ReferenceElement<Element>& points,
    const DilatationModes<Element>& modes,
    const Eigen::Matrix<double, Element::kPoints, 1>& change);

}  // namespace lefort::fem
