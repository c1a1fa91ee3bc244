#include <lefort/core/units.h>
#include <lefort/pipeline/validate/calibration_parameters.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace lefort::pipeline {
namespace {

using Json = nlohmann::ordered_json;

Json law(double young_mpa, double poisson) {
  return {{"law", "neo-hookean"}, {"young_kpa", kpa_from_mpa(young_mpa)}, {"poisson", poisson}};
}

/// A plan without skin gets the default one, whose layer is meshed.
predict::SkinOptions skin_of(const io::PlanFile& plan) {
  return plan.tissue.skin.value_or(predict::SkinOptions{});
}

double get_skin_ratio(const io::PlanFile& plan) {
  return skin_of(plan).young_mpa / plan.tissue.young_mpa;
}

void set_skin_ratio(io::PlanFile& plan, double ratio) {
  plan.tissue.skin = skin_of(plan);
  plan.tissue.skin->young_mpa = ratio * plan.tissue.young_mpa;
}

Json keys_of_skin_ratio(const io::PlanFile& plan, double ratio) {
  const predict::SkinOptions skin = skin_of(plan);
  return {{"tissue",
           {{"skin",
             {{"thickness_mm", skin.thickness_mm},
              {"layers", skin.layers},
              {"material", law(ratio * plan.tissue.young_mpa, skin.poisson)}}}}}};
}

double get_margin(const io::PlanFile& plan) {
  return plan.boundary.elevation_margin_mm.value_or(predict::kElevationMargin_mm);
}

void set_margin(io::PlanFile& plan, double margin_mm) {
  plan.boundary.elevation_margin_mm = margin_mm;
}

Json keys_of_margin(const io::PlanFile&, double margin_mm) {
  return {{"boundary", {{"elevation_margin_mm", margin_mm}}}};
}

double get_layer(const io::PlanFile& plan) { return plan.boundary.interface_layer_mm; }

void set_layer(io::PlanFile& plan, double layer_mm) { plan.boundary.interface_layer_mm = layer_mm; }

Json keys_of_layer(const io::PlanFile&, double layer_mm) {
  return {{"boundary", {{"interface_layer_mm", layer_mm}}}};
}

double get_poisson(const io::PlanFile& plan) { return plan.tissue.poisson; }

void set_poisson(io::PlanFile& plan, double poisson) { plan.tissue.poisson = poisson; }

Json keys_of_poisson(const io::PlanFile& plan, double poisson) {
  return {{"tissue", {{"material", law(plan.tissue.young_mpa, poisson)}}}};
}

constexpr std::array kParameters{
    CalibrationParameter{"skin_ratio", "Young's modulus of skin over that of the deep tissue", 1.0,
                         30.0, true, 0.2, false, get_skin_ratio, set_skin_ratio,
                         keys_of_skin_ratio},
    CalibrationParameter{"elevation_margin_mm",
                         "distance from an osteotomy within which tissue is elevated [mm]", 2.0,
                         40.0, false, 3.0, true, get_margin, set_margin, keys_of_margin},
    CalibrationParameter{"interface_layer_mm",
                         "thickness of the elastic layer below sliding tissue [mm]; "
                         "its stiffness k_n is inversely proportional",
                         0.1, 20.0, true, 0.3, false, get_layer, set_layer, keys_of_layer},
    CalibrationParameter{"poisson", "Poisson's ratio of the deep tissue", 0.3, 0.49, false, 0.02,
                         false, get_poisson, set_poisson, keys_of_poisson},
};

}  // namespace

double CalibrationParameter::coordinate(double value) const {
  const double fraction =
      is_logarithmic ? std::log(value / low) / std::log(high / low) : (value - low) / (high - low);
  return std::clamp(fraction, 0.0, 1.0);
}

double CalibrationParameter::value(double coordinate) const {
  return is_logarithmic ? low * std::pow(high / low, coordinate) : low + coordinate * (high - low);
}

double CalibrationParameter::coordinate_step() const {
  return step / (is_logarithmic ? std::log(high / low) : high - low);
}

std::span<const CalibrationParameter> calibration_parameters() { return kParameters; }

std::vector<std::string> default_parameters() { return {"skin_ratio", "poisson"}; }

Result<std::vector<CalibrationParameter>> find_parameters(std::span<const std::string> names) {
  std::vector<CalibrationParameter> found;
  for (const std::string& name : names) {
    const auto known = std::find_if(kParameters.begin(), kParameters.end(),
                                    [&](const auto& one) { return name == one.name; });
    if (known == kParameters.end()) {
      std::string all;
      for (const CalibrationParameter& one : kParameters)
        all += fmt::format("{}{}", all.empty() ? "" : ", ", one.name);
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("there is no parameter {}, must be one of {}", name, all));
    }
    for (const CalibrationParameter& earlier : found)
      if (name == earlier.name)
        return fail(ErrorCode::kInvalidArgument,
                    fmt::format("the parameter {} is named twice, must be named once", name));
    found.push_back(*known);
  }
  return found;
}

}  // namespace lefort::pipeline
