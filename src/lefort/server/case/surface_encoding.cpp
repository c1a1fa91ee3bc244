#include <lefort/server/case/surface_encoding.h>

#include <bit>
#include <cstdint>
#include <cstring>

namespace lefort::server {
namespace {

static_assert(std::endian::native == std::endian::little);

template <class Number>
void append(std::string& bytes, Number number) {
  bytes.append(reinterpret_cast<const char*>(&number), sizeof(number));
}

}  // namespace

std::string encode_surface(const geometry::TriangleMesh& mesh_L,
                           std::span<const std::vector<double>> scalars) {
  std::string bytes;
  bytes.reserve(20 + 12 * (mesh_L.vertices.size() + mesh_L.triangles.size()) +
                4 * scalars.size() * mesh_L.vertices.size());
  bytes.append("LFSURF1\0", 8);
  append(bytes, std::uint32_t(mesh_L.vertex_count()));
  append(bytes, std::uint32_t(mesh_L.triangle_count()));
  append(bytes, std::uint32_t(scalars.size()));
  bytes += encode_floats(mesh_L.vertices);
  for (const geometry::Triangle& triangle : mesh_L.triangles)
    for (const std::int32_t vertex : triangle) append(bytes, std::uint32_t(vertex));
  for (const std::vector<double>& array : scalars) bytes += encode_floats(array);
  return bytes;
}

std::string encode_floats(std::span<const Vec3> vectors) {
  std::string bytes;
  bytes.reserve(12 * vectors.size());
  for (const Vec3& v : vectors)
    for (int k = 0; k < 3; ++k) append(bytes, float(v[k]));
  return bytes;
}

std::string encode_floats(std::span<const double> numbers) {
  std::string bytes;
  bytes.reserve(4 * numbers.size());
  for (const double number : numbers) append(bytes, float(number));
  return bytes;
}

}  // namespace lefort::server
