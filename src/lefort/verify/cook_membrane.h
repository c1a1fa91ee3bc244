/// \file
/// Cook's membrane: a tapered plate, clamped at one end and sheared at the other. Elements that
/// lock are far too stiff in it.
///
///                   .-48,60        Plane strain: one layer of elements, held across it. 6.25 MPa
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
/// (mu = 80.1938 MPa, kappa = 400942 MPa) of \cite simo1992.
[[nodiscard]] fem::Material cook_material();

/// How far the corner (48, 60) rises [mm].
///
/// Taylor-Hood elements (quadratic displacement, continuous linear pressure, so none of this
/// program's) give 6.90927, 6.92736, 6.93111 and 6.93187 on 4, 8, 16 and 32 cells a side; the limit
/// by Richardson.
inline constexpr double kCookTipRise_mm = 6.932;

struct CookMembrane {
  mesh::VolumeMesh mesh;
  std::vector<fem::PrescribedDisplacement> prescribed;
  std::vector<fem::NodalForce> forces;  ///< At full load.
  std::int32_t tip = 0;  ///< The node on the corner (48, 60) at z > 0: where cells are cut, the one
                         ///< that lags behind.
};

/// Cells that are cut in two (wedges, tetrahedra) are cut along one of these. Along the longer one
/// elements are slender, and bend less.
enum class Diagonal { kShorter, kLonger };

/// \param cells  along either side, >= 1; each is cut into elements as mesh::make_box() says.
[[nodiscard]] CookMembrane make_cook_membrane(mesh::ElementShape shape, int cells,
                                              Diagonal diagonal = Diagonal::kShorter);

/// \returns how far the corner (48, 60) moves under full load [mm], or what LoadStepper::advance_to
///   refuses.
[[nodiscard]] Result<Vec3> solve_cook_membrane(
    const CookMembrane& membrane, const fem::Material& material,
    fem::VolumetricIntegration volumetric_integration = fem::VolumetricIntegration::kMeanDilatation,
    Progress& progress = Progress::none());

}  // namespace lefort::verify
