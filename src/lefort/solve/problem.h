/// \file
/// The equations of a deck: its force terms, with loads and poses that depend on time.
#pragma once

#include <lefort/contact/bone_passage.h>
#include <lefort/contact/contact_surface.h>
#include <lefort/contact/contact_term.h>
#include <lefort/contact/weighted_contact_term.h>
#include <lefort/fem/assembly/assemble.h>
#include <lefort/fem/assembly/element_term.h>
#include <lefort/fem/solve/load_steps.h>
#include <lefort/geometry/rigid_path.h>
#include <lefort/solve/check_obstacles.h>
#include <lefort/solve/deck_loads.h>
#include <lefort/solve/run_deck.h>

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace lefort::solve {

using ElementTerms = std::vector<std::unique_ptr<const fem::ForceTerm>>;

/// Contact by weighted gaps with all obstacles that have the same list of faces, stiffness and
/// contact snap distance.
struct WeightedContact {
  std::vector<std::size_t> obstacles;  ///< Indices in Deck::obstacles, ascending.
  contact::WeightedContactTerm term;
};

/// \param obstacles  in the order of the deck, at their poses at rest.
[[nodiscard]] std::vector<WeightedContact> make_weighted_contacts(
    const PreparedDeck& prepared, std::span<const contact::RigidObstacle> obstacles);

/// Force terms of a deck, with loads and obstacle poses that depend on time.
class Problem {
 public:
  /// \param prepared          must outlive the problem.
  /// \param distance_queries  one for each of Deck::obstacles, in the same order.
  /// \returns the problem at time 0, or an error of check_obstacles(), fem::make_element_terms(),
  ///   DeckLoads::build() or fem::DofMap::build().
  [[nodiscard]] static Result<std::unique_ptr<Problem>> build(
      const PreparedDeck& prepared, const ObstacleDistanceQueries& distance_queries) {
    LEFORT_TRY_VOID(check_obstacles(prepared, distance_queries));
    LEFORT_TRY(ElementTerms elements, fem::make_element_terms(prepared.mesh, prepared.materials));
    LEFORT_TRY(DeckLoads loads, DeckLoads::build(prepared));
    LEFORT_TRY(fem::DofMap dofs,
               fem::DofMap::build(prepared.mesh.node_count(), prescribed_at(prepared, 0.0)));
    return std::unique_ptr<Problem>(new Problem(prepared, distance_queries, std::move(elements),
                                                std::move(loads), std::move(dofs)));
  }

  /// Sets loads and obstacle poses to those of `time`, 0 to 1.
  void set_time(double time) {
    loads_.set_time(time);
    for (std::size_t i = 0; i < obstacles_.size(); ++i)
      obstacles_[i].X_LB = geometry::pose_at(prepared_.deck.obstacles[i].path, time);
    for (std::size_t n = 0; n < contacts_.size(); ++n)
      contacts_[n].set_pose(obstacles_[contact_obstacles_[n]].X_LB);
    for (WeightedContact& contact : weighted_)
      for (std::size_t n = 0; n < contact.obstacles.size(); ++n)
        contact.term.set_pose(n, obstacles_[contact.obstacles[n]].X_LB);
  }

  /// Rejects an equilibrium if an obstacle without weighted gaps passed through faces since the
  /// equilibrium `last`.
  void reject_passages(const fem::LoadState& last, fem::NewtonOutcome& outcome) const {
    const std::vector<Vec3> from_L = contact::displaced(prepared_.mesh.nodes_L, last.u);
    const std::vector<Vec3> to_L = contact::displaced(prepared_.mesh.nodes_L, outcome.x);
    for (std::size_t n = 0; n < contacts_.size() && outcome.converged(); ++n) {
      const std::size_t i = contact_obstacles_[n];
      const RigidTransform from_X_LB = geometry::pose_at(prepared_.deck.obstacles[i].path, last.t);
      auto why = contacts_[n].rejection_reason(from_X_LB, from_L, to_L);
      if (const auto at_L = contact::find_passage(obstacles_[i], prepared_.obstacle_faces[i],
                                                  from_X_LB, from_L, to_L))
        why = fmt::format(
            "a face, now at ({:.3f}, {:.3f}, {:.3f}) mm, passed through obstacle {} in one "
            "increment",
            at_L->x(), at_L->y(), at_L->z(), prepared_.deck.obstacles[i].name);
      if (why) {
        outcome.stop = fem::NewtonStop::kRejected;
        outcome.reason = *std::move(why);
      }
    }
  }

  /// Largest fraction, at most 1, of the step `du` by which no face passes through an obstacle with
  /// weighted gaps. reject_passages() checks the other obstacles.
  [[nodiscard]] double max_step_length(const VectorX& u, const VectorX& du) const {
    const std::vector<Vec3> x_L = contact::displaced(prepared_.mesh.nodes_L, u);
    const std::vector<Vec3> dx_L =
        contact::displaced(std::vector<Vec3>(x_L.size(), Vec3::Zero()), du);
    double length = 1.0;
    for (const WeightedContact& contact : weighted_)
      length = std::min(length, contact.term.max_step_length(x_L, dx_L));
    return length;
  }
  /// Active sets in the equilibrium `last`, at the poses of its time. Afterwards loads and poses
  /// are those of `time`.
  [[nodiscard]] std::vector<contact::ActiveSet> active_sets(const fem::LoadState& last,
                                                            double time) {
    set_time(last.t);
    const std::vector<Vec3> x_L = contact::displaced(prepared_.mesh.nodes_L, last.u);
    std::vector<contact::ActiveSet> sets;
    for (WeightedContact& contact : weighted_) {
      contact.term.note_clearances(x_L);
      sets.push_back(contact.term.active_set(x_L));
    }
    set_time(time);
    return sets;
  }
  [[nodiscard]] std::vector<contact::WeightedContactTerm*> weighted_contacts() {
    std::vector<contact::WeightedContactTerm*> terms;
    for (WeightedContact& contact : weighted_) terms.push_back(&contact.term);
    return terms;
  }
  [[nodiscard]] bool has_weighted_contact() const { return !weighted_.empty(); }

  /// \returns the outcome kInadmissibleStart if an obstacle with weighted gaps would pass through
  ///   faces between the last equilibrium and `start`; nothing otherwise.
  [[nodiscard]] std::optional<fem::NewtonOutcome> passage_at_start(const fem::LoadState& last,
                                                                   const VectorX& start) const {
    for (const WeightedContact& contact : weighted_) {
      std::vector<RigidTransform> poses;
      for (const std::size_t i : contact.obstacles)
        poses.push_back(geometry::pose_at(prepared_.deck.obstacles[i].path, last.t));
      if (contact.term.max_motion(contact::displaced(prepared_.mesh.nodes_L, last.u), poses,
                                  contact::displaced(prepared_.mesh.nodes_L, start)) == 1.0)
        continue;
      fem::NewtonOutcome outcome;
      outcome.x = start;
      outcome.reason = "an obstacle would pass through faces in one increment";
      return outcome;
    }
    return std::nullopt;
  }

  /// ContactTerm::note_clearances() at an accepted equilibrium.
  void note_clearances(const VectorX& u) {
    const std::vector<Vec3> x_L = contact::displaced(prepared_.mesh.nodes_L, u);
    for (contact::ContactTerm& contact : contacts_) contact.note_clearances(x_L);
  }

  /// Results of a converged state.
  [[nodiscard]] Increment describe(const fem::LoadState& state) const;

  [[nodiscard]] const fem::Assembler& assembler() const { return assembler_; }
  [[nodiscard]] const PreparedDeck& prepared() const { return prepared_; }

 private:
  Problem(const PreparedDeck& prepared, const ObstacleDistanceQueries& distance_queries,
          ElementTerms elements, DeckLoads loads, fem::DofMap dofs)
      : prepared_(prepared),
        elements_(std::move(elements)),
        loads_(std::move(loads)),
        obstacles_(make_obstacles(distance_queries)),
        contact_obstacles_(obstacles_without_weighted_gaps(prepared)),
        contacts_(make_contacts(prepared, contact_obstacles_, distance_queries)),
        weighted_(make_weighted_contacts(prepared, obstacles_)),
        assembler_(prepared.mesh.nodes_L, std::move(dofs), all_terms()) {}

  static std::vector<contact::RigidObstacle> make_obstacles(
      const ObstacleDistanceQueries& distance_queries) {
    std::vector<contact::RigidObstacle> obstacles;
    for (const auto& distance_query : distance_queries)
      obstacles.push_back({.distance_query_B = distance_query});
    return obstacles;
  }

  /// Indices of the obstacles without weighted gaps.
  static std::vector<std::size_t> obstacles_without_weighted_gaps(const PreparedDeck& prepared) {
    std::vector<std::size_t> obstacles;
    for (std::size_t i = 0; i < prepared.deck.obstacles.size(); ++i)
      if (prepared.deck.obstacles[i].integration != contact::Integration::kWeighted)
        obstacles.push_back(i);
    return obstacles;
  }

  static std::vector<contact::ContactTerm> make_contacts(
      const PreparedDeck& prepared, std::span<const std::size_t> obstacles,
      const ObstacleDistanceQueries& distance_queries) {
    std::vector<contact::ContactTerm> contacts;
    for (const std::size_t i : obstacles)
      contacts.push_back(make_contact(prepared, i, distance_queries[i]));
    return contacts;
  }

  [[nodiscard]] std::vector<const fem::ForceTerm*> all_terms() const {
    std::vector<const fem::ForceTerm*> terms;
    for (const auto& term : elements_) terms.push_back(term.get());
    for (const fem::ForceTerm* load : loads_.terms()) terms.push_back(load);
    for (const contact::ContactTerm& contact : contacts_) terms.push_back(&contact);
    for (const WeightedContact& contact : weighted_) terms.push_back(&contact.term);
    return terms;
  }

  const PreparedDeck& prepared_;
  ElementTerms elements_;
  DeckLoads loads_;
  std::vector<contact::RigidObstacle> obstacles_;  ///< At their current poses.
  std::vector<std::size_t> contact_obstacles_;     ///< Of each of contacts_: index of its obstacle.
  std::vector<contact::ContactTerm> contacts_;
  std::vector<WeightedContact> weighted_;
  fem::Assembler assembler_;
};

}  // namespace lefort::solve
