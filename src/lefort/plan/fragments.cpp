#include <lefort/geometry/bvh.h>
#include <lefort/geometry/mesh_properties.h>
#include <lefort/mesh/stitch_surfaces.h>
#include <lefort/plan/fragments.h>

#include <algorithm>
#include <array>
#include <limits>
#include <set>

namespace lefort::plan {
namespace {

using geometry::TriangleMesh;
using Position = std::array<double, 3>;
using Positions = std::set<Position>;

Position position_of(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

void add_positions(Positions& to, const TriangleMesh& mesh) {
  for (const Vec3& v : mesh.vertices) to.insert(position_of(v));
}

bool touches(const TriangleMesh& mesh, const Positions& positions) {
  return std::any_of(mesh.vertices.begin(), mesh.vertices.end(),
                     [&](const Vec3& v) { return positions.count(position_of(v)) > 0; });
}

/// Area of the triangles with all corners at these positions: the shared faces of a cut.
double shared_area_mm2(const TriangleMesh& mesh, const Positions& positions) {
  double area_mm2 = 0.0;
  for (Index t = 0; t < mesh.triangle_count(); ++t) {
    bool is_shared = true;
    for (int c = 0; c < 3; ++c)
      is_shared = is_shared && positions.count(position_of(mesh.corner(t, c))) > 0;
    if (!is_shared) continue;
    const Vec3 &p = mesh.corner(t, 0), &q = mesh.corner(t, 1), &r = mesh.corner(t, 2);
    area_mm2 += 0.5 * (q - p).cross(r - p).norm();
  }
  return area_mm2;
}

Fragment fragment_of(const TriangleMesh& surface, double volume_mm3, bool is_within_cut) {
  Fragment fragment;
  fragment.volume_mm3 = volume_mm3;
  for (const Vec3& v : surface.vertices) fragment.center_L += v;
  fragment.center_L /= double(surface.vertices.size());
  fragment.is_within_cut = is_within_cut;
  fragment.surface_L = surface;
  return fragment;
}

double distance_mm(const geometry::Bvh& tree, const TriangleMesh& from) {
  double nearest_mm = std::numeric_limits<double>::infinity();
  for (const Vec3& v : from.vertices)
    if (const auto closest = tree.closest_point(v, nearest_mm))
      nearest_mm = std::min(nearest_mm, closest->distance_mm);
  return nearest_mm;
}

/// Owners of the pieces within the cut.
std::vector<Fragment> fragments_within(const CutSides& sides, double min_piece_mm3) {
  std::vector<Fragment> fragments;
  if (sides.within.empty()) return fragments;
  Positions outside;
  add_positions(outside, sides.outside_L);
  std::vector<std::size_t> small;
  for (const BoneBody& body : sides.within) {
    if (!touches(body.surface, outside) && body.outer_volume_mm3 < min_piece_mm3)
      small.push_back(fragments.size());
    fragments.push_back(fragment_of(body.surface, body.volume_mm3, true));
  }
  if (small.empty()) return fragments;
  const geometry::Bvh segment(sides.segment_L), rest(sides.outside_L);
  for (const std::size_t n : small) {
    Fragment& one = fragments[n];
    if (one.volume_mm3 < kMinFragment_mm3)
      one.owner = FragmentOwner::kNone;
    else if (distance_mm(segment, one.surface_L) < distance_mm(rest, one.surface_L))
      one.owner = FragmentOwner::kSegment;
  }
  return fragments;
}

/// Volume and box of each component of a surface.
struct Shells {
  geometry::Components of;
  std::vector<double> volumes_mm3;
  std::vector<Box3> boxes;
};

Shells shells_of(const TriangleMesh& mesh) {
  Shells shells{geometry::connected_components(mesh), {}, {}};
  shells.volumes_mm3.resize(std::size_t(shells.of.count), 0.0);
  shells.boxes.resize(std::size_t(shells.of.count));
  const Vec3 origin = mesh.vertices.empty() ? Vec3(Vec3::Zero()) : mesh.vertices.front();
  for (Index t = 0; t < mesh.triangle_count(); ++t) {
    const auto shell = std::size_t(shells.of.of_triangle[std::size_t(t)]);
    const Vec3 a = mesh.corner(t, 0) - origin, b = mesh.corner(t, 1) - origin,
               c = mesh.corner(t, 2) - origin;
    shells.volumes_mm3[shell] += a.dot(b.cross(c)) / 6.0;
    for (int corner = 0; corner < 3; ++corner) shells.boxes[shell].extend(mesh.corner(t, corner));
  }
  return shells;
}

bool has_cavity(const Shells& shells, std::size_t shell) {
  for (std::size_t other = 0; other < shells.boxes.size(); ++other)
    if (shells.volumes_mm3[other] < 0.0 && shells.boxes[shell].contains(shells.boxes[other]))
      return true;
  return false;
}

/// Takes the pieces that only the segment holds out of the bone outside the cut.
std::vector<Fragment> take_fragments_outside(CutSides& sides, double min_piece_mm3) {
  const Shells shells = shells_of(sides.outside_L);
  std::vector<bool> is_taken(shells.volumes_mm3.size(), false);
  std::vector<Fragment> fragments;
  Positions of_segment, of_others;
  for (std::size_t s = 0; s < shells.volumes_mm3.size(); ++s) {
    const double volume_mm3 = shells.volumes_mm3[s];
    if (!(volume_mm3 > 0.0 && volume_mm3 < min_piece_mm3) || has_cavity(shells, s)) continue;
    if (of_segment.empty()) {
      add_positions(of_segment, sides.segment_L);
      for (const BoneBody& body : sides.within) add_positions(of_others, body.surface);
    }
    const TriangleMesh surface = geometry::keep_triangles(sides.outside_L, [&](Index t) {
      return std::size_t(shells.of.of_triangle[std::size_t(t)]) == s;
    });
    const double at_segment_mm2 = shared_area_mm2(surface, of_segment);
    if (at_segment_mm2 == 0.0 || at_segment_mm2 <= shared_area_mm2(surface, of_others)) continue;
    is_taken[s] = true;
    fragments.push_back(fragment_of(surface, volume_mm3, false));
    fragments.back().owner = FragmentOwner::kSegment;
  }
  if (fragments.empty()) return fragments;
  sides.outside_L = geometry::keep_triangles(sides.outside_L, [&](Index t) {
    return !is_taken[std::size_t(shells.of.of_triangle[std::size_t(t)])];
  });
  return fragments;
}

}  // namespace

const char* name_of(FragmentOwner owner) {
  switch (owner) {
    case FragmentOwner::kRemainder:
      return "remainder";
    case FragmentOwner::kSegment:
      return "segment";
    case FragmentOwner::kNone:
      return "none";
  }
  return "none";
}

TriangleMesh joined(const TriangleMesh& a, const TriangleMesh& b) {
  if (b.triangles.empty()) return a;
  if (a.triangles.empty()) return b;
  TriangleMesh together = mesh::stitch_surfaces(a, b);
  if (geometry::is_closed(together)) return together;
  together = a;
  append(together, b);
  return together;
}

OwnedBone assign_fragments(CutSides sides, double min_piece_mm3) {
  OwnedBone bone;
  bone.fragments = fragments_within(sides, min_piece_mm3);
  for (Fragment& one : take_fragments_outside(sides, min_piece_mm3))
    bone.fragments.push_back(std::move(one));
  bone.segment_L = std::move(sides.segment_L);
  bone.remainder_L = std::move(sides.outside_L);
  for (const Fragment& one : bone.fragments) {
    if (one.owner == FragmentOwner::kNone) bone.left_out_mm3 += one.volume_mm3;
    if (one.owner == FragmentOwner::kSegment)
      bone.segment_L = joined(bone.segment_L, one.surface_L);
    if (one.owner == FragmentOwner::kRemainder)
      bone.remainder_L = joined(bone.remainder_L, one.surface_L);
  }
  return bone;
}

}  // namespace lefort::plan
