#include <lefort/dental/cut_arch.h>
#include <lefort/dental/renumber_teeth.h>
#include <lefort/geometry/mesh_properties.h>

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

namespace lefort::dental {
namespace {

/// Position in the upper arch from right to left: 18 is -8, 11 is -1, 21 is 1.
int place_of(int fdi) { return fdi / 10 == 1 ? -(fdi % 10) : fdi % 10; }

/// The upper crowns from right to left.
std::vector<std::pair<int, Vec3>> upper_crowns(const std::map<int, Vec3>& crowns_L) {
  std::vector<std::pair<int, Vec3>> upper;
  for (const auto& [fdi, at_L] : crowns_L)
    if (fdi / 10 <= 2) upper.emplace_back(place_of(fdi), at_L);
  std::sort(upper.begin(), upper.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });
  return upper;
}

/// The place left of which a cut lies: that of its right tooth.
Result<int> cut_after(const std::array<int, 2>& cut,
                      const std::vector<std::pair<int, Vec3>>& upper) {
  const int first = std::min(place_of(cut[0]), place_of(cut[1]));
  const int last = std::max(place_of(cut[0]), place_of(cut[1]));
  const auto at =
      std::find_if(upper.begin(), upper.end(), [&](const auto& one) { return one.first == first; });
  const bool is_upper =
      is_fdi_number(cut[0]) && is_fdi_number(cut[1]) && cut[0] / 10 <= 2 && cut[1] / 10 <= 2;
  if (!is_upper || at == upper.end() || at + 1 == upper.end() || (at + 1)->first != last)
    return fail(
        ErrorCode::kInvalidArgument,
        fmt::format("{} and {} are not two adjacent upper teeth of the file", cut[0], cut[1]));
  return first;
}

}  // namespace

Result<std::vector<geometry::TriangleMesh>> cut_arch(const geometry::TriangleMesh& arch_L,
                                                     const std::map<int, Vec3>& crowns_L,
                                                     std::span<const std::array<int, 2>> cuts) {
  const auto upper = upper_crowns(crowns_L);
  if (upper.empty() || cuts.empty())
    return fail(ErrorCode::kInvalidArgument, "no cut between upper teeth is given");
  std::vector<int> ends;
  for (const std::array<int, 2>& cut : cuts) {
    LEFORT_TRY(const int after, cut_after(cut, upper));
    ends.push_back(after);
  }
  std::sort(ends.begin(), ends.end());
  if (std::adjacent_find(ends.begin(), ends.end()) != ends.end())
    return fail(ErrorCode::kInvalidArgument, "two cuts are between the same teeth");
  const auto piece_of = [&](Index triangle) {
    const Vec3 center_L =
        (arch_L.corner(triangle, 0) + arch_L.corner(triangle, 1) + arch_L.corner(triangle, 2)) /
        3.0;
    const auto closest =
        std::min_element(upper.begin(), upper.end(), [&](const auto& a, const auto& b) {
          return (a.second - center_L).squaredNorm() < (b.second - center_L).squaredNorm();
        });
    return std::size_t(
        std::count_if(ends.begin(), ends.end(), [&](int end) { return end < closest->first; }));
  };
  std::vector<geometry::TriangleMesh> pieces;
  for (std::size_t n = 0; n <= ends.size(); ++n) {
    pieces.push_back(
        geometry::keep_triangles(arch_L, [&](Index triangle) { return piece_of(triangle) == n; }));
    if (pieces.back().triangles.empty())
      return fail(ErrorCode::kInvalidArgument,
                  "a piece of the arch has no surface: are teeth and arch in the same frame?");
  }
  return pieces;
}

}  // namespace lefort::dental
