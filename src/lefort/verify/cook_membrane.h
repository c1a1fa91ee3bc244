/// \file
/// Cook's membrane: a tapered plate, clamped at one end and sheared at the other. Elements that
/// lock are far too stiff.
///
///                   .-48,60        Plane strain: one layer of elements, u_z = 0. 6.25 MPa
///              .-'     |  ^        upwards on the end x = 48 (100 N per mm of thickness).
///     0,44 -'          |  | t
///        |            .-48,44
///        |        .-'
///        |    .-'
///      0,0 -'
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/core/types.h>
#include <lefort/fem/assembly/boundary_conditions.h>
#include <lefort/fem/loads/dead_load.h>
#include <lefort/fem/locking/volumetric_integration.h>
#include <lefort/fem/materials/material.h>
#include <lefort/mesh/volume_mesh.h>

#include <vector>

namespace lefort::verify {

/// E = 240.565 MPa and nu = 0.4999 at small strain: the nearly incompressible neo-Hookean material
/// (mu = 80.1937 MPa, kappa = 400942 MPa) of \cite simo1992.
[[nodiscard]] fem::Material cook_material();

/// Reference rise of the corner (48, 60) [mm].
///
/// Taylor-Hood elements (quadratic displacement, continuous linear pressure, independent of this
/// program) give 6.90927, 6.92736, 6.93111 and 6.93187 on 4, 8, 16 and 32 cells per side; this is
/// their limit by Richardson extrapolation.
inline constexpr double kCookTipRise_mm = 6.932;

struct CookMembrane {
  mesh::VolumeMesh mesh;
  std::vector<fem::PrescribedDisplacement> prescribed;
  std::vector<fem::NodalForce> forces;  ///< At full load.
  /// The node at the corner (48, 60) with z > 0. If cells are divided into wedges or tetrahedra,
  /// the two nodes of this corner rise differently; `tip` rises less.
  std::int32_t tip = 0;
};

/// Diagonal along which cells are divided into wedges or tetrahedra. Along the longer one elements
/// are slender and stiffer in bending.
enum class Diagonal { kShorter, kLonger };

/// \param shape     of the elements.
/// \param cells     along each side, >= 1; each is divided into elements as in mesh::make_box().
/// \param diagonal  of the division.
[[nodiscard]] CookMembrane make_cook_membrane(mesh::ElementShape shape, int cells,
                                              Diagonal diagonal = Diagonal::kShorter);

/// \returns the displacement of CookMembrane::tip at full load [mm], or an error of
///   fem::make_element_terms(), fem::DofMap::build() or fem::LoadStepper::advance_to().
[[nodiscard]] Result<Vec3> solve_cook_membrane(
    const CookMembrane& membrane, const fem::Material& material,
    fem::VolumetricIntegration volumetric_integration = fem::VolumetricIntegration::kMeanDilatation,
    Progress& progress = Progress::none());

}  // namespace lefort::verify
