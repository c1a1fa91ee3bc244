#include <lefort/core/parallel.h>
#include <lefort/mesh/internal/layer_directions.h>

#include <cstddef>
#include <cstdint>
#include <utility>

namespace lefort::mesh::internal {
namespace {

// Heuristic values, without a source in the literature.
constexpr int kDirectionSmoothings = 3;    // Averages over the neighbors of a node.
constexpr int kMaxTurns = 30;              // Turns of one direction by kTurnFraction.
constexpr double kTurnFraction = 0.2;      // Of a face normal, added in one turn.
constexpr double kMinFaceCosine = 0.7;     // Between direction and face normal: 46 degrees.
constexpr double kMinProjectedNorm = 0.3;  // Sine of the angle between cut plane and skin normal.

std::vector<Vec3> inward_normals(const LayerSurface& surface) {
  std::vector<Vec3> inwards(surface.nodes_L.size(), Vec3::Zero());
  for (std::size_t n = 0; n < inwards.size(); ++n) {
    Vec3 sum = Vec3::Zero();
    for (const Index f : surface.faces_of_node.of(n)) sum -= surface.area_vector(f);
    if (sum.norm() > 0.0) inwards[n] = sum.normalized();
  }
  return inwards;
}

/// Replaces each direction by the mean over the corners of the faces around its node.
void smooth_directions(const LayerSurface& surface, std::vector<Vec3>& inwards) {
  std::vector<Vec3> next = inwards;
  for (int i = 0; i < kDirectionSmoothings; ++i) {
    parallel_for(Index(inwards.size()), [&](Index n) {
      const auto node = std::size_t(n);
      Vec3 sum = Vec3::Zero();
      for (const Index f : surface.faces_of_node.of(node))
        for (const std::int32_t other : surface.faces[std::size_t(f)])
          sum += inwards[std::size_t(other)];
      if (sum.norm() > 0.0) next[node] = sum.normalized();
    });
    std::swap(inwards, next);
  }
}

/// Turns the direction of a node towards the normal of the face to which it is most oblique, until
/// the cosine is at least kMinFaceCosine at all faces, or kMaxTurns times.
void turn_to_oblique_face(const LayerSurface& surface, std::size_t node, Vec3& inwards) {
  for (int turn = 0; turn < kMaxTurns; ++turn) {
    double min_cosine = kMinFaceCosine;
    Vec3 oblique = Vec3::Zero();
    for (const Index f : surface.faces_of_node.of(node)) {
      const Vec3 face_inwards = -surface.area_vector(f).normalized();
      if (const double cosine = face_inwards.dot(inwards); cosine < min_cosine) {
        min_cosine = cosine;
        oblique = face_inwards;
      }
    }
    if (oblique.isZero()) return;
    inwards = (inwards + kTurnFraction * oblique).normalized();
  }
}

}  // namespace

std::vector<Vec3> inward_directions(const LayerSurface& surface,
                                    const LayerConstraints& constraints) {
  std::vector<Vec3> inwards = inward_normals(surface);
  smooth_directions(surface, inwards);
  for (std::size_t n = 0; n < inwards.size(); ++n) turn_to_oblique_face(surface, n, inwards[n]);
  for (std::size_t n = 0; n < inwards.size(); ++n) {
    const Vec3 projected = constraints.project(n, inwards[n]);
    inwards[n] = projected.norm() > kMinProjectedNorm ? projected.normalized() : Vec3::Zero();
  }
  return inwards;
}

}  // namespace lefort::mesh::internal
