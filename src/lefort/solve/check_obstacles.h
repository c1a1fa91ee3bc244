/// \file
/// Checks obstacles and their distance queries before the solve.
#pragma once

#include <lefort/contact/contact_term.h>
#include <lefort/contact/distance_query.h>
#include <lefort/core/error.h>
#include <lefort/solve/prepare_deck.h>

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace lefort::solve {

/// Distance query of each obstacle in its frame B, which coincides with L at time 0.
using ObstacleDistanceQueries = std::vector<std::shared_ptr<const contact::DistanceQuery>>;

/// Contact term of an obstacle and the faces that it may touch, at rest.
///
/// \param prepared        the deck.
/// \param obstacle        index in Deck::obstacles.
/// \param distance_query  of the obstacle.
[[nodiscard]] contact::ContactTerm make_contact(
    const PreparedDeck& prepared, std::size_t obstacle,
    const std::shared_ptr<const contact::DistanceQuery>& distance_query);

/// \param prepared          the deck.
/// \param distance_queries  as Deck::obstacles.
/// \returns warnings of obstacles that overlap, at rest, the faces that they may touch; or
///   - kMeshInvalid      an obstacle is an open surface: it has no inside;
///   - kInvalidArgument  contact_snap_mm of an obstacle, or the depth of its overlap with the faces
///     at rest, is not less than the maximum distance of its query.
[[nodiscard]] Result<std::vector<std::string>> check_obstacles(
    const PreparedDeck& prepared, const ObstacleDistanceQueries& distance_queries);

}  // namespace lefort::solve
