#include <lefort/core/check.h>
#include <lefort/core/parallel.h>
#include <lefort/core/trace.h>
#include <lefort/fem/assembly/assemble.h>
#include <lefort/fem/assembly/assembly_plan.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace lefort::fem {
namespace {

constexpr double kInadmissible = std::numeric_limits<double>::quiet_NaN();
constexpr int kMaxLocalSize = 3 * kMaxLocalNodes;
/// Items per task: enough to amortize the task, few enough for load balance.
constexpr Index kItemsPerTask = 64;

/// Copies the entries of `values` [3 per node] that belong to `nodes`.
void pick(const VectorX& values, std::span<const std::int32_t> nodes, Vec3* picked) {
  for (std::size_t a = 0; a < nodes.size(); ++a) picked[a] = values.segment<3>(3 * Index(nodes[a]));
}

/// Results of an item other than forces and stiffness.
struct ItemState {
  double energy_mj = 0.0;  ///< Or kInadmissible.
  Index contacts = 0;
  double deepest_mm = 0.0;
};

/// Evaluates one item into zeroed memory.
/// \param stiffness  of the kind `tangent`; may be null.
ItemState evaluate_item(const ForceTerm& term, Index item, const VectorX& x_L, double* residual,
                        double* stiffness, Tangent tangent = Tangent::kExact) {
  const std::span<const std::int32_t> nodes = term.nodes(item);
  const auto size = Index(3 * nodes.size());
  std::array<Vec3, kMaxLocalNodes> local_x_L;
  pick(x_L, nodes, local_x_L.data());
  const Index stiffness_size = stiffness == nullptr ? 0 : size;
  LocalEquations local{
      .residual_n = Eigen::Map<VectorX>(residual, size),
      .stiffness_n_per_mm = Eigen::Map<Eigen::MatrixXd>(stiffness, stiffness_size, stiffness_size),
      .tangent = tangent};
  local.residual_n.setZero();
  local.stiffness_n_per_mm.setZero();
  const bool admissible = term.evaluate(item, {local_x_L.data(), nodes.size()}, local);
  return {admissible ? local.energy_mj : kInadmissible, local.contacts, local.deepest_mm};
}

/// Adds the forces of the items of a chunk to the nodes; and their magnitudes if not null.
void gather_forces(const Gather<std::int32_t>& gather, const std::vector<double>& buffer,
                   VectorX& sum, VectorX* sum_of_magnitudes) {
  parallel_for(Index(gather.target.size()), [&](Index k) {
    Vec3 total = Vec3::Zero();
    Vec3 magnitudes = Vec3::Zero();
    for (std::int32_t s = gather.first[std::size_t(k)]; s < gather.first[std::size_t(k) + 1]; ++s) {
      const Vec3 force = Eigen::Map<const Vec3>(buffer.data() + gather.source[std::size_t(s)]);
      total += force;
      magnitudes += force.cwiseAbs();
    }
    const Index at = 3 * Index(gather.target[std::size_t(k)]);
    sum.segment<3>(at) += total;
    if (sum_of_magnitudes != nullptr) sum_of_magnitudes->segment<3>(at) += magnitudes;
  });
}

/// Adds the stiffness of the items of a chunk to the blocks of the tangent.
void gather_stiffness(const Gather<BlockSource>& gather, const std::vector<double>& buffer,
                      const DofMap& dofs, const std::vector<TangentBlock>& blocks, double* values) {
  using Block = Eigen::Map<const Mat3, 0, Eigen::OuterStride<>>;
  parallel_for(Index(gather.target.size()), [&](Index k) {
    Mat3 total = Mat3::Zero();
    for (std::int32_t s = gather.first[std::size_t(k)]; s < gather.first[std::size_t(k) + 1]; ++s) {
      const BlockSource& source = gather.source[std::size_t(s)];
      total += Block(buffer.data() + source.offset, Eigen::OuterStride<>(source.stride));
    }
    const TangentBlock& block = blocks[std::size_t(gather.target[std::size_t(k)])];
    const bool on_diagonal = block.row_node == block.column_node;
    for (int c = 0; c < 3; ++c) {
      std::int32_t place = block.value_index[std::size_t(c)];
      if (place < 0) continue;
      for (int r = on_diagonal ? c : 0; r < 3; ++r)
        if (dofs.free_number(3 * Index(block.row_node) + r) >= 0) values[place++] += total(r, c);
    }
  });
}

/// Whether absolute values are multiplied, so that nothing cancels.
enum class Magnitudes { kNo, kYes };

}  // namespace

double energy_change_mj(const AssembledForces& from, const VectorX& u_from,
                        const AssembledForces& to, const VectorX& u_to) {
  const double change_mj = to.energy_mj - from.energy_mj;
  if (from.follower_n.size() == 0) return change_mj;
  return change_mj + 0.5 * (from.follower_n + to.follower_n).dot(u_to - u_from);
}

struct Assembler::Plan {
  std::vector<Vec3> nodes_L;
  DofMap dofs;
  std::vector<const ForceTerm*> terms;
  std::vector<bool> conservative;  ///< One per term.
  AssemblyPlan layout;

  /// Positions under displacements u, 3 per node.
  [[nodiscard]] VectorX positions_L(const VectorX& u) const {
    LEFORT_CHECK(u.size() == 3 * Index(nodes_L.size()));
    return u + Eigen::Map<const VectorX>(nodes_L.data()->data(), u.size());
  }

  [[nodiscard]] const ForceTerm& term(const PlannedItem& item) const {
    return *terms[std::size_t(item.term)];
  }
  [[nodiscard]] bool has_followers() const { return std::ranges::count(conservative, false) > 0; }
  [[nodiscard]] bool is_conservative(const PlannedItem& item) const {
    return conservative[std::size_t(item.term)];
  }

  /// \returns the sum over all items of their stiffness at x_L times `vector`, or the same with the
  ///   absolute values of both.
  [[nodiscard]] VectorX stiffness_times(const VectorX& x_L, const VectorX& vector, Tangent kind,
                                        Magnitudes magnitudes) const;

  /// Adds the forces of the chunk's items whose terms are not conservative.
  void add_followers(const Chunk& chunk, const std::vector<double>& buffer,
                     VectorX& follower_n) const {
    for (const PlannedItem& item : chunk.items) {
      if (is_conservative(item)) continue;
      const double* force = buffer.data() + item.forces;
      for (const std::int32_t node : term(item).nodes(item.item)) {
        follower_n.segment<3>(3 * Index(node)) += Eigen::Map<const Vec3>(force);
        force += 3;
      }
    }
  }
};

Assembler::Assembler(std::vector<Vec3> nodes_L, DofMap dofs, std::vector<const ForceTerm*> terms) {
  LEFORT_CHECK(Index(nodes_L.size()) == dofs.node_count());
  AssemblyPlan layout = plan_assembly(dofs, terms);
  std::vector<bool> conservative;
  for (const ForceTerm* term : terms) conservative.push_back(term->is_conservative(dofs));
  plan_ = std::make_unique<const Plan>(Plan{std::move(nodes_L), std::move(dofs), std::move(terms),
                                            std::move(conservative), std::move(layout)});
}

Assembler::~Assembler() = default;
Assembler::Assembler(Assembler&&) noexcept = default;
Assembler& Assembler::operator=(Assembler&&) noexcept = default;

const DofMap& Assembler::dofs() const { return plan_->dofs; }
std::span<const Vec3> Assembler::nodes_L() const { return plan_->nodes_L; }

std::optional<AssembledForces> Assembler::forces(const VectorX& u) const {
  const TraceSpan span("assemble forces");
  const VectorX x_L = plan_->positions_L(u);
  AssembledForces sum{.residual_n = VectorX::Zero(u.size())};
  const bool has_followers = plan_->has_followers();
  if (has_followers) sum.follower_n = VectorX::Zero(u.size());
  VectorX magnitudes = VectorX::Zero(u.size());
  double energy_magnitude = 0.0;
  std::vector<double> buffer(std::size_t(plan_->layout.force_buffer_size));
  std::vector<ItemState> states;
  for (const Chunk& chunk : plan_->layout.chunks) {
    states.assign(chunk.items.size(), {});
    parallel_for(
        Index(chunk.items.size()),
        [&](Index k) {
          const PlannedItem& item = chunk.items[std::size_t(k)];
          states[std::size_t(k)] = evaluate_item(plan_->term(item), item.item, x_L,
                                                 buffer.data() + item.forces, nullptr);
        },
        kItemsPerTask);
    for (std::size_t k = 0; k < states.size(); ++k) {
      if (std::isnan(states[k].energy_mj)) return std::nullopt;
      sum.contacts += states[k].contacts;
      sum.deepest_mm = std::max(sum.deepest_mm, states[k].deepest_mm);
      if (!plan_->is_conservative(chunk.items[k])) continue;
      sum.energy_mj += states[k].energy_mj;
      energy_magnitude += std::abs(states[k].energy_mj);
    }
    if (!std::isfinite(sum.energy_mj)) return std::nullopt;
    gather_forces(chunk.forces, buffer, sum.residual_n, &magnitudes);
    if (has_followers) plan_->add_followers(chunk, buffer, sum.follower_n);
  }
  if (!sum.residual_n.allFinite()) return std::nullopt;
  sum.residual_reference_n = plan_->dofs.free_part(magnitudes).norm();
  sum.energy_round_off_mj =
      std::numeric_limits<double>::epsilon() * (energy_magnitude + magnitudes.dot(x_L.cwiseAbs()));
  return sum;
}

std::string Assembler::inadmissible_cause(const VectorX& u) const {
  const VectorX x_L = plan_->positions_L(u);
  if (!x_L.allFinite()) return "a displacement is not finite";
  std::array<double, 3 * kMaxLocalNodes> forces_n{};
  for (const Chunk& chunk : plan_->layout.chunks)
    for (const PlannedItem& item : chunk.items) {
      const ForceTerm& term = plan_->term(item);
      const ItemState state = evaluate_item(term, item.item, x_L, forces_n.data(), nullptr);
      if (std::isfinite(state.energy_mj)) continue;
      const Vec3 at_L = x_L.segment<3>(3 * Index(term.nodes(item.item).front()));
      return fmt::format("{} at ({:.1f}, {:.1f}, {:.1f}) mm", term.inadmissible_cause(), at_L.x(),
                         at_L.y(), at_L.z());
    }
  return {};
}

linear::SparseMatrix Assembler::tangent(const VectorX& u, Tangent kind) const {
  const TraceSpan span("assemble tangent");
  const VectorX x_L = plan_->positions_L(u);
  linear::SparseMatrix K = plan_->layout.pattern;
  std::vector<double> forces(std::size_t(plan_->layout.force_buffer_size));
  std::vector<double> stiffness(std::size_t(plan_->layout.stiffness_buffer_size));
  std::vector<double> energies;
  for (const Chunk& chunk : plan_->layout.chunks) {
    energies.assign(chunk.items.size(), 0.0);
    parallel_for(
        Index(chunk.items.size()),
        [&](Index k) {
          const PlannedItem& item = chunk.items[std::size_t(k)];
          energies[std::size_t(k)] =
              evaluate_item(plan_->term(item), item.item, x_L, forces.data() + item.forces,
                            stiffness.data() + item.stiffness, kind)
                  .energy_mj;
        },
        kItemsPerTask);
    for (const double energy : energies) LEFORT_CHECK(!std::isnan(energy));
    const TraceSpan gather("gather stiffness");
    gather_stiffness(chunk.stiffness, stiffness, plan_->dofs, plan_->layout.blocks, K.valuePtr());
  }
  return K;
}

linear::SparseMatrix Assembler::antisymmetric_tangent(const VectorX& u) const {
  const Plan& plan = *plan_;
  if (!plan.has_followers()) return {};
  const VectorX x_L = plan.positions_L(u);
  std::vector<Eigen::Triplet<double, int>> entries;
  std::array<double, kMaxLocalSize> forces;
  std::array<double, kMaxLocalSize * kMaxLocalSize> stiffness;
  for (std::size_t t = 0; t < plan.terms.size(); ++t) {
    if (plan.conservative[t]) continue;
    const ForceTerm& term = *plan.terms[t];
    for (Index item = 0; item < term.item_count(); ++item) {
      const double energy =
          evaluate_item(term, item, x_L, forces.data(), stiffness.data(), Tangent::kAntisymmetric)
              .energy_mj;
      LEFORT_CHECK(!std::isnan(energy));
      const auto nodes = term.nodes(item);
      const auto size = Index(3 * nodes.size());
      const auto number = [&](Index i) {
        return plan.dofs.free_number(3 * Index(nodes[std::size_t(i / 3)]) + i % 3);
      };
      const Eigen::Map<const Eigen::MatrixXd> A(stiffness.data(), size, size);
      for (Index j = 0; j < size; ++j)
        for (Index i = 0; i < size; ++i)
          if (number(j) >= 0 && number(i) > number(j))
            entries.emplace_back(number(i), number(j), A(i, j));
    }
  }
  linear::SparseMatrix lower(plan.dofs.free_count(), plan.dofs.free_count());
  lower.setFromTriplets(entries.begin(), entries.end());
  return lower;
}

VectorX Assembler::Plan::stiffness_times(const VectorX& x_L, const VectorX& vector, Tangent kind,
                                         Magnitudes magnitudes) const {
  VectorX product = VectorX::Zero(vector.size());
  std::vector<double> buffer(std::size_t(layout.force_buffer_size));
  for (const Chunk& chunk : layout.chunks) {
    parallel_for(
        Index(chunk.items.size()),
        [&](Index k) {
          const PlannedItem& item = chunk.items[std::size_t(k)];
          const std::span<const std::int32_t> nodes = term(item).nodes(item.item);
          const auto size = Index(3 * nodes.size());
          std::array<Vec3, kMaxLocalNodes> local;
          pick(vector, nodes, local.data());
          const Eigen::Map<const VectorX> factor(local.data()->data(), size);
          Eigen::Map<VectorX> force(buffer.data() + item.forces, size);
          if (factor.isZero(0.0)) {
            force.setZero();
            return;
          }
          std::array<double, kMaxLocalSize * kMaxLocalSize> stiffness;
          const double energy =
              evaluate_item(term(item), item.item, x_L, force.data(), stiffness.data(), kind)
                  .energy_mj;
          LEFORT_CHECK(!std::isnan(energy));
          const Eigen::Map<const Eigen::MatrixXd> K(stiffness.data(), size, size);
          if (magnitudes == Magnitudes::kYes)
            force.noalias() = K.cwiseAbs() * factor.cwiseAbs();
          else
            force.noalias() = K * factor;
        },
        kItemsPerTask);
    gather_forces(chunk.forces, buffer, product, nullptr);
  }
  return product;
}

VectorX Assembler::tangent_times(const VectorX& u, const VectorX& du, Tangent kind) const {
  LEFORT_CHECK(du.size() == u.size());
  return plan_->stiffness_times(plan_->positions_L(u), du, kind, Magnitudes::kNo);
}

VectorX Assembler::force_round_off_n(const VectorX& u) const {
  const VectorX x_L = plan_->positions_L(u);
  return std::numeric_limits<double>::epsilon() *
         plan_->stiffness_times(x_L, x_L, Tangent::kExact, Magnitudes::kYes);
}

}  // namespace lefort::fem
