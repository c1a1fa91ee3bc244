/// \file
/// A block of tissue on a bone: a minimal face.
#pragma once

#include <lefort/field/build/build_distance_field.h>
#include <lefort/geometry/rigid_path.h>
#include <lefort/mesh/boundary_faces.h>
#include <lefort/plan/plan.h>
#include <lefort/predict/mesh_tissue.h>
#include <lefort/predict/predict_face.h>
#include <lefort/predict/tissue_boundary.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "support/box_mesh.h"
#include "support/shapes.h"

namespace lefort::test {

inline constexpr double kSide_mm = 12.0;
inline constexpr double kHeight_mm = 9.0;

inline predict::ContactBone moved(geometry::TriangleMesh surface_B) {
  auto field =
      field::build_distance_field(surface_B, {.resolution = 64, .band_mm = 3.0, .smooth = true});
  return {std::move(surface_B), std::make_shared<const field::DistanceField>(*std::move(field))};
}

/// A block of tissue, fixed at its top, on a slab of bone:
///
///      ////////   z = 9, fixed
///      | tissue|
///      |_______|  z = 0
///    |  segment   |
inline predict::FaceModel block_on(geometry::TriangleMesh segment_B) {
  predict::FaceModel model;
  model.tissue = test::box_mesh({.cells = {6, 6, 5}, .size_mm = {kSide_mm, kSide_mm, kHeight_mm}});
  auto& node_sets = model.tissue.node_sets;
  node_sets[predict::sets::kMobilizedSegment] = node_sets.at("z0");
  node_sets[predict::sets::kFixed] = node_sets.at("z1");
  for (const mesh::Face& face : mesh::boundary_faces(model.tissue)) {
    const auto nodes = nodes_of(face);
    const bool is_low = std::all_of(nodes.begin(), nodes.end(), [&](std::int32_t node) {
      return model.tissue.nodes_L[std::size_t(node)].z() < 1e-9;
    });
    if (is_low) model.tissue.face_sets[predict::sets::kContact].push_back(face);
  }
  model.segments = {moved(std::move(segment_B))};
  return model;
}

inline predict::FaceModel block_on_slab() {
  return block_on(test::make_box({-4.0, -4.0, -10.0}, {16.0, 16.0, 0.0}));
}

/// The upper half of the block is skin.
inline predict::FaceModel layered_block() {
  predict::FaceModel model = block_on_slab();
  for (mesh::ElementBlock& block : model.tissue.blocks)
    for (Index e = 0; e < block.element_count(); ++e) {
      Vec3 center = Vec3::Zero();
      for (int n = 0; n < node_count(block.shape); ++n)
        center += model.tissue.nodes_L[std::size_t(block.element(e)[n])] / node_count(block.shape);
      if (center.z() > kHeight_mm / 2.0) block.region[std::size_t(e)] = predict::regions::kSkin;
    }
  return model;
}

/// The block is on top of a ball.
inline predict::FaceModel block_on_ball() {
  constexpr double kRadius_mm = 14.0;
  geometry::TriangleMesh ball = test::make_icosphere(kRadius_mm, 5);
  for (Vec3& vertex : ball.vertices) vertex += Vec3(6.0, 6.0, -kRadius_mm);
  return block_on(std::move(ball));
}

/// The surface of the tissue with all of its nodes.
inline geometry::TriangleMesh surface_of(const predict::FaceModel& model) {
  geometry::TriangleMesh surface;
  surface.vertices = model.tissue.nodes_L;
  for (const mesh::Face3& face : mesh::triangles_of(mesh::boundary_faces(model.tissue)))
    surface.triangles.push_back({face[0], face[1], face[2]});
  return surface;
}

/// A rigid path in one direction.
inline geometry::RigidPath straight(const Vec3& by_mm, int steps) {
  geometry::RigidPath path;
  path.segment = "slab";
  path.steps = steps;
  path.keyframes = {{.path_fraction = 1.0, .translation_mm = by_mm}};
  return path;
}

}  // namespace lefort::test
