#include <lefort/core/units.h>
#include <lefort/io/internal/read_law.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>

namespace lefort::io::internal {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// The constants of one material; remembers which were asked for, and what was wrong first.
class Constants {
 public:
  explicit Constants(const Json& object) : object_(object) {}

  [[nodiscard]] bool has(const char* key) const { return object_.contains(key); }

  /// Remembers the first complaint.
  void complain(const char* key, const std::string& what) {
    if (!complaint_) complaint_ = fmt::format("constant '{}' {}", key, what);
  }
  /// The key may be there, and is not now.
  void allow(const char* key) { read_keys_.insert(key); }

  /// A number; NaN if it is not there.
  double number(const char* key) {
    const Json* const value = find(key);
    if (value == nullptr) return kNan;
    if (!value->is_number()) return complain(key, "must be a number"), kNan;
    return value->get<double>();
  }
  /// Likewise `otherwise`.
  double number_or(const char* key, double otherwise) {
    if (has(key)) return number(key);
    read_keys_.insert(key);
    return otherwise;
  }
  /// A stress; `key` ends in _kpa.
  double mpa(const char* key) { return mpa_from_kpa(number(key)); }

  /// One to `most` numbers.
  std::vector<double> numbers(const char* key, std::size_t maximum) {
    std::vector<double> values;
    const Json* const list = find(key);
    if (list == nullptr) return values;
    const bool fits = list->is_array() && !list->empty() && list->size() <= maximum;
    if (!fits || !std::all_of(list->begin(), list->end(),
                              [](const Json& value) { return value.is_number(); }))
      return complain(key, fmt::format("must be a list of 1 to {} numbers", maximum)), values;
    for (const Json& value : *list) values.push_back(value.get<double>());
    return values;
  }
  /// One to `most` vectors.
  std::vector<Vec3> vectors(const char* key, std::size_t maximum) {
    std::vector<Vec3> values;
    const Json* const list = find(key);
    if (list == nullptr) return values;
    const auto is_vector = [](const Json& value) {
      return value.is_array() && value.size() == 3 && value[0].is_number() &&
             value[1].is_number() && value[2].is_number();
    };
    if (!list->is_array() || list->empty() || list->size() > maximum ||
        !std::all_of(list->begin(), list->end(), is_vector))
      return complain(key, fmt::format("must be a list of 1 to {} vectors", maximum)), values;
    for (const Json& value : *list) values.push_back(as_vector(value));
    return values;
  }
  /// One of a few words; the first unless it is there.
  std::size_t choice(const char* key, const std::vector<std::string>& words) {
    read_keys_.insert(key);
    const auto found = object_.find(key);
    if (found == object_.end()) return 0;
    for (std::size_t w = 0; w < words.size(); ++w)
      if (*found == words[w]) return w;
    complain(key, fmt::format("must be one of {}", fmt::join(words, ", ")));
    return 0;
  }

  /// \returns nothing, or the first complaint: a required key is missing, or a key is unknown.
  [[nodiscard]] Result<void> finish(const std::string& law) const {
    if (complaint_) return fail(ErrorCode::kPlanInvalid, *complaint_);
    for (const auto& [key, value] : object_.items())
      if (read_keys_.count(key) == 0)
        return fail(ErrorCode::kPlanInvalid, fmt::format("unknown key '{}', law {} takes {}", key,
                                                         law, fmt::join(read_keys_, ", ")));
    return {};
  }

 private:
  const Json* find(const char* key) {
    read_keys_.insert(key);
    const auto found = object_.find(key);
    if (found != object_.end()) return &*found;
    complain(key, "is missing");
    return nullptr;
  }

  const Json& object_;
  std::set<std::string> read_keys_;
  std::optional<std::string> complaint_;
};

/// Young's modulus and Poisson's ratio, or Lame's constants.
template <class Law>
Result<fem::Material> hooke(Constants& c) {
  if (c.has("mu_kpa")) return Law{c.mpa("mu_kpa"), c.mpa("lambda_kpa")};
  const double young_mpa = c.mpa("young_kpa"), poisson = c.number("poisson");
  return Law::from_young_poisson(young_mpa, poisson);
}

/// The part of the change of volume, and of shape.
template <class Shear>
Result<fem::Material> split(Constants& c, Shear shear) {
  using enum fem::VolumetricForm;
  constexpr std::array kForms{kQuadratic, kQuadraticLog, kLogSquared};
  const std::size_t form = c.choice("volumetric", {"quadratic", "quadratic-log", "log-squared"});
  return fem::DecoupledLaw<Shear>{std::move(shear), {kForms[form], c.mpa("bulk_kpa")}};
}

fem::Ogden ogden(Constants& c) {
  fem::Ogden law;
  const std::vector<double> mu_kpa = c.numbers("mu_kpa", law.terms.size());
  const std::vector<double> alpha = c.numbers("alpha", law.terms.size());
  if (mu_kpa.size() != alpha.size()) c.complain("alpha", "must be as many numbers as mu_kpa");
  for (std::size_t p = 0; p < std::min(mu_kpa.size(), alpha.size()); ++p)
    law.terms[p] = {mpa_from_kpa(mu_kpa[p]), alpha[p]};
  return law;
}

/// Three columns, or rows of a symmetric matrix.
Mat3 matrix(Constants& c, const char* key) {
  Mat3 columns = Mat3::Constant(kNan);
  const std::vector<Vec3> vectors = c.vectors(key, 3);
  if (vectors.size() != 3) return c.complain(key, "must be three vectors"), columns;
  for (Index i = 0; i < 3; ++i) columns.col(i) = vectors[std::size_t(i)];
  return columns;
}

fem::FungOrthotropic fung(Constants& c) {
  fem::FungOrthotropic law;
  const std::vector<double> mu_kpa = c.numbers("mu_kpa", 3);
  if (mu_kpa.size() != 3) c.complain("mu_kpa", "must be three numbers");
  for (std::size_t a = 0; a < mu_kpa.size(); ++a) law.mu_mpa[Index(a)] = mpa_from_kpa(mu_kpa[a]);
  law.lambda_mpa = matrix(c, "lambda_kpa") * mpa_from_kpa(1.0);
  law.c_mpa = c.mpa("c_kpa");
  if (c.has("axes"))
    law.axes = matrix(c, "axes").colwise().normalized();
  else
    c.allow("axes");
  return law;
}

fem::HolzapfelGasserOgden fibers(Constants& c) {
  fem::HolzapfelGasserOgden law;
  law.mu_mpa = c.mpa("mu_kpa");
  law.k1_mpa = c.mpa("k1_kpa");
  law.k2 = c.number("k2");
  law.dispersion = c.number_or("dispersion", 0.0);
  const std::vector<Vec3> directions = c.vectors("fibers", law.fiber.size());
  law.family_count = std::max(int(directions.size()), 1);
  for (std::size_t f = 0; f < directions.size(); ++f) law.fiber[f] = directions[f].normalized();
  return law;
}

using ReadLaw = Result<fem::Material> (*)(Constants&);

const std::map<std::string, ReadLaw>& laws() {
  static const std::map<std::string, ReadLaw> all{
      {"fung-orthotropic", [](Constants& c) { return split(c, fung(c)); }},
      {"holzapfel-gasser-ogden", [](Constants& c) { return split(c, fibers(c)); }},
      {"isochoric-neo-hookean",
       [](Constants& c) { return split(c, fem::IsochoricNeoHookean{c.mpa("mu_kpa")}); }},
      {"linear-elastic", hooke<fem::LinearElastic>},
      {"mooney-rivlin",
       [](Constants& c) {
         return split(c, fem::MooneyRivlin{c.mpa("c10_kpa"), c.mpa("c01_kpa")});
       }},
      {"neo-hookean", hooke<fem::NeoHookean>},
      {"ogden", [](Constants& c) { return split(c, ogden(c)); }},
      {"st-venant-kirchhoff", hooke<fem::StVenantKirchhoff>},
      {"yeoh",
       [](Constants& c) {
         return split(c, fem::Yeoh{c.mpa("c10_kpa"), mpa_from_kpa(c.number_or("c20_kpa", 0.0)),
                                   mpa_from_kpa(c.number_or("c30_kpa", 0.0))});
       }},
  };
  return all;
}

}  // namespace

std::vector<std::string> law_names() {
  std::vector<std::string> names;
  for (const auto& [name, read] : laws()) names.push_back(name);
  return names;
}

Result<fem::Material> read_law(const Json& material) {
  const std::string name = material["law"].get<std::string>();
  const auto law = laws().find(name);
  if (law == laws().end())
    return fail(ErrorCode::kPlanInvalid, fmt::format("there is no law '{}', the laws are: {}", name,
                                                     fmt::join(law_names(), ", ")));
  Json constants = material;
  for (const char* key : {"law", "region", "density_kg_m3"}) constants.erase(key);
  Constants requested(constants);
  Result<fem::Material> result = law->second(requested);
  LEFORT_TRY_VOID(requested.finish(name));
  if (!result) return fail(ErrorCode::kPlanInvalid, result.error().message);
  const Result<void> valid =
      std::visit([](const auto& known) -> Result<void> { return known.validate(); }, *result);
  if (!valid) return fail(ErrorCode::kPlanInvalid, valid.error().message);
  return result;
}

}  // namespace lefort::io::internal
