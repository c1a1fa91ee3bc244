#include <lefort/geometry/triangle_mesh.h>
#include <lefort/io/surface_files.h>
#include <lefort/mesh/boundary_faces.h>
#include <lefort/pipeline/prepare/interface_surface.h>
#include <lefort/predict/interface_map.h>

#include <cstdint>
#include <vector>

namespace lefort::pipeline {

Result<void> write_interface_surface(const std::filesystem::path& file,
                                     const predict::FaceModel& model) {
  geometry::TriangleMesh surface_L;
  std::vector<double> conditions, rules;
  std::vector<std::int32_t> vertex_of(model.tissue.nodes_L.size(), -1);
  for (const predict::NodeInterface& one : model.interface.nodes) {
    vertex_of[std::size_t(one.node)] = std::int32_t(surface_L.vertices.size());
    surface_L.vertices.push_back(model.tissue.nodes_L[std::size_t(one.node)]);
    conditions.push_back(double(one.condition));
    rules.push_back(double(one.rule));
  }
  for (mesh::Face3 face : mesh::triangles_of(model.tissue.face_sets.at("boundary"))) {
    for (std::int32_t& node : face) node = vertex_of[std::size_t(node)];
    surface_L.triangles.push_back(face);
  }
  return io::write_surface(file, surface_L, {{kConditionArray, conditions}, {kRuleArray, rules}});
}

}  // namespace lefort::pipeline
