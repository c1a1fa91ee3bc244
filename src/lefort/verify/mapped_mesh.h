/// \file
/// Rings, shells and columns from mapped and welded boxes; boxes graded towards singular edges.
#pragma once

#include <lefort/core/types.h>
#include <lefort/mesh/volume_mesh.h>

#include <functional>
#include <vector>

namespace lefort::verify {

/// The mesh with all nodes moved by `map`, and with its sets. Mid-side nodes move too, so that
/// quadratic elements become curved.
/// \pre `map` preserves orientation.
[[nodiscard]] mesh::VolumeMesh mapped(mesh::VolumeMesh mesh,
                                      const std::function<Vec3(const Vec3&)>& map);

/// One mesh of all parts; nodes closer than 1e-6 mm are merged. Face sets of the same name are
/// united; node sets are dropped.
[[nodiscard]] mesh::VolumeMesh welded(const std::vector<mesh::VolumeMesh>& parts);

/// Position of the i-th corner, 0 to `cells`, as a fraction of the side: 1 - (1 - i / cells)^g.
/// \param grading  g >= 1; 1 is regular.
[[nodiscard]] double graded_corner(int i, int cells, double grading);

/// A cube with a corner at the origin and `cells` per side. Towards its sides x1, y1 and z1 the
/// cells become smaller by graded_corner(). Edges are straight; sets are those of make_box().
[[nodiscard]] mesh::VolumeMesh graded_cube(mesh::ElementShape shape, int cells, double side_mm,
                                           double grading);

/// x, y >= 0, a <= sqrt(x^2 + y^2) <= b, 0 <= z <= thickness: `cells` across the wall and twice as
/// many around, one layer. Face set "inner".
[[nodiscard]] mesh::VolumeMesh quarter_ring(mesh::ElementShape shape, int cells, double a_mm,
                                            double b_mm, double thickness_mm);

/// x, y, z >= 0, a <= |X| <= b: three blocks, each with `cells` across the wall and along its
/// sides. Face set "inner".
[[nodiscard]] mesh::VolumeMesh octant_shell(mesh::ElementShape shape, int cells, double a_mm,
                                            double b_mm);

/// sqrt(x^2 + y^2) <= radius, 0 <= z <= length: a core with four sides, `cells` from the axis to
/// its sides and as many from there to the surface, in each of four quarters; `layers` along z.
/// Face sets "z0" and "z1".
[[nodiscard]] mesh::VolumeMesh round_column(mesh::ElementShape shape, int cells, int layers,
                                            double radius_mm, double length_mm);

}  // namespace lefort::verify
