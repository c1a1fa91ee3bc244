/// \file
/// Pressure that follows the surface it acts on: always along the current normal, on the current
/// area.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/fem/assembly/force_term.h>
#include <lefort/mesh/volume_mesh.h>

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace lefort::fem {

/// f_a = -p * (integral of N_a n da), n out of the body (\cite bonet2008, section 8.5). An item is
/// a face.
///
/// Its energy is p times the volume that the surface sweeps on the straight way from rest,
///   W = p * (integral over the face and over t from 0 to 1 of u . n(X + t u)) .
/// Varying x gives the force above and, from each edge, terms that neighboring faces cancel. So
/// the sum over a closed surface, or one whose rim is held, is conservative; and its tangent is
/// symmetric, though a face's own is not \cite schweizerhof1984. On a rim that is free the force
/// stays as it should be, and is_conservative() says that it is no gradient.
///
/// A face hands on the symmetric part of its tangent. Over a closed surface, or with a rim that is
/// held or slides in a plane, those sum to the exact tangent: the whole being symmetric, it is the
/// sum of the symmetric parts. With a free rim the antisymmetric parts do not cancel (newton.h).
class FollowerPressure final : public ForceTerm {
 public:
  /// \param nodes_L  reference positions of all nodes [mm].
  /// \param faces    of the mesh's boundary, counter-clockwise seen from outside.
  /// \returns the term, without pressure; or kMeshInvalid if a face names a node twice, or one that
  ///   does not exist or has no finite position.
  [[nodiscard]] static Result<std::unique_ptr<FollowerPressure>> build(
      std::span<const Vec3> nodes_L, std::vector<mesh::Face> faces);

  /// Positive presses on the body. Starts at 0. Not while the term is being evaluated.
  void set_pressure_mpa(double pressure_mpa) { pressure_mpa_ = pressure_mpa; }

  [[nodiscard]] Index item_count() const override { return Index(faces_.size()); }
  [[nodiscard]] std::span<const std::int32_t> nodes(Index item) const override;
  [[nodiscard]] bool evaluate(Index item, std::span<const Vec3> x_L,
                              LocalEquations& local) const override;
  /// Whether every edge of the surface lies between two of its faces or is held altogether.
  [[nodiscard]] bool is_conservative(const DofMap& dofs) const override;

 private:
  FollowerPressure() = default;

  std::vector<mesh::Face> faces_;
  std::vector<std::array<Vec3, 8>> rest_L_;  ///< Nodes of each face.
  std::vector<std::int32_t> rim_nodes_;      ///< Of edges that belong to one face alone.
  double pressure_mpa_ = 0.0;
};

}  // namespace lefort::fem
