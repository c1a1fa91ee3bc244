/// \file
/// Pieces of a dental arch, for a maxilla that is cut between teeth.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/geometry/triangle_mesh.h>

#include <array>
#include <map>
#include <span>
#include <vector>

namespace lefort::dental {

/// Divides an arch between adjacent teeth. Each triangle belongs to the piece of the tooth whose
/// crown is closest.
///
/// \param arch_L    the upper arch; open or closed.
/// \param crowns_L  centers of the crowns by FDI number; others than upper ones are ignored.
/// \param cuts      one or two pairs of adjacent upper teeth, in any order.
/// \returns the pieces from the patient's right to left, as open surfaces; or kInvalidArgument if a
///   tooth is unknown, or there are teeth between those of a pair, or a piece has no tooth.
[[nodiscard]] Result<std::vector<geometry::TriangleMesh>> cut_arch(
    const geometry::TriangleMesh& arch_L, const std::map<int, Vec3>& crowns_L,
    std::span<const std::array<int, 2>> cuts);

}  // namespace lefort::dental
