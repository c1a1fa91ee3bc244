#include <lefort/pipeline/json/json_values.h>

namespace lefort::pipeline {

nlohmann::json as_json(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

nlohmann::json as_json(const RigidTransform& pose) {
  nlohmann::json numbers = nlohmann::json::array();
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) numbers.push_back(pose.matrix()(row, column));
  return numbers;
}

nlohmann::json as_json(const std::vector<plan::Fragment>& fragments) {
  nlohmann::json list = nlohmann::json::array();
  for (const plan::Fragment& one : fragments)
    list.push_back({{"volume_ml", one.volume_mm3 * 1e-3},
                    {"center_mm", as_json(one.center_L)},
                    {"owner", plan::name_of(one.owner)},
                    {"is_within_cut", one.is_within_cut}});
  return list;
}

}  // namespace lefort::pipeline
