/// \file
/// Active tension along fibers, for the contracting ventricle of the cardiac benchmark.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/fem/assembly/force_term.h>
#include <lefort/mesh/volume_mesh.h>

#include <functional>
#include <memory>

namespace lefort::verify {

/// W = sum over quadrature points of T / 2 (f . F^T F f - 1) dV: the second Piola-Kirchhoff stress
/// T f (x) f (\cite land2015, section 2). An item is an element.
class FiberTension : public fem::ForceTerm {
 public:
  /// \param mesh   elements of one shape; must outlive the term.
  /// \param fiber  unit vector of the fibers at a reference position [mm], in L.
  /// \returns the term, without tension; or kMeshInvalid if `mesh` has not exactly one block or an
  ///   element is inverted.
  [[nodiscard]] static Result<std::unique_ptr<FiberTension>> build(
      const mesh::VolumeMesh& mesh, const std::function<Vec3(const Vec3& X)>& fiber);

  /// Initially 0. Must not be called while the term is being evaluated.
  void set_tension_mpa(double tension_mpa) { tension_mpa_ = tension_mpa; }

 protected:
  FiberTension() = default;

  double tension_mpa_ = 0.0;
};

}  // namespace lefort::verify
