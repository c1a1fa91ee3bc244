/// \file
/// Whether contact can work with the obstacles of a deck and their fields, before anything is
/// solved.
#pragma once

#include <lefort/core/error.h>
#include <lefort/field/distance_field.h>
#include <lefort/solve/prepare_deck.h>

#include <memory>
#include <string>
#include <vector>

namespace lefort::solve {

/// The distance field of each obstacle, in its own frame: where it is before its path begins.
using ObstacleFields = std::vector<std::shared_ptr<const field::DistanceField>>;

/// \param fields  like Deck::obstacles.
/// \returns warnings of obstacles that overlap their faces at rest, or
///   - kMeshInvalid      a field is that of an open surface: it has no inside;
///   - kInvalidArgument  the capture of an obstacle is not less than its field's reach, its field
///                       cannot be read smoothly, or it overlaps its faces at rest as deep as the
///                       field reaches.
[[nodiscard]] Result<std::vector<std::string>> check_obstacles(const PreparedDeck& prepared,
                                                               const ObstacleFields& fields);

}  // namespace lefort::solve
