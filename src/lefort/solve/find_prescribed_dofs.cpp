#include <lefort/geometry/rigid_path.h>
#include <lefort/solve/find_prescribed_dofs.h>
#include <lefort/solve/find_sets.h>
#include <lefort/solve/prefix_error.h>

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace lefort::solve {
namespace {

using NodeList = std::vector<std::int32_t>;

bool same_curve(const LoadCurve& a, const LoadCurve& b) {
  return std::equal(a.points.begin(), a.points.end(), b.points.begin(), b.points.end(),
                    [](const CurvePoint& p, const CurvePoint& q) {
                      return p.time == q.time && p.factor == q.factor;
                    });
}

/// Whether two conditions prescribe the same displacement of a component at all times.
bool agree(const Deck& deck, int a, int b, int component) {
  const int displacements = int(deck.displacements.size());
  if (a >= displacements || b >= displacements) return a == b;
  const PrescribedSet& first = deck.displacements[std::size_t(a)];
  const PrescribedSet& second = deck.displacements[std::size_t(b)];
  const double one = *first.displacement_mm[std::size_t(component)];
  const double other = *second.displacement_mm[std::size_t(component)];
  return one == other && (one == 0.0 || same_curve(first.curve, second.curve));
}

/// Collects prescribed degrees of freedom; of conditions that agree, the first one counts.
class DofCollector {
 public:
  DofCollector(const mesh::VolumeMesh& mesh, const Deck& deck)
      : mesh_(mesh), deck_(deck), by_(3 * mesh.nodes_L.size(), kFree) {}

  Result<void> add(const NodeList& nodes, int component, int by) {
    for (const std::int32_t node : nodes) {
      int& owner = by_[3 * std::size_t(node) + std::size_t(component)];
      if (owner == kFree) {
        owner = by;
        dofs_.push_back({node, component, by});
      } else if (!agree(deck_, owner, by, component)) {
        const Vec3& p_L = mesh_.nodes_L[std::size_t(node)];
        return fail(
            ErrorCode::kPlanInvalid,
            fmt::format("{} and {} both prescribe {} of node {} at ({:.3f}, {:.3f}, {:.3f}) "
                        "mm, with different values",
                        name_of_condition(deck_, owner), name_of_condition(deck_, by),
                        "xyz"[component], node, p_L.x(), p_L.y(), p_L.z()));
      }
    }
    return {};
  }
  [[nodiscard]] std::vector<PrescribedDof> take() && { return std::move(dofs_); }

 private:
  static constexpr int kFree = -2;
  const mesh::VolumeMesh& mesh_;
  const Deck& deck_;
  std::vector<int> by_;
  std::vector<PrescribedDof> dofs_;
};

}  // namespace

std::string name_of_condition(const Deck& deck, int by) {
  const int displacements = int(deck.displacements.size());
  if (by < 0) return "a node of no element";
  if (by < displacements)
    return fmt::format("displacements[{}] (set {})", by, deck.displacements[std::size_t(by)].set);
  const int motion = by - displacements;
  return fmt::format("motions[{}] (set {})", motion, deck.motions[std::size_t(motion)].set);
}

Result<std::vector<PrescribedDof>> find_prescribed_dofs(const mesh::VolumeMesh& mesh,
                                                        const Deck& deck) {
  DofCollector dofs(mesh, deck);
  for (std::size_t d = 0; d < deck.displacements.size(); ++d) {
    const PrescribedSet& set = deck.displacements[d];
    const std::string key = indexed("displacements", d);
    LEFORT_TRY_VOID(prefix_error(check_curve(set.curve), key));
    LEFORT_TRY(const NodeList nodes, prefix_error(find_nodes(mesh, set.set), key));
    for (int component = 0; component < 3; ++component)
      if (set.displacement_mm[std::size_t(component)])
        LEFORT_TRY_VOID(dofs.add(nodes, component, int(d)));
  }
  for (std::size_t m = 0; m < deck.motions.size(); ++m) {
    const std::string key = indexed("motions", m);
    LEFORT_TRY_VOID(prefix_error(geometry::check_path(deck.motions[m].path), key));
    LEFORT_TRY(const NodeList nodes, prefix_error(find_nodes(mesh, deck.motions[m].set), key));
    for (int component = 0; component < 3; ++component)
      LEFORT_TRY_VOID(dofs.add(nodes, component, int(deck.displacements.size() + m)));
  }
  const std::vector<char> used = nodes_of_elements(mesh);
  NodeList idle;
  for (std::size_t n = 0; n < used.size(); ++n)
    if (used[n] == 0) idle.push_back(std::int32_t(n));
  for (int component = 0; component < 3; ++component)
    LEFORT_TRY_VOID(dofs.add(idle, component, -1));
  return std::move(dofs).take();
}

std::vector<fem::PrescribedDisplacement> prescribed_at(
    const mesh::VolumeMesh& mesh, const Deck& deck, std::span<const PrescribedDof> prescribed_dofs,
    double time) {
  const auto displacements = deck.displacements.size();
  std::vector<double> factors;
  for (const PrescribedSet& set : deck.displacements) factors.push_back(factor_at(set.curve, time));
  std::vector<RigidTransform> poses;
  for (const RigidlyMovedSet& set : deck.motions)
    poses.push_back(geometry::pose_at(set.path, time));

  std::vector<fem::PrescribedDisplacement> prescribed;
  prescribed.reserve(prescribed_dofs.size());
  for (const PrescribedDof& dof : prescribed_dofs) {
    double mm = 0.0;
    if (dof.by >= 0 && std::size_t(dof.by) < displacements) {
      const auto by = std::size_t(dof.by);
      mm = factors[by] * *deck.displacements[by].displacement_mm[std::size_t(dof.component)];
    } else if (dof.by >= 0) {
      const Vec3& X_L = mesh.nodes_L[std::size_t(dof.node)];
      mm = (poses[std::size_t(dof.by) - displacements] * X_L - X_L)[dof.component];
    }
    prescribed.push_back({dof.node, dof.component, mm});
  }
  return prescribed;
}

}  // namespace lefort::solve
