#include <lefort/core/check.h>
#include <lefort/core/parallel.h>
#include <lefort/geometry/bvh.h>
#include <lefort/predict/face_model.h>
#include <lefort/predict/tissue_boundary.h>

#include <limits>

namespace lefort::predict {

std::vector<std::vector<std::int32_t>> nodes_by_segment(const FaceModel& model,
                                                        const std::vector<std::int32_t>& nodes) {
  LEFORT_CHECK(!model.segments.empty());
  std::vector<geometry::Bvh> surfaces_B;
  for (const ContactBone& segment : model.segments) surfaces_B.emplace_back(segment.surface_B);
  std::vector<std::size_t> closest(nodes.size(), 0);
  parallel_for(std::ssize(nodes), [&](Index n) {
    const Vec3& p_L = model.tissue.nodes_L[std::size_t(nodes[std::size_t(n)])];
    double nearest_mm = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < surfaces_B.size(); ++k) {
      const double distance_mm = surfaces_B[k].closest_point(p_L)->distance_mm;
      if (!(distance_mm < nearest_mm)) continue;
      nearest_mm = distance_mm;
      closest[std::size_t(n)] = k;
    }
  });
  std::vector<std::vector<std::int32_t>> lists(model.segments.size());
  for (std::size_t n = 0; n < nodes.size(); ++n) lists[closest[n]].push_back(nodes[n]);
  return lists;
}

std::vector<std::vector<std::int32_t>> bonded_by_segment(const FaceModel& model,
                                                         TissueInterface interface) {
  if (model.interface.nodes.empty())
    return nodes_by_segment(model, nodes_with_segment(model.tissue, interface));
  std::vector<std::vector<std::int32_t>> lists(model.segments.size());
  for (const NodeInterface& one : model.interface.nodes)
    if (one.condition == InterfaceCondition::kBonded && one.bone >= 0)
      lists[std::size_t(one.bone)].push_back(one.node);
  return lists;
}

}  // namespace lefort::predict
