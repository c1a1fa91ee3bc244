#include <lefort/fem/assembly/boundary_conditions.h>

namespace lefort::fem {

std::vector<PrescribedDisplacement> prescribe_zero(std::span<const std::int32_t> nodes) {
  std::vector<PrescribedDisplacement> prescribed;
  prescribed.reserve(3 * nodes.size());
  for (const std::int32_t node : nodes)
    for (int component = 0; component < 3; ++component)
      prescribed.push_back({.node = node, .component = component});
  return prescribed;
}

std::vector<PrescribedDisplacement> prescribe_rigid_motion(std::span<const std::int32_t> nodes,
                                                           std::span<const Vec3> nodes_L,
                                                           const RigidTransform& motion_LL) {
  std::vector<PrescribedDisplacement> prescribed;
  prescribed.reserve(3 * nodes.size());
  for (const std::int32_t node : nodes) {
    const Vec3& X_L = nodes_L[std::size_t(node)];
    const Vec3 displacement = motion_LL * X_L - X_L;
    for (int component = 0; component < 3; ++component)
      prescribed.push_back(
          {.node = node, .component = component, .displacement_mm = displacement[component]});
  }
  return prescribed;
}

}  // namespace lefort::fem
