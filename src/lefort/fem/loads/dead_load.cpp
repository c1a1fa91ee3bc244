#include <lefort/core/check.h>
#include <lefort/fem/elements/all_elements.h>
#include <lefort/fem/elements/reference_element.h>
#include <lefort/fem/faces/all_faces.h>
#include <lefort/fem/loads/dead_load.h>
#include <lefort/fem/loads/validate_load_faces.h>

#include <fmt/format.h>

#include <algorithm>

namespace lefort::fem {
namespace {

/// Sums of forces by node.
using ForceOfNode = std::map<std::int32_t, Vec3>;

std::vector<NodalForce> in_order(const ForceOfNode& forces) {
  std::vector<NodalForce> list;
  list.reserve(forces.size());
  for (const auto& [node, force_n] : forces) list.push_back({node, force_n});
  return list;
}

void add(ForceOfNode& forces, std::int32_t node, const Vec3& force_n) {
  forces.try_emplace(node, Vec3::Zero()).first->second += force_n;
}

template <class Shape>
void add_traction(const mesh::Face& face, std::span<const Vec3> nodes_L, const Vec3& traction_mpa,
                  ForceOfNode& forces) {
  const FaceNodes<Shape> X = face_nodes<Shape>(face, nodes_L);
  for (const auto& point : Shape::quadrature()) {
    const double dA = area_vector_mm2(tangents<Shape>(X, point), point.weight).norm();
    for (int a = 0; a < Shape::kNodes; ++a)
      add(forces, face.nodes[std::size_t(a)], point.N[a] * dA * traction_mpa);
  }
}

/// \returns false if the element has no positive volume.
template <class Element>
bool add_body_force(const mesh::VolumeMesh& mesh, const std::int32_t* nodes, const Vec3& b,
                    ForceOfNode& forces) {
  ElementNodes<Element> X;
  for (int a = 0; a < Element::kNodes; ++a) X.col(a) = mesh.nodes_L[std::size_t(nodes[a])];
  const auto points = reference_element<Element>(X);
  if (!points) return false;
  const auto quadrature = Element::quadrature();
  for (std::size_t q = 0; q < points->size(); ++q)
    for (int a = 0; a < Element::kNodes; ++a)
      add(forces, nodes[a], quadrature[q].N[a] * (*points)[q].volume_mm3 * b);
  return true;
}

}  // namespace

Result<std::vector<NodalForce>> traction_forces(std::span<const Vec3> nodes_L,
                                                std::span<const mesh::Face> faces,
                                                const Vec3& traction_mpa) {
  if (!traction_mpa.allFinite())
    return fail(ErrorCode::kInvalidArgument, "traction: a component is not finite");
  LEFORT_TRY_VOID(validate_load_faces(nodes_L, faces));
  ForceOfNode forces;
  for (const mesh::Face& face : faces)
    std::visit([&]<class Shape>(
                   const Shape&) { add_traction<Shape>(face, nodes_L, traction_mpa, forces); },
               face_of(face.shape));
  return in_order(forces);
}

Result<std::vector<NodalForce>> body_forces(const mesh::VolumeMesh& mesh,
                                            const RegionBodyForces& body_forces) {
  for (const auto& [region, force] : body_forces) {
    if (!force.allFinite())
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("body force of region {}: a component is not finite", region));
    const bool occurs = std::ranges::any_of(mesh.blocks, [&](const mesh::ElementBlock& block) {
      return std::ranges::find(block.region, region) != block.region.end();
    });
    if (!occurs)
      return fail(
          ErrorCode::kInvalidArgument,
          fmt::format("body force of region {}: the volume mesh has no such region", region));
  }
  ForceOfNode forces;
  Index number = 0;
  for (const mesh::ElementBlock& block : mesh.blocks)
    for (Index e = 0; e < block.element_count(); ++e, ++number) {
      const auto force = body_forces.find(block.region[std::size_t(e)]);
      if (force == body_forces.end()) continue;
      const bool has_volume = std::visit(
          [&]<class Element>(const Element&) {
            return add_body_force<Element>(mesh, block.element(e), force->second, forces);
          },
          element_of(block.shape));
      if (!has_volume)
        return fail(ErrorCode::kElementInverted,
                    fmt::format("element {} is flat or inverted, its volume must be > 0", number));
    }
  return in_order(forces);
}

DeadLoad::DeadLoad(std::span<const Vec3> nodes_L, std::span<const NodalForce> forces) {
  for (const NodalForce& force : forces) {
    LEFORT_CHECK(force.node >= 0 && std::size_t(force.node) < nodes_L.size());
    nodes_.push_back(force.node);
    reference_L_.push_back(nodes_L[std::size_t(force.node)]);
    force_n_.push_back(force.force_n);
  }
}

bool DeadLoad::evaluate(Index item, std::span<const Vec3> x_L, LocalEquations& local) const {
  const Vec3 force_n = factor_ * force_n_[std::size_t(item)];
  local.energy_mj = -force_n.dot(x_L[0] - reference_L_[std::size_t(item)]);
  local.residual_n = -force_n;
  return true;
}

}  // namespace lefort::fem
