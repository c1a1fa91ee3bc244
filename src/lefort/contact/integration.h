/// \file
/// Formulations of contact that a plan or a deck can choose.
#pragma once

#include <cstdint>
#include <string_view>

namespace lefort::contact {

/// Where the contact potential is integrated.
enum class Integration : std::uint8_t {
  kQuadrature,  ///< At quadrature points inside the faces (contact_term.h).
  kWeighted,    ///< By weighted gaps of the nodes (weighted_contact_term.h).
};

/// Name in plans and results.
[[nodiscard]] constexpr std::string_view name_of(Integration integration) {
  return integration == Integration::kWeighted ? "weighted" : "quadrature";
}

}  // namespace lefort::contact
