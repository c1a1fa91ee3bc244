#include <lefort/bench/competitors.h>

#include <openvdb/openvdb.h>
#include <openvdb/tools/Interpolation.h>
#include <openvdb/tools/MeshToVolume.h>

#include <array>
#include <cmath>
#include <vector>

namespace lefort::bench {

struct OpenVdbField::Grid {
  openvdb::FloatGrid::Ptr grid;
  Vec3 origin;
  double cell_mm;
};

OpenVdbField::OpenVdbField(const geometry::TriangleMesh& mesh, const Vec3& origin, double cell_mm,
                           double half_band_cells) {
  openvdb::initialize();
  std::vector<openvdb::Vec3s> points;
  points.reserve(mesh.vertices.size());
  for (const Vec3& v : mesh.vertices)
    points.emplace_back(float(v.x() - origin.x()), float(v.y() - origin.y()),
                        float(v.z() - origin.z()));
  std::vector<openvdb::Vec3I> triangles;
  triangles.reserve(mesh.triangles.size());
  for (const geometry::Triangle& t : mesh.triangles)
    triangles.emplace_back(unsigned(t[0]), unsigned(t[1]), unsigned(t[2]));
  const auto transform = openvdb::math::Transform::createLinearTransform(cell_mm);
  grid_ = std::make_unique<Grid>(
      Grid{openvdb::tools::meshToSignedDistanceField<openvdb::FloatGrid>(
               *transform, points, triangles, {}, float(half_band_cells), float(half_band_cells)),
           origin, cell_mm});
}

OpenVdbField::~OpenVdbField() = default;

std::size_t OpenVdbField::bytes() const { return grid_->grid->memUsage(); }

void OpenVdbField::distances(std::span<const Vec3> points, std::span<double> distances_mm) const {
  const auto accessor = grid_->grid->getConstAccessor();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 u = (points[i] - grid_->origin) / grid_->cell_mm;
    distances_mm[i] =
        double(openvdb::tools::BoxSampler::sample(accessor, openvdb::Vec3R(u.x(), u.y(), u.z())));
  }
}

void OpenVdbField::gradients(std::span<const Vec3> points, std::span<double> distances_mm,
                             std::span<Vec3> gradients) const {
  const auto accessor = grid_->grid->getConstAccessor();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 u = (points[i] - grid_->origin) / grid_->cell_mm;
    const openvdb::Coord low(int(std::floor(u.x())), int(std::floor(u.y())),
                             int(std::floor(u.z())));
    const float x = float(u.x() - low.x()), y = float(u.y() - low.y()), z = float(u.z() - low.z());
    std::array<float, 8> c{};
    for (int corner = 0; corner < 8; ++corner)
      c[std::size_t(corner)] =
          accessor.getValue(low.offsetBy(corner & 1, corner >> 1 & 1, corner >> 2));
    const auto mix = [](float t, float a, float b) { return a + t * (b - a); };
    const float x00 = mix(x, c[0], c[1]), x10 = mix(x, c[2], c[3]), x01 = mix(x, c[4], c[5]),
                x11 = mix(x, c[6], c[7]);
    distances_mm[i] = double(mix(z, mix(y, x00, x10), mix(y, x01, x11)));
    gradients[i] =
        Vec3(double(mix(z, mix(y, c[1] - c[0], c[3] - c[2]), mix(y, c[5] - c[4], c[7] - c[6]))),
             double(mix(z, x10 - x00, x11 - x01)), double(mix(y, x01, x11) - mix(y, x00, x10))) /
        grid_->cell_mm;
  }
}

}  // namespace lefort::bench
