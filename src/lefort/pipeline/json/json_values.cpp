#include <lefort/pipeline/json/json_values.h>

namespace lefort::pipeline {

using nlohmann::json;

json as_json(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

json as_json(const RigidTransform& pose) {
  json numbers = json::array();
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) numbers.push_back(pose.matrix()(row, column));
  return numbers;
}

}  // namespace lefort::pipeline
