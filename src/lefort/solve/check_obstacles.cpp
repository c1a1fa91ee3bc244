#include <lefort/contact/contact_term.h>
#include <lefort/core/check.h>
#include <lefort/solve/about_key.h>
#include <lefort/solve/check_obstacles.h>

#include <fmt/format.h>

namespace lefort::solve {
namespace {

Result<void> check_field(const Obstacle& obstacle, const field::DistanceField& field_B) {
  const bool smooth = obstacle.reconstruction == contact::Reconstruction::kSmooth;
  if (!field_B.frame().closed)
    return fail(
        ErrorCode::kMeshInvalid,
        fmt::format("obstacle {} is an open surface, contact needs a closed one", obstacle.name));
  if (smooth && !field_B.is_smooth())
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("the field of obstacle {} was built without --smooth; build it anew "
                            "with it, or choose reconstruction trilinear",
                            obstacle.name));
  const double reach_mm = contact::reach_mm(field_B, obstacle.reconstruction);
  if (!(obstacle.capture_mm < reach_mm))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("capture_mm of obstacle {} is {:g}, must be less than the {:.2f} mm "
                            "that its field reaches",
                            obstacle.name, obstacle.capture_mm, reach_mm));
  return {};
}

}  // namespace

Result<std::vector<std::string>> check_obstacles(const PreparedDeck& prepared,
                                                 const ObstacleFields& fields) {
  constexpr double kNothing_mm = 0.01;  // What a field and the chords of faces are off by.
  LEFORT_CHECK(fields.size() == prepared.deck.obstacles.size());
  std::vector<std::string> warnings;
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const Obstacle& obstacle = prepared.deck.obstacles[i];
    LEFORT_TRY_VOID(check_field(obstacle, *fields[i]));
    const contact::ContactTerm contact(
        prepared.mesh.nodes_L, prepared.obstacle_faces[i],
        {fields[i], RigidTransform::Identity(), obstacle.reconstruction},
        {prepared.obstacle_stiffness_mpa_per_mm[i], obstacle.capture_mm});
    const double overlap_mm = contact.rest_penetration_mm();
    const double reach_mm = contact::reach_mm(*fields[i], obstacle.reconstruction);
    const std::string what = fmt::format("{}: overlaps its faces by {:.3g} mm at rest",
                                         indexed("obstacles", i), overlap_mm);
    if (overlap_mm >= reach_mm)
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("{}, its field knows {:.3g} mm", what, reach_mm));
    if (overlap_mm > kNothing_mm) warnings.push_back(what + " and pushes only as it goes deeper");
  }
  return warnings;
}

}  // namespace lefort::solve
