/// \file
/// The numerical inf-sup test of a pair of displacement and pressure spaces.
#pragma once

#include <lefort/core/types.h>
#include <lefort/mesh/volume_mesh.h>

#include <string>

namespace lefort::verify {

/// Pressures of a pair. The displacements are those of the element shapes.
enum class PressureSpace {
  kElementConstant,  ///< One per element.
  kElementLinear,    ///< 1, X, Y and Z per element; discontinuous.
  /// At the corner nodes, with the functions of the linear shape; continuous. Lone corners of hex20
  /// have none (fem/locking/lone_corners.h).
  kContinuous
};

/// Result of the test on one mesh.
struct InfSup {
  double number = 0.0;   ///< Square root of the min nonzero eigenvalue, 0 to 1.
  Index zero_modes = 0;  ///< Pressure modes that do no work on any displacement.
  Index pressures = 0;   ///< Size of the pressure space.
};

/// Solves the eigenvalue problem of the numerical inf-sup test (\cite chapelle1993;
/// \cite bathe2001):
///
///   G q = lambda M q,   G = B A^-1 B^T,
///   q^T B v = integral of q div v,   v^T A v = integral of |grad v|^2,   q^T M q = integral of q^2
///
/// for displacements v that are zero at the held nodes. If the whole boundary is held, the constant
/// pressure has the eigenvalue zero; every other zero is a spurious pressure mode. A pair is stable
/// if no mesh has one and the square root of the min nonzero eigenvalue has a lower bound that does
/// not depend on the mesh.
///
/// \param mesh      of one or several shapes.
/// \param pressure  space of the pressure.
/// \param held      node set whose displacements are zero.
/// \returns the number and the count of zero eigenvalues.
/// \pre the shapes have a valid reference element.
/// \note Dense in the pressures: 1000 of them take seconds.
[[nodiscard]] InfSup inf_sup_number(const mesh::VolumeMesh& mesh, PressureSpace pressure,
                                    const std::string& held);

}  // namespace lefort::verify
