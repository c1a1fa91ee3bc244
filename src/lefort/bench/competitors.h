/// \file
/// Distances to a surface by other libraries, for comparison.
#pragma once

#include <lefort/core/types.h>
#include <lefort/geometry/triangle_mesh.h>

#include <cstddef>
#include <memory>
#include <span>

namespace lefort::bench {

/// OpenVDB's narrow-band level set (tools::meshToSignedDistanceField).
class OpenVdbField {
 public:
  /// \param origin           a lattice point of the grid.
  /// \param half_band_cells  width of the band on each side of the surface, in cells; samples in it
  ///   are distances.
  OpenVdbField(const geometry::TriangleMesh& mesh, const Vec3& origin, double cell_mm,
               double half_band_cells);
  ~OpenVdbField();
  OpenVdbField(const OpenVdbField&) = delete;
  OpenVdbField& operator=(const OpenVdbField&) = delete;

  [[nodiscard]] std::size_t bytes() const;

  /// Trilinear (tools::BoxSampler through an accessor).
  void distances(std::span<const Vec3> points, std::span<double> distances_mm) const;
  /// With gradients from the same eight samples.
  void gradients(std::span<const Vec3> points, std::span<double> distances_mm,
                 std::span<Vec3> gradients) const;

 private:
  struct Grid;
  std::unique_ptr<Grid> grid_;
};

/// Embree's point queries; unsigned, single precision.
class EmbreePoints {
 public:
  explicit EmbreePoints(const geometry::TriangleMesh& mesh);
  ~EmbreePoints();
  EmbreePoints(const EmbreePoints&) = delete;
  EmbreePoints& operator=(const EmbreePoints&) = delete;

  /// \param max_distance_mm  limit of the search, and the result beyond it.
  void distances(std::span<const Vec3> points, double max_distance_mm,
                 std::span<double> distances_mm) const;

 private:
  struct Scene;
  std::unique_ptr<Scene> scene_;
};

/// CGAL's AABB tree; unsigned, double precision.
class CgalTree {
 public:
  explicit CgalTree(const geometry::TriangleMesh& mesh);
  ~CgalTree();
  CgalTree(const CgalTree&) = delete;
  CgalTree& operator=(const CgalTree&) = delete;

  void distances(std::span<const Vec3> points, std::span<double> distances_mm) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace lefort::bench
