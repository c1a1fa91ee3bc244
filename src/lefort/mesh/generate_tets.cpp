#include <lefort/mesh/collapse_edges.h>
#include <lefort/mesh/element_quality.h>
#include <lefort/mesh/generate_tets.h>
#include <lefort/mesh/improve_tets.h>
#include <lefort/mesh/internal/cgal_surface.h>
#include <lefort/mesh/largest_face_connected_part.h>
#include <lefort/mesh/snap_boundary_to_level.h>

#include <CGAL/Labeled_mesh_domain_3.h>
#include <CGAL/Mesh_complex_3_in_triangulation_3.h>
#include <CGAL/Mesh_criteria_3.h>
#include <CGAL/Mesh_triangulation_3.h>
#include <CGAL/exude_mesh_3.h>
#include <CGAL/perturb_mesh_3.h>
#include <CGAL/refine_mesh_3.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <unordered_map>

namespace lefort::mesh {
namespace {

using Kernel = internal::Kernel;
using Point = Kernel::Point_3;
using Domain = CGAL::Labeled_mesh_domain_3<Kernel>;
using Triangulation = CGAL::Mesh_triangulation_3<Domain, CGAL::Default, CGAL::Sequential_tag>::type;
using Complex = CGAL::Mesh_complex_3_in_triangulation_3<Triangulation>;
using Criteria = CGAL::Mesh_criteria_3<Triangulation>;

// Fraction of the tissue's volume that may be disconnected and omitted.
constexpr double kMaxDropped = 0.05;

// Limit the memory that wrong options can request.
constexpr std::size_t kMaxNodes = 4'000'000;
constexpr std::size_t kMaxCells = 30'000'000;

/// Accuracy of CGAL's surface points, as a fraction of level_tolerance_mm.
constexpr double kBisection = 0.1;

/// Thrown through CGAL, which has no other way to stop between two of its steps.
struct Stopped {};

/// Whether a point is inside; checks regularly whether the user requests a stop.
class Inside {
 public:
  Inside(const std::function<double(const Vec3&)>& level_set_L, const Box3& box_L,
         const Progress& progress)
      : level_L_(&level_set_L), box_L_(box_L), progress_(&progress) {}

  bool operator()(const Vec3& p_L) const {
    constexpr std::uint32_t kCallsPerCheck = 1024;
    if (++calls_ % kCallsPerCheck == 0 && progress_->stop_requested()) throw Stopped();
    return box_L_.contains(p_L) && (*level_L_)(p_L) > 0.0;
  }

 private:
  const std::function<double(const Vec3&)>* level_L_;
  Box3 box_L_;
  const Progress* progress_;
  mutable std::uint32_t calls_ = 0;
};

Vec3 to_vec(const Point& p) { return {p.x(), p.y(), p.z()}; }
Point to_point(const Vec3& p) { return {p.x(), p.y(), p.z()}; }

/// \returns surface points between inside and outside nodes of a grid, about one per cube of three
/// cells, so that refinement starts on every part that the grid resolves.
std::vector<Vec3> find_surface_points(const Inside& inside, const Box3& box_L, double spacing_mm,
                                      double tolerance_mm) {
  const Vec3 sizes = box_L.sizes();
  const auto cells = [&](int axis) { return Index(std::ceil(sizes[axis] / spacing_mm)); };
  const std::array<Index, 3> count{cells(0) + 1, cells(1) + 1, cells(2) + 1};
  const auto node_L = [&](Index i, Index j, Index k) {
    return Vec3(box_L.min() + spacing_mm * Vec3(double(i), double(j), double(k)));
  };
  std::vector<char> is_in(std::size_t(count[0] * count[1] * count[2]));
  const auto offset = [&](Index i, Index j, Index k) {
    return std::size_t(i + count[0] * (j + count[1] * k));
  };
  std::vector<Vec3> points;
  std::set<std::array<Index, 3>> taken;
  for (Index k = 0; k < count[2]; ++k)
    for (Index j = 0; j < count[1]; ++j)
      for (Index i = 0; i < count[0]; ++i) {
        is_in[offset(i, j, k)] = inside(node_L(i, j, k));
        for (int axis = 0; axis < 3; ++axis) {
          const Index di = axis == 0, dj = axis == 1, dk = axis == 2;
          if (i < di || j < dj || k < dk) continue;
          if (is_in[offset(i, j, k)] == is_in[offset(i - di, j - dj, k - dk)]) continue;
          if (!taken.insert({i / 3, j / 3, k / 3}).second) continue;
          Vec3 in = node_L(i, j, k), out = node_L(i - di, j - dj, k - dk);
          if (!is_in[offset(i, j, k)]) std::swap(in, out);
          while ((out - in).norm() > tolerance_mm) {
            const Vec3 middle = 0.5 * (in + out);
            (inside(middle) ? in : out) = middle;
          }
          points.push_back(in);
        }
      }
  return points;
}

/// The size field for CGAL: bound of the circumradius.
struct SizeField {
  using FT = double;
  using Point_3 = Point;
  using Index = Domain::Index;
  const TetOptions* options;

  FT operator()(const Point& p, int /*dimension*/, const Index& /*index*/) const {
    constexpr double kMinSizeFraction = 0.02;  // Of element_size_mm.
    const double max_mm = options->element_size_mm;
    if (!options->size_at_mm) return max_mm;
    const double size_mm = options->size_at_mm(to_vec(p));
    return size_mm < max_mm ? std::max(size_mm, kMinSizeFraction * max_mm) : max_mm;
  }
};

VolumeMesh to_volume_mesh(const Complex& complex) {
  VolumeMesh mesh;
  ElementBlock& block = mesh.blocks.emplace_back();
  std::unordered_map<Triangulation::Vertex_handle, std::int32_t> number;
  const auto number_of = [&](Triangulation::Vertex_handle v) {
    const auto [entry, is_new] = number.try_emplace(v, std::int32_t(mesh.nodes_L.size()));
    if (is_new) mesh.nodes_L.push_back(to_vec(v->point().point()));
    return entry->second;
  };
  for (auto c = complex.cells_in_complex_begin(); c != complex.cells_in_complex_end(); ++c) {
    for (int corner = 0; corner < 4; ++corner) block.nodes.push_back(number_of(c->vertex(corner)));
    block.region.push_back(0);
  }
  return mesh;
}

Result<void> check(const Box3& box_L, const TetOptions& options) {
  const auto within = [](const char* name, double value, double low, double high) -> Result<void> {
    if (value >= low && value <= high) return {};
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{} is {}, must be {} to {}", name, value, low, high));
  };
  constexpr double kMaxCoordinate_mm = 1e5;
  if (box_L.isEmpty() || !(box_L.sizes().minCoeff() > 0.0) ||
      !(box_L.min().minCoeff() >= -kMaxCoordinate_mm &&
        box_L.max().maxCoeff() <= kMaxCoordinate_mm))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("the box to mesh in must have a volume and lie within {} mm of the "
                            "origin",
                            kMaxCoordinate_mm));
  const double min_size_mm = std::cbrt(box_L.volume() / double(kMaxCells));
  const double max_size_mm = box_L.sizes().maxCoeff();
  LEFORT_TRY_VOID(within("element_size_mm", options.element_size_mm, min_size_mm, max_size_mm));
  LEFORT_TRY_VOID(within("surface_distance_mm", options.surface_distance_mm,
                         1e-3 * options.element_size_mm, max_size_mm));
  LEFORT_TRY_VOID(within("facet_angle_deg", options.facet_angle_deg, 0.0, 30.0));
  LEFORT_TRY_VOID(within("cell_radius_edge", options.cell_radius_edge, 2.0, 100.0));
  LEFORT_TRY_VOID(within("sliver_angle_deg", options.sliver_angle_deg, 0.0, 20.0));
  LEFORT_TRY_VOID(within("min_scaled_jacobian", options.min_scaled_jacobian, 0.0, 0.5));
  return within("level_tolerance_mm", options.level_tolerance_mm, 1e-6, max_size_mm);
}

Domain make_domain(const Inside& inside, const Box3& box_L, const TetOptions& options) {
  // CGAL evaluates points of its own box only, so the sides of this box must be outside.
  const Vec3 margin_mm = Vec3::Constant(options.element_size_mm);
  const Vec3 low = box_L.min() - margin_mm, high = box_L.max() + margin_mm;
  const double error_mm = kBisection * options.level_tolerance_mm;
  return Domain([inside](const Point& p) { return inside(to_vec(p)) ? 1 : 0; },
                Kernel::Iso_cuboid_3(to_point(low), to_point(high)),
                2.0 * error_mm / (high - low).norm());  // Relative error bound, of the box radius.
}

Complex start_from(const std::vector<Vec3>& points_L, const Domain& domain) {
  Complex complex;
  for (const Vec3& p_L : points_L) {
    const auto v = complex.triangulation().insert(Triangulation::Weighted_point(to_point(p_L)));
    complex.set_dimension(v, 2);
    complex.set_index(v, domain.index_from_surface_patch_index({0, 1}));
  }
  return complex;
}

/// Delaunay refinement. \returns false if the mesh exceeds kMaxNodes.
bool refine(Complex& complex, const Domain& domain, const TetOptions& options) {
  namespace p = CGAL::parameters;
  const SizeField size{&options};
  const Criteria criteria(p::facet_angle = options.facet_angle_deg, p::facet_size = size,
                          p::facet_distance = options.surface_distance_mm,
                          p::cell_radius_edge_ratio = options.cell_radius_edge,
                          p::cell_size = size);
  CGAL::Mesh_error_code error = CGAL::CGAL_MESH_3_NO_ERROR;
  CGAL::refine_mesh_3(complex, domain, criteria, p::no_perturb(), p::no_exude(), p::no_reset_c3t3(),
                      p::manifold(),
                      p::mesh_3_options(p::maximal_number_of_vertices = kMaxNodes,
                                        p::pointer_to_error_code = &error));
  return error == CGAL::CGAL_MESH_3_NO_ERROR;
}

/// Perturbs only the worst slivers: for the others improve_tets() does as well in a tenth of the
/// time. There are no time limits, because the mesh would depend on the load of the machine.
void remove_slivers(Complex& complex, const Domain& domain, double angle_deg) {
  namespace p = CGAL::parameters;
  CGAL::perturb_mesh_3(complex, domain, p::time_limit = 0.0, p::sliver_bound = angle_deg / 3.0);
  CGAL::exude_mesh_3(complex, p::time_limit = 0.0, p::sliver_bound = angle_deg);
}

double volume_mm3(const VolumeMesh& mesh) {
  const ElementBlock& block = mesh.blocks[0];
  double sum_mm3 = 0.0;
  for (Index e = 0; e < block.element_count(); ++e) {
    const auto p = [&](int n) { return mesh.nodes_L[std::size_t(block.element(e)[n])]; };
    sum_mm3 += std::abs((p(1) - p(0)).cross(p(2) - p(0)).dot(p(3) - p(0))) / 6.0;
  }
  return sum_mm3;
}

/// Reports the omitted volume; fails if it exceeds kMaxDropped.
Result<void> check_dropped(double all_mm3, double kept_mm3, Progress& progress) {
  const double dropped_mm3 = all_mm3 - kept_mm3;
  if (!(dropped_mm3 > 0.0)) return {};
  const std::string dropped =
      fmt::format("{:.3g} ml of {:.3g} ml of tissue ({:.2g} %) are not connected to the rest",
                  dropped_mm3 * 1e-3, all_mm3 * 1e-3, 100.0 * dropped_mm3 / all_mm3);
  if (dropped_mm3 > kMaxDropped * all_mm3)
    return fail(ErrorCode::kMeshingFailed,
                fmt::format("{}, expected at most {} %", dropped, 100.0 * kMaxDropped));
  progress.note(dropped + " and are omitted from the mesh");
  return {};
}

Result<VolumeMesh> fill(const Inside& inside, const Box3& box_L, const TetOptions& options,
                        Progress& progress) {
  progress.report(0.0);
  CGAL::get_default_random() =
      CGAL::Random(0);  // The mesh must not depend on earlier uses of CGAL.
  const std::vector<Vec3> start_L = find_surface_points(inside, box_L, options.element_size_mm,
                                                        kBisection * options.level_tolerance_mm);
  if (start_L.size() < 4)
    return fail(ErrorCode::kMeshingFailed,
                fmt::format("the tissue's surface crosses a grid of {} mm at {} points, must be 4 "
                            "or more",
                            options.element_size_mm, start_L.size()));
  progress.report(0.05);
  const Domain domain = make_domain(inside, box_L, options);
  Complex complex = start_from(start_L, domain);
  if (!refine(complex, domain, options))
    return fail(ErrorCode::kMeshingFailed,
                fmt::format("the mesh would have more than {} nodes, must have fewer", kMaxNodes));
  if (complex.number_of_cells_in_complex() == 0)
    return fail(ErrorCode::kMeshingFailed, "the tissue is too thin for the element size");
  progress.report(0.5);
  if (options.sliver_angle_deg > 0.0) remove_slivers(complex, domain, options.sliver_angle_deg);
  progress.report(0.7);

  const double tolerance_mm = kBisection * options.level_tolerance_mm;
  const VolumeMesh all = to_volume_mesh(complex);
  VolumeMesh mesh = largest_face_connected_part(all);
  LEFORT_TRY_VOID(check_dropped(volume_mm3(all), volume_mm3(mesh), progress));
  const Index off_surface =
      snap_boundary_to_level(mesh, inside, options.element_size_mm, tolerance_mm);
  if (off_surface > 0)
    progress.note(
        fmt::format("{} nodes are not on the surface, to avoid flattened elements", off_surface));
  progress.report(0.8);
  ImproveOptions improvement{.angle_deg = options.sliver_angle_deg, .tolerance_mm = tolerance_mm};
  improve_tets(mesh, inside, improvement);
  improvement.with_jacobian = true;
  constexpr int kMaxRounds = 4;
  for (int round = 0; options.min_scaled_jacobian > 0.0 && round < kMaxRounds; ++round) {
    if (collapse_edges(mesh, options.min_scaled_jacobian) == 0) break;
    improve_tets(mesh, inside, improvement);
  }
  return mesh;
}

}  // namespace

Result<VolumeMesh> generate_tets(const std::function<double(const Vec3&)>& level_set_L,
                                 const Box3& box_L, const TetOptions& options, Progress& progress) {
  LEFORT_TRY_VOID(check(box_L, options));
  const internal::QuietCgal quiet;
  try {
    LEFORT_TRY(VolumeMesh mesh, fill({level_set_L, box_L, progress}, box_L, options, progress));
    if (const MeshQuality quality = measure_quality(mesh); !quality.inverted.empty())
      return fail(ErrorCode::kMeshingFailed,
                  fmt::format("{} of {} elements are inverted or have no volume",
                              quality.inverted.size(), quality.elements));
    progress.report(1.0);
    return mesh;
  } catch (const Stopped&) {
    return fail(ErrorCode::kCancelled, "meshing was cancelled");
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::kMeshingFailed, "meshing needs more memory than available");
  } catch (const CGAL::Failure_exception& error) {
    return fail(ErrorCode::kMeshingFailed,
                fmt::format("the tissue cannot be meshed: {}", error.message()));
  }
}

}  // namespace lefort::mesh
