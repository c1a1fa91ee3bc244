/// \file
/// Follower pressure: along the current normal, on the current area.
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

/// f_a = -p (integral of N_a n da) with the outward normal n (\cite bonet2008, section 8.5). An
/// item is a face.
///
/// The energy is p times the volume that the surface sweeps along the straight path from the
/// reference configuration:
///   W = p (integral over t from 0 to 1, and over the face at X + t u, of u . n da)
/// The variation of W gives the force above, and terms on each edge that cancel between adjacent
/// faces. So the sum over a closed surface, or one whose border is prescribed, is conservative and
/// has a symmetric tangent, although that of a single face is not symmetric
/// (\cite schweizerhof1984). With a free border the force is still right, but is_conservative() is
/// false.
///
/// The stiffness of evaluate() is the symmetric part of the tangent of a face for Tangent::kExact,
/// the antisymmetric part for kAntisymmetric, and zero for kStabilized. If the tangent of the whole
/// surface is symmetric, the sum of the symmetric parts is the exact tangent: on a closed surface,
/// and if the border is prescribed or slides in a plane. With a free border the antisymmetric parts
/// do not cancel (newton.h).
class FollowerPressure final : public ForceTerm {
 public:
  /// \param nodes_L  reference positions of all nodes [mm].
  /// \param faces    of the boundary of the mesh, counter-clockwise seen from outside.
  /// \returns the term, without pressure; or kMeshInvalid if a face names a node twice, or one that
  ///   does not exist or has no finite position.
  [[nodiscard]] static Result<std::unique_ptr<FollowerPressure>> build(
      std::span<const Vec3> nodes_L, std::vector<mesh::Face> faces);

  /// Initially 0; positive means compression. Must not be called while the term is being evaluated.
  void set_pressure_mpa(double pressure_mpa) { pressure_mpa_ = pressure_mpa; }

  [[nodiscard]] Index item_count() const override { return Index(faces_.size()); }
  [[nodiscard]] std::span<const std::int32_t> nodes(Index item) const override;
  [[nodiscard]] bool evaluate(Index item, std::span<const Vec3> x_L,
                              LocalEquations& local) const override;
  /// \returns whether every edge of the surface belongs to two of its faces, or all components of
  ///   its nodes are prescribed.
  [[nodiscard]] bool is_conservative(const DofMap& dofs) const override;

 private:
  FollowerPressure() = default;

  std::vector<mesh::Face> faces_;
  std::vector<std::array<Vec3, 8>> reference_L_;  ///< Nodes of each face.
  std::vector<std::int32_t> border_nodes_;        ///< Of edges that do not have two faces.
  double pressure_mpa_ = 0.0;
};

}  // namespace lefort::fem
