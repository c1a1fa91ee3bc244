#include <lefort/contact/contact_term.h>
#include <lefort/core/check.h>
#include <lefort/solve/about_key.h>
#include <lefort/solve/check_obstacles.h>

#include <fmt/format.h>

namespace lefort::solve {
namespace {

Result<void> check_detector(const Obstacle& obstacle, const contact::Detector& detector) {
  if (!detector.is_closed())
    return fail(
        ErrorCode::kMeshInvalid,
        fmt::format("obstacle {} is an open surface, contact needs a closed one", obstacle.name));
  if (!(obstacle.capture_mm < detector.reach_mm()))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("capture_mm of obstacle {} is {:g}, must be less than the {:.2f} mm "
                            "that its field reaches",
                            obstacle.name, obstacle.capture_mm, detector.reach_mm()));
  return {};
}

}  // namespace

contact::ContactTerm make_contact(const PreparedDeck& prepared, std::size_t i,
                                  const std::shared_ptr<const contact::Detector>& detector) {
  const Obstacle& obstacle = prepared.deck.obstacles[i];
  return {prepared.mesh.nodes_L,
          prepared.obstacle_faces[i],
          {detector, RigidTransform::Identity()},
          {.name = "obstacle " + obstacle.name,
           .stiffness_mpa_per_mm = prepared.obstacle_stiffness_mpa_per_mm[i],
           .capture_mm = obstacle.capture_mm,
           .integration = obstacle.integration,
           .penetration_tolerance_mm = obstacle.penetration_tolerance_mm}};
}

Result<std::vector<std::string>> check_obstacles(const PreparedDeck& prepared,
                                                 const ObstacleDetectors& detectors) {
  constexpr double kNothing = 0.02;  // Of what a detector resolves: what it is off by.
  LEFORT_CHECK(detectors.size() == prepared.deck.obstacles.size());
  std::vector<std::string> warnings;
  for (std::size_t i = 0; i < detectors.size(); ++i) {
    LEFORT_TRY_VOID(check_detector(prepared.deck.obstacles[i], *detectors[i]));
    const double overlap_mm = make_contact(prepared, i, detectors[i]).rest_penetration_mm();
    const double reach_mm = detectors[i]->reach_mm();
    const std::string what = fmt::format("{}: overlaps its faces by {:.3g} mm at rest",
                                         indexed("obstacles", i), overlap_mm);
    if (overlap_mm >= reach_mm)
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("{}, its field knows {:.3g} mm", what, reach_mm));
    if (overlap_mm > kNothing * detectors[i]->resolution_mm())
      warnings.push_back(what + " and pushes only as it goes deeper");
  }
  return warnings;
}

}  // namespace lefort::solve
