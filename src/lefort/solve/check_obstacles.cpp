#include <lefort/contact/contact_term.h>
#include <lefort/core/check.h>
#include <lefort/solve/check_obstacles.h>
#include <lefort/solve/prefix_error.h>

#include <fmt/format.h>

namespace lefort::solve {
namespace {

Result<void> check_distance_query(const Obstacle& obstacle,
                                  const contact::DistanceQuery& distance_query) {
  if (!distance_query.is_closed())
    return fail(
        ErrorCode::kMeshInvalid,
        fmt::format("obstacle {} is an open surface; contact needs a closed one", obstacle.name));
  if (!(obstacle.contact_snap_mm < distance_query.max_distance_mm()))
    return fail(
        ErrorCode::kInvalidArgument,
        fmt::format(
            "contact_snap_mm of obstacle {} is {:g}; it must be less than the maximum distance of "
            "its distance query, {:.2f} mm",
            obstacle.name, obstacle.contact_snap_mm, distance_query.max_distance_mm()));
  return {};
}

}  // namespace

contact::ContactTerm make_contact(
    const PreparedDeck& prepared, std::size_t i,
    const std::shared_ptr<const contact::DistanceQuery>& distance_query) {
  const Obstacle& obstacle = prepared.deck.obstacles[i];
  return {prepared.mesh.nodes_L,
          prepared.obstacle_faces[i],
          {distance_query, RigidTransform::Identity()},
          {.name = "obstacle " + obstacle.name,
           .law = prepared.obstacle_laws[i],
           .contact_snap_mm = obstacle.contact_snap_mm}};
}

Result<std::vector<std::string>> check_obstacles(const PreparedDeck& prepared,
                                                 const ObstacleDistanceQueries& distance_queries) {
  constexpr double kNegligible = 0.02;  // Of the resolution of a distance query: its error.
  LEFORT_CHECK(distance_queries.size() == prepared.deck.obstacles.size());
  std::vector<std::string> warnings;
  for (std::size_t i = 0; i < distance_queries.size(); ++i) {
    LEFORT_TRY_VOID(check_distance_query(prepared.deck.obstacles[i], *distance_queries[i]));
    const double overlap_mm = make_contact(prepared, i, distance_queries[i]).rest_penetration_mm();
    const double max_distance_mm = distance_queries[i]->max_distance_mm();
    const std::string what = fmt::format("{}: overlaps its faces by {:.3g} mm at rest",
                                         indexed("obstacles", i), overlap_mm);
    if (overlap_mm >= max_distance_mm)
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("{}; the maximum distance of its distance query is {:.3g} mm", what,
                              max_distance_mm));
    if (overlap_mm > kNegligible * distance_queries[i]->resolution_mm())
      warnings.push_back(what + " and exerts force only on further penetration");
  }
  return warnings;
}

}  // namespace lefort::solve
