#include <lefort/mesh/internal/cgal_surface.h>
#include <lefort/mesh/repair_surface.h>
#include <lefort/mesh/simplify_surface.h>

#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Bounded_normal_change_filter.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Count_stop_predicate.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/GarlandHeckbert_plane_policies.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>
#include <fmt/format.h>

#include <algorithm>
#include <exception>

namespace lefort::mesh {
namespace {

namespace sms = CGAL::Surface_mesh_simplification;
using internal::CgalSurface;
using Policies = sms::GarlandHeckbert_plane_policies<CgalSurface, internal::Kernel>;

struct Cancelled {};

/// Stops at a number of edges, and when a stop is requested.
class Stop {
 public:
  Stop(std::size_t edges, Progress& progress) : edges_(edges), progress_(&progress) {}

  template <class Cost, class Profile>
  bool operator()(const Cost&, const Profile&, std::size_t initial, std::size_t current) const {
    if (current % 4096 == 0) {
      if (progress_->stop_requested()) throw Cancelled{};
      progress_->report(double(initial - current) /
                        double(initial - std::min(edges_, initial - 1)));
    }
    return current <= edges_;
  }

 private:
  std::size_t edges_;
  Progress* progress_;
};

}  // namespace

Result<geometry::TriangleMesh> simplify_surface(const geometry::TriangleMesh& surface,
                                                Index triangles, Progress& progress) {
  if (triangles < 4)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{} triangles requested, must be 4 or more", triangles));
  LEFORT_TRY(const geometry::TriangleMesh sound, repair_surface(surface));
  if (sound.triangle_count() <= triangles) return sound;
  const internal::QuietCgal quiet;
  try {
    CgalSurface mesh = internal::to_cgal(sound);
    const Policies policies(mesh);
    const auto edges = std::size_t(triangles) * 3 / 2;  // E = 3 F / 2 of a closed surface.
    sms::edge_collapse(mesh, Stop(edges, progress),
                       CGAL::parameters::get_cost(policies.get_cost())
                           .get_placement(policies.get_placement())
                           .filter(sms::Bounded_normal_change_filter<>()));
    return internal::from_cgal(mesh);
  } catch (const Cancelled&) {
    return fail(ErrorCode::kCancelled, "simplifying the surface was cancelled");
  } catch (const std::exception& error) {
    return fail(ErrorCode::kMeshingFailed,
                fmt::format("the surface cannot be simplified: {}", error.what()));
  }
}

}  // namespace lefort::mesh
