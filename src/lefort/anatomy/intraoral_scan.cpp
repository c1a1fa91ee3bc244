#include <lefort/anatomy/extract_surface.h>
#include <lefort/anatomy/implicit_shapes.h>
#include <lefort/anatomy/intraoral_scan.h>
#include <lefort/core/parallel.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

namespace lefort::anatomy {
namespace {

constexpr double kGingivaDepth_mm = 1.2;   // Over bone.
constexpr double kGingivaHeight_mm = 2.5;  // Of the scan, beyond the necks.
constexpr double kBeside_mm = 2.5;         // Of the scan, beside teeth.

/// The arch where the tooth belongs, as a box in the frame of the head, from scanned_arch().
struct ArchBox {
  Box3 box_H;
  RigidTransform X_LH;
};

/// Around the crowns, in the frame of the head when the jaw is in occlusion.
ArchBox box_of_crowns(const ParametricHead& head, bool is_upper) {
  constexpr double kMargin_mm = 7.0, kAbove_mm = 2.5;
  ArchBox arch{{}, is_upper ? head.X_LH() : head.X_occlusion_L().inverse() * head.X_LH()};
  const RigidTransform X_HL = arch.X_LH.inverse();
  Box3 necks;
  for (const ToothForm& tooth : head.dentition().teeth()) {
    if (tooth.is_upper != is_upper) continue;
    arch.box_H.extend(X_HL * head.from_tooth_L(tooth, tooth.tip_M()));
    necks.extend(X_HL * head.from_tooth_L(tooth, tooth.origin_M));
  }
  Vec3 low = arch.box_H.min() - Vec3(kMargin_mm, kMargin_mm, kAbove_mm);
  Vec3 high = arch.box_H.max() + Vec3(kMargin_mm, kMargin_mm, kAbove_mm);
  if (is_upper)
    high.z() = necks.max().z() + kGingivaHeight_mm;
  else
    low.z() = necks.min().z() - kGingivaHeight_mm;
  arch.box_H = Box3(low, high);
  return arch;
}

geometry::TriangleMesh kept(const geometry::TriangleMesh& mesh,
                            const std::vector<std::uint8_t>& keep) {
  geometry::TriangleMesh result;
  std::vector<std::int32_t> number(mesh.vertices.size(), -1);
  for (std::size_t n = 0; n < mesh.triangles.size(); ++n) {
    if (keep[n] == 0) continue;
    geometry::Triangle triangle = mesh.triangles[n];
    for (auto& vertex : triangle) {
      std::int32_t& known = number[std::size_t(vertex)];
      if (known < 0) {
        known = std::int32_t(result.vertices.size());
        result.vertices.push_back(mesh.vertices[std::size_t(vertex)]);
      }
      vertex = known;
    }
    result.triangles.push_back(triangle);
  }
  return result;
}

}  // namespace

Result<geometry::TriangleMesh> scanned_arch(const ParametricHead& head, bool is_upper,
                                            double spacing_mm, double noise_mm, std::uint64_t seed,
                                            Progress& progress) {
  const auto [box_H, X_LH] = box_of_crowns(head, is_upper);
  image::Grid grid;
  grid.spacing_mm = Vec3::Constant(spacing_mm);
  grid.direction = X_LH.linear();
  grid.origin_L = X_LH * box_H.min();
  for (Index axis = 0; axis < 3; ++axis)
    grid.size[std::size_t(axis)] = Index(box_H.sizes()[axis] / spacing_mm) + 1;
  image::ScalarVolume level{grid, std::vector<float>(std::size_t(grid.voxel_count()), -1.0F)};
  const auto tooth_at = [&](const Vec3& p_L) {
    return is_upper ? head.upper_teeth(p_L).tooth : head.lower_teeth(p_L).tooth;
  };
  parallel_for(grid.size[1] * grid.size[2], [&](Index line) {
    const Index j = line % grid.size[1], k = line / grid.size[1];
    if (j == 0 || k == 0 || j + 1 == grid.size[1] || k + 1 == grid.size[2]) return;
    std::mt19937_64 bits(seed * 1000003 + std::uint64_t(line));
    for (Index i = 1; i + 1 < grid.size[0]; ++i) {
      const Vec3 p_L = grid.point_L({double(i), double(j), double(k)});
      const double bone = is_upper ? head.skull_bone(p_L) : head.mandible_bone(p_L);
      double noise = -2.0;  // Sum of four uniform numbers: nearly normal, variance 1 / 3.
      for (int n = 0; n < 4; ++n) noise += double(bits() >> 11) * 0x1p-53;
      level.at(i, j, k) = float(implicit::join(tooth_at(p_L), bone + kGingivaDepth_mm, 0.4) +
                                noise_mm * std::numbers::sqrt3 * noise);
    }
  });
  LEFORT_TRY(const geometry::TriangleMesh closed_L, extract_isosurface(level, {}, progress));
  const Vec3 low = box_H.min() + Vec3::Constant(2.0 * spacing_mm);
  const Vec3 high = box_H.max() - Vec3::Constant(2.0 * spacing_mm);
  const RigidTransform X_HL = X_LH.inverse();
  std::vector<std::uint8_t> keep(closed_L.triangles.size(), 1);
  parallel_for(Index(keep.size()), [&](Index n) {
    const Vec3 p_L = (closed_L.corner(n, 0) + closed_L.corner(n, 1) + closed_L.corner(n, 2)) / 3.0;
    const Vec3 p_H = X_HL * p_L;
    const bool is_cut = (p_H.array() < low.array()).any() || (p_H.array() > high.array()).any();
    keep[std::size_t(n)] = !is_cut && tooth_at(p_L) > -kBeside_mm ? 1 : 0;
  });
  return kept(closed_L, keep);
}

geometry::TriangleMesh scanned_bite(const ParametricHead& head,
                                    const geometry::TriangleMesh& upper_L,
                                    const geometry::TriangleMesh& lower_L) {
  constexpr double kFacing = 0.2;  // Cosine.
  const Vec3 middle_L = head.X_LH() * head.from_mean({0.0, -60.0, -50.0});
  const Vec3 up_L = head.X_LH().linear().col(2);
  geometry::TriangleMesh all = upper_L;
  const auto first = std::int32_t(upper_L.vertices.size());
  for (const Vec3& p_L : lower_L.vertices) all.vertices.push_back(head.X_occlusion_L() * p_L);
  for (const geometry::Triangle& t : lower_L.triangles)
    all.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  std::vector<std::uint8_t> keep(all.triangles.size(), 0);
  for (Index n = 0; n < Index(keep.size()); ++n) {
    const Vec3 &a = all.corner(n, 0), &b = all.corner(n, 1), &c = all.corner(n, 2);
    const Vec3 normal = (b - a).cross(c - a);
    Vec3 outward = (a + b + c) / 3.0 - middle_L;
    outward -= outward.dot(up_L) * up_L;
    keep[std::size_t(n)] = normal.dot(outward) > kFacing * normal.norm() * outward.norm() ? 1 : 0;
  }
  return kept(all, keep);
}

}  // namespace lefort::anatomy
