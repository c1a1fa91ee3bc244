#include <lefort/pipeline/uncertainty/uncertain_inputs.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace lefort::pipeline {
namespace {

using uncertainty::Distribution;
using uncertainty::DistributionKind;

enum Parameter : std::size_t {
  kInputPoisson,
  kInputSkinRatio,
  kInputLayer,
  kInputContact,
  kInputMargin,
  kInputThreshold,
  kInputLandmarks,
  kInputTranslation,
  kInputRotation,
};

constexpr std::array kInputParameters{
    InputParameter{"poisson", "Poisson's ratio of the deep tissue", "", "tissue",
                   InputEffect::kForces, 0.0, 0.495},
    InputParameter{"skin_ratio_factor",
                   "factor on Young's modulus of skin; that of the deep tissue stays", "", "tissue",
                   InputEffect::kForces, 0.01, 100.0},
    InputParameter{
        "interface_layer_mm",
        "thickness of the elastic layer below sliding tissue; its stiffness is inversely "
        "proportional",
        "mm", "interface", InputEffect::kForces, 0.01, 100.0},
    InputParameter{"contact_stiffness_factor", "factor in the stiffness of contact", "",
                   "interface", InputEffect::kForces, 0.01, 1000.0},
    InputParameter{"elevation_margin_mm",
                   "distance from an osteotomy within which tissue is elevated, on both sides",
                   "mm", "interface", InputEffect::kBoundary, 0.0, 60.0},
    InputParameter{"bone_threshold_hu", "CT number added to the threshold of bone", "HU", "anatomy",
                   InputEffect::kAnatomy, -150.0, 600.0},
    InputParameter{"landmark_error_mm",
                   "factor on one random pattern of unit errors of all landmarks, which place the "
                   "osteotomies",
                   "mm", "anatomy", InputEffect::kAnatomy, -15.0, 15.0},
    InputParameter{"execution_translation_mm",
                   "final position of a segment minus the planned one, along an axis of L", "mm",
                   "execution", InputEffect::kPose, -15.0, 15.0},
    InputParameter{"execution_rotation_deg",
                   "rotation of a segment from its planned final pose about an axis through its "
                   "centroid",
                   "deg", "execution", InputEffect::kPose, -25.0, 25.0},
};

constexpr std::array kAxes{"right-left", "anterior-posterior", "inferior-superior"};
constexpr std::array kTurns{"pitch", "roll", "yaw"};  // About x, y and z of L.

Distribution truncated_normal(double mean, double deviation) {
  constexpr double kDeviations = 3.0;
  return {.kind = DistributionKind::kTruncatedNormal,
          .mean = mean,
          .standard_deviation = deviation,
          .low = mean - kDeviations * deviation,
          .high = mean + kDeviations * deviation};
}

bool has_procedure(const io::PlanFile& plan) {
  return std::any_of(
      plan.segments.begin(), plan.segments.end(),
      [](const plan::PlannedSegment& segment) { return segment.osteotomy.procedure.has_value(); });
}

bool uses_landmarks(const io::PlanFile& plan) {
  return !plan.landmarks.empty() && has_procedure(plan);
}

/// Why a parameter has no effect on a plan; empty if it has.
std::string why_without_effect(const InputParameter& parameter, const io::PlanFile& plan) {
  const bool is_clinical = plan.boundary.interface == predict::TissueInterface::kClinical;
  if (&parameter == &kInputParameters[kInputSkinRatio] && !plan.tissue.skin)
    return "the plan has no material of skin; the deep tissue alone has no ratio";
  if (&parameter == &kInputParameters[kInputLayer] && !is_clinical)
    return "only the interface clinical has sliding tissue";
  if (&parameter == &kInputParameters[kInputContact] &&
      plan.boundary.interface == predict::TissueInterface::kBonded)
    return "the interface bonded has no contact";
  if (&parameter == &kInputParameters[kInputMargin] && !plan.boundary.elevation_margin_mm &&
      is_clinical && has_procedure(plan))
    return "the plan has no elevation margin: those of its procedures hold";
  if (&parameter == &kInputParameters[kInputMargin] && plan.boundary.elevation_margin_mm == 0.0)
    return "the elevation margin of the plan is 0";
  if (&parameter == &kInputParameters[kInputThreshold] && plan.labels)
    return "the plan names labels, so that the scan is not segmented";
  if (&parameter == &kInputParameters[kInputLandmarks] && !uses_landmarks(plan))
    return "no osteotomy of the plan is placed by landmarks";
  return {};
}

/// Levels without round-off, so that the middle one is that of the plan.
Distribution rounded(Distribution levels) {
  constexpr double kStep = 1e-6;
  for (double& value : levels.values) value = std::round(value / kStep) * kStep + 0.0;
  return levels;
}

Result<UncertainInput> make_input(const InputEntry& entry) {
  UncertainInput input{.name = entry.parameter->name,
                       .parameter = entry.parameter,
                       .distribution = entry.distribution,
                       .sampled = entry.distribution,
                       .source = entry.source};
  constexpr double kTail = 1e-3;
  for (const double p : {kTail, 1.0 - kTail}) {
    const double value = uncertainty::quantile(entry.distribution, p);
    if (!(value >= entry.parameter->low && value <= entry.parameter->high))
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("input {}: the quantile of {:g} % is {:g}, must be from {:g} to {:g}",
                              entry.parameter->name, 100.0 * p, value, entry.parameter->low,
                              entry.parameter->high));
  }
  if (input.is_in_levels() && entry.distribution.kind != DistributionKind::kDiscrete)
    input.sampled = rounded(uncertainty::gauss_levels(entry.distribution, entry.levels));
  return input;
}

Result<void> add_execution(const InputEntry& entry, const io::PlanFile& plan, InputsOfPlan& all) {
  LEFORT_TRY(UncertainInput input, make_input(entry));
  const bool is_rotation = entry.parameter == &kInputParameters[kInputRotation];
  bool is_found = false;
  for (std::size_t k = 0; k < plan.segments.size(); ++k) {
    const std::string& segment = plan.segments[k].osteotomy.segment;
    if (entry.segment && *entry.segment != segment) continue;
    is_found = true;
    for (int axis = 0; axis < 3; ++axis) {
      input.name = fmt::format("{} {}", segment, (is_rotation ? kTurns : kAxes)[std::size_t(axis)]);
      input.segment = k;
      input.axis = axis;
      all.inputs.push_back(input);
    }
  }
  if (!is_found)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("input {}: the plan has no segment {}", entry.parameter->name,
                            entry.segment.value_or("")));
  return {};
}

}  // namespace

std::span<const InputParameter> input_parameters() { return kInputParameters; }

int UncertainInput::max_degree() const {
  constexpr int kMax = 10;
  return sampled.kind == DistributionKind::kDiscrete
             ? std::min(kMax, int(sampled.values.size()) - 1)
             : kMax;
}

double UncertainInput::center() const {
  if (sampled.kind == DistributionKind::kDiscrete) return sampled.values[sampled.values.size() / 2];
  return uncertainty::quantile(sampled, 0.5);
}

std::vector<InputEntry> default_inputs(const io::PlanFile& plan) {
  const auto entry = [](Parameter parameter, Distribution distribution, const char* source) {
    return InputEntry{.parameter = &kInputParameters[parameter],
                      .distribution = std::move(distribution),
                      .segment = {},
                      .levels = 3,
                      .source = source};
  };
  const auto lognormal = [](double mean, double ratio) {
    return Distribution{
        .kind = DistributionKind::kLogNormal, .mean = mean, .standard_deviation = ratio * mean};
  };
  const double margin_mm = plan.boundary.elevation_margin_mm.value_or(predict::kElevationMargin_mm);
  return {
      entry(kInputPoisson, {.kind = DistributionKind::kUniform, .low = 0.40, .high = 0.49},
            "0.49 in Nazari 2010, 0.45 by default (docs/theory/materials.md); range and shape "
            "assumed"),
      entry(kInputSkinRatio, lognormal(1.0, 0.5),
            "ArtiSynth: factor 0.5 for younger and 2 for older skin (docs/theory/materials.md); "
            "shape assumed"),
      entry(
          kInputLayer, lognormal(plan.boundary.interface_layer_mm, 0.6),
          "assumed: no measurement is known; P5 to P95 is 0.3 to 2.1 times the value of the plan"),
      entry(kInputContact, lognormal(predict::stiffness_factor(plan.contact, plan.tissue), 0.5),
            "assumed: numerical parameter, varied by a factor of about 2"),
      entry(kInputMargin, truncated_normal(margin_mm, margin_mm / 4.0),
            "assumed: surgical descriptions, no measurements (docs/theory/interface.md)"),
      entry(kInputThreshold, truncated_normal(0.0, 50.0),
            "assumed: difference of readers and of scanner calibration at the border of bone"),
      entry(kInputLandmarks, truncated_normal(0.0, 1.0),
            "assumed: landmarks placed by readers repeat to about 1 mm along each axis (Swennen "
            "2006, recalled)"),
      entry(kInputTranslation, truncated_normal(0.0, 1.0),
            "Hsu 2013: largest root mean square difference of planned and achieved centroid 1.0 mm "
            "(maxilla), 1.1 mm (mandible); recalled"),
      entry(kInputRotation, truncated_normal(0.0, 1.5),
            "Hsu 2013: largest root mean square difference of planned and achieved orientation 1.5 "
            "deg (maxilla), 1.8 deg (mandible); recalled"),
  };
}

Result<void> check_design(std::span<const UncertainInput> inputs, const Eigen::MatrixXd& points) {
  for (Index sample = 0; sample < points.rows(); ++sample)
    for (std::size_t n = 0; n < inputs.size(); ++n) {
      const InputParameter& parameter = *inputs[n].parameter;
      const double value = points(sample, Index(n));
      if (!(value >= parameter.low && value <= parameter.high))
        return fail(
            ErrorCode::kInvalidArgument,
            fmt::format("input {}: sample {} has the value {:g}, must be from {:g} to {:g}: "
                        "use a distribution with limits, or fewer levels",
                        inputs[n].name, sample, value, parameter.low, parameter.high));
    }
  return {};
}

Result<InputsOfPlan> inputs_of_plan(std::span<const InputEntry> entries, const io::PlanFile& plan) {
  InputsOfPlan all;
  for (std::size_t n = 0; n < entries.size(); ++n) {
    const InputEntry& entry = entries[n];
    const bool is_repeated = std::any_of(
        entries.begin(), entries.begin() + std::ptrdiff_t(n), [&](const InputEntry& earlier) {
          return earlier.parameter == entry.parameter &&
                 (!earlier.segment || !entry.segment || earlier.segment == entry.segment);
        });
    if (is_repeated)
      return fail(
          ErrorCode::kInvalidArgument,
          fmt::format("input {} is given twice, must be given once", entry.parameter->name));
    if (std::string why = why_without_effect(*entry.parameter, plan); !why.empty()) {
      all.without_effect.push_back(fmt::format("{}: {}", entry.parameter->name, why));
      continue;
    }
    if (entry.parameter->effect == InputEffect::kPose) {
      LEFORT_TRY_VOID(add_execution(entry, plan, all));
      continue;
    }
    if (entry.segment)
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("input {}: has no segment; only the execution error has one",
                              entry.parameter->name));
    LEFORT_TRY(all.inputs.emplace_back(), make_input(entry));
  }
  if (all.inputs.empty())
    return fail(ErrorCode::kInvalidArgument, "no input has an effect on the plan");
  return all;
}

}  // namespace lefort::pipeline
