#include <lefort/core/check.h>
#include <lefort/fem/assembly/dof_map.h>

#include <fmt/format.h>

#include <cmath>
#include <limits>

namespace lefort::fem {

Result<DofMap> DofMap::build(Index node_count, std::span<const PrescribedDisplacement> prescribed) {
  LEFORT_CHECK(node_count >= 0 && node_count < std::numeric_limits<std::int32_t>::max() / 3);
  constexpr double kFree = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> given(std::size_t(3 * node_count), kFree);
  for (const PrescribedDisplacement& p : prescribed) {
    if (p.node < 0 || p.node >= node_count)
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("prescribed displacement: node is {}, must be 0 to {}", p.node,
                              node_count - 1));
    if (p.component < 0 || p.component > 2)
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("prescribed displacement of node {}: component is {}, must be 0 to 2",
                              p.node, p.component));
    if (!std::isfinite(p.displacement_mm))
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("prescribed displacement of node {} is {} mm, must be finite", p.node,
                              p.displacement_mm));
    double& known = given[std::size_t(3 * p.node + p.component)];
    if (!std::isnan(known) && known != p.displacement_mm)
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("node {} is moved by {} mm and by {} mm in component {}, must be one",
                              p.node, known, p.displacement_mm, p.component));
    known = p.displacement_mm;
  }

  DofMap map;
  map.free_from_all_.assign(given.size(), -1);
  for (std::size_t all = 0; all < given.size(); ++all) {
    if (!std::isnan(given[all])) continue;
    map.free_from_all_[all] = std::int32_t(map.all_from_free_.size());
    map.all_from_free_.push_back(std::int32_t(all));
  }
  return map;
}

VectorX DofMap::free_part(const VectorX& all) const {
  LEFORT_CHECK(all.size() == 3 * node_count());
  VectorX free(free_count());
  for (Index i = 0; i < free.size(); ++i) free[i] = all[all_from_free_[std::size_t(i)]];
  return free;
}

VectorX DofMap::with_free_part(const VectorX& all, const VectorX& free) const {
  LEFORT_CHECK(all.size() == 3 * node_count() && free.size() == free_count());
  VectorX result = all;
  for (Index i = 0; i < free.size(); ++i) result[all_from_free_[std::size_t(i)]] = free[i];
  return result;
}

VectorX DofMap::with_prescribed(const VectorX& all,
                                std::span<const PrescribedDisplacement> prescribed) const {
  LEFORT_CHECK(all.size() == 3 * node_count());
  VectorX result = all;
  for (const PrescribedDisplacement& p : prescribed) {
    LEFORT_CHECK(p.node >= 0 && p.node < node_count() && p.component >= 0 && p.component < 3);
    const Index dof = 3 * Index(p.node) + p.component;
    LEFORT_CHECK(free_number(dof) < 0);
    result[dof] = p.displacement_mm;
  }
  return result;
}

}  // namespace lefort::fem
