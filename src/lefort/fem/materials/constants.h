/// \file
/// Checks of material constants.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>

#include <string_view>

namespace lefort::fem {

/// \returns kInvalidArgument, naming `law` and `constant`, unless value > 0 and finite.
[[nodiscard]] Result<void> check_positive(std::string_view law, std::string_view constant,
                                          double value_mpa);

/// \returns kInvalidArgument, naming `law` and `constant`, unless value >= 0 and finite.
[[nodiscard]] Result<void> check_not_negative(std::string_view law, std::string_view constant,
                                              double value_mpa);

/// \returns kInvalidArgument, naming `law` and `direction`, unless |v| = 1 within 1e-9.
[[nodiscard]] Result<void> check_unit(std::string_view law, std::string_view direction,
                                      const Vec3& v);

/// Lame's constants of Hooke's law at small strain.
struct LameConstants {
  double mu_mpa = 0.0;
  double lambda_mpa = 0.0;

  /// \param law        name of the law, for errors.
  /// \param young_mpa  E > 0.
  /// \param poisson    -1 < nu < 0.5.
  /// \returns the constants, or kInvalidArgument.
  [[nodiscard]] static Result<LameConstants> from_young_poisson(std::string_view law,
                                                                double young_mpa, double poisson);

  /// \returns kInvalidArgument, naming `law`, unless mu > 0 and lambda > -2/3 mu.
  [[nodiscard]] Result<void> validate(std::string_view law) const;
};

}  // namespace lefort::fem
