#include <lefort/core/units.h>
#include <lefort/pipeline/json/json_values.h>
#include <lefort/pipeline/optimize/optimized_plan.h>

#include <nlohmann/json.hpp>

#include <algorithm>

namespace lefort::pipeline {

std::vector<NewMovement> movements_at(const inverse::MotionVariables& variables, const VectorX& x) {
  const std::vector<RigidTransform> X_LB = variables.poses(x);
  std::vector<NewMovement> movements;
  for (const inverse::RigidBody& body : variables.bodies()) {
    if (std::none_of(body.is_free.begin(), body.is_free.end(), [](bool free) { return free; }))
      continue;
    for (const std::size_t k : body.segments) movements.push_back({k, X_LB[k], body.center_L});
  }
  return movements;
}

std::string with_movements(const std::string& json, std::span<const NewMovement> movements) {
  auto plan = nlohmann::ordered_json::parse(json);
  for (const NewMovement& of : movements) {
    auto& segment = plan["segments"][of.segment];
    nlohmann::ordered_json path = nlohmann::ordered_json::object();
    if (segment.contains("path") && segment["path"].contains("steps"))
      path["steps"] = segment["path"]["steps"];
    const Vec3 shift = of.X_LB * of.center_L - of.center_L;
    const Vec3 turn_deg = geometry::rotation_vector(of.X_LB.linear()) * degrees_from_radians(1.0);
    path["keyframes"] = {{{"path_fraction", 1},
                          {"translation_mm", as_json(shift)},
                          {"rotation_deg", as_json(turn_deg)},
                          {"about_mm", as_json(of.center_L)}}};
    segment["path"] = std::move(path);
  }
  return plan.dump(2) + "\n";
}

}  // namespace lefort::pipeline
