#include <lefort/pipeline/json/json_values.h>

namespace lefort::pipeline {

nlohmann::json as_json(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

nlohmann::json as_json(const RigidTransform& pose) {
  nlohmann::json numbers = nlohmann::json::array();
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) numbers.push_back(pose.matrix()(row, column));
  return numbers;
}

}  // namespace lefort::pipeline
