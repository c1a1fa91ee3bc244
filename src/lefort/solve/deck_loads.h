/// \file
/// Tractions, pressures and body forces of a deck as force terms that depend on time.
#pragma once

#include <lefort/core/error.h>
#include <lefort/fem/loads/dead_load.h>
#include <lefort/fem/loads/follower_pressure.h>
#include <lefort/solve/prepare_deck.h>

#include <memory>
#include <span>
#include <vector>

namespace lefort::solve {

/// The loads of one deck, in the order of Deck::tractions, pressures, body_forces.
class DeckLoads {
 public:
  /// \param prepared  the deck.
  /// \returns the loads at time 0; or an error of fem::traction_forces(),
  ///   fem::FollowerPressure::build() or fem::body_forces().
  [[nodiscard]] static Result<DeckLoads> build(const PreparedDeck& prepared);

  /// Must not be called while a term is evaluated.
  void set_time(double time);

  [[nodiscard]] std::vector<const fem::ForceTerm*> terms() const;

  /// Total force of each load on the body [N].
  /// \param x_L  current positions of all nodes [mm].
  [[nodiscard]] std::vector<Vec3> totals_n(std::span<const Vec3> x_L) const;

 private:
  std::vector<std::unique_ptr<fem::DeadLoad>> tractions_;
  std::vector<std::unique_ptr<fem::FollowerPressure>> pressures_;
  std::vector<std::unique_ptr<fem::DeadLoad>> body_forces_;
  std::vector<LoadCurve> traction_curves_, pressure_curves_, body_force_curves_;
  std::vector<double> pressures_mpa_;  ///< At factor 1.
};

}  // namespace lefort::solve
