/// \file
/// Faces of every shape against a rigid obstacle, without friction: the potential of
/// contact/penalty.h, integrated over the faces at rest.
#pragma once

#include <lefort/contact/bone_obstacle.h>
#include <lefort/core/types.h>
#include <lefort/fem/force_term.h>
#include <lefort/mesh/volume_mesh.h>

#include <array>
#include <span>
#include <vector>

namespace lefort::verify {

class SurfaceContact final : public fem::ForceTerm {
 public:
  /// \param nodes_L   all nodes at rest [mm].
  /// \param faces     of the mesh's boundary.
  /// \param stiffness_mpa_per_mm  k_c > 0: the pressure is 2 k_c times the penetration.
  SurfaceContact(std::span<const Vec3> nodes_L, std::vector<mesh::Face> faces,
                 contact::BoneObstacle obstacle, double stiffness_mpa_per_mm);

  /// Moves the obstacle. Not while the term is being evaluated.
  void set_pose(const RigidTransform& X_LB) { obstacle_.X_LB = X_LB; }

  [[nodiscard]] Index item_count() const override { return Index(faces_.size()); }
  [[nodiscard]] std::span<const std::int32_t> nodes(Index item) const override {
    return mesh::nodes_of(faces_[std::size_t(item)]);
  }
  [[nodiscard]] bool evaluate(Index item, std::span<const Vec3> x_L,
                              fem::LocalEquations& local) const override;

  /// An integration point in contact.
  struct Point {
    Vec3 x_L;             ///< Where it is now [mm].
    double pressure_mpa;  ///< > 0.
    Vec3 force_n;         ///< On the body.
  };

  /// \param x_L  current positions of all nodes [mm].
  [[nodiscard]] std::vector<Point> points_in_contact(std::span<const Vec3> x_L) const;

 private:
  std::vector<mesh::Face> faces_;
  std::vector<std::array<Vec3, 8>> rest_L_;  ///< Nodes of each face.
  contact::BoneObstacle obstacle_;
  double stiffness_mpa_per_mm_;
};

}  // namespace lefort::verify
