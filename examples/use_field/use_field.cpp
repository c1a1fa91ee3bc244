// The distance field without the rest of lefort: how deep is a point in a box?
#include <lefort/field/build/build_distance_field.h>

#include <cstdio>

int main() {
  lefort::geometry::TriangleMesh box;  // 20 mm wide, corners counter-clockwise from outside.
  for (int corner = 0; corner < 8; ++corner)
    box.vertices.emplace_back((corner & 1) * 20.0, (corner >> 1 & 1) * 20.0, (corner >> 2) * 20.0);
  box.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                   {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  const auto field = lefort::field::build_distance_field(box, {.resolution = 128});
  if (!field) {
    std::fprintf(stderr, "%s\n", field.error().message.c_str());
    return 1;
  }
  const lefort::field::FieldSample sample = field->sample({10.0, 10.0, 19.5});
  std::printf("%.3f mm\n", sample.distance_mm);  // 0.5 mm inside.
  return sample.distance_mm < -0.49 && sample.distance_mm > -0.51 ? 0 : 1;
}
