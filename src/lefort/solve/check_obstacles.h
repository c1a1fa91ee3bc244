/// \file
/// Whether contact can work with the obstacles of a deck and who detects them, before anything
/// is solved.
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

/// Who knows each obstacle, in its own frame: where it is before its path begins.
using ObstacleDistanceQueries = std::vector<std::shared_ptr<const contact::DistanceQuery>>;

/// The contact of an obstacle with its faces, at rest.
[[nodiscard]] contact::ContactTerm make_contact(
    const PreparedDeck& prepared, std::size_t obstacle,
    const std::shared_ptr<const contact::DistanceQuery>& distance_query);

/// \param detectors  like Deck::obstacles.
/// \returns warnings of obstacles that overlap their faces at rest, or
///   - kMeshInvalid      an obstacle is an open surface: it has no inside;
///   - kInvalidArgument  the capture of an obstacle is not less than its detector's reach, or it
///                       overlaps its faces at rest as deep as that.
[[nodiscard]] Result<std::vector<std::string>> check_obstacles(
    const PreparedDeck& prepared, const ObstacleDistanceQueries& distance_queries);

}  // namespace lefort::solve
