#include <lefort/io/read_text.h>
#include <lefort/io/uncertain_inputs_schema.h>
#include <lefort/io/validate_json.h>
#include <lefort/pipeline/uncertainty/inputs_json.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace lefort::pipeline {
namespace {

using Json = nlohmann::ordered_json;
using uncertainty::Distribution;
using uncertainty::DistributionKind;

constexpr std::array kKinds{DistributionKind::kNormal,     DistributionKind::kTruncatedNormal,
                            DistributionKind::kUniform,    DistributionKind::kLogNormal,
                            DistributionKind::kTriangular, DistributionKind::kDiscrete};

/// Names of the numbers that a kind needs.
std::vector<const char*> keys_of(DistributionKind kind) {
  switch (kind) {
    case DistributionKind::kTruncatedNormal:
      return {"mean", "standard_deviation", "low", "high"};
    case DistributionKind::kUniform:
      return {"low", "high"};
    case DistributionKind::kTriangular:
      return {"low", "mode", "high"};
    case DistributionKind::kDiscrete:
      return {"values", "probabilities"};
    default:
      return {"mean", "standard_deviation"};
  }
}

/// \pre `json` passes the schema.
Result<Distribution> parse_distribution(const Json& json, const std::string& name) {
  Distribution read;
  const auto kind = json.at("kind").get<std::string>();
  for (const DistributionKind one : kKinds)
    if (name_of(one) == kind) read.kind = one;
  const std::vector<const char*> keys = keys_of(read.kind);
  for (const char* key : keys)
    if (!json.contains(key))
      return fail(ErrorCode::kPlanInvalid,
                  fmt::format("input {}: the distribution {} needs the key {}", name, kind, key));
  for (const auto& [key, value] : json.items())
    if (key != "kind" && std::find_if(keys.begin(), keys.end(), [&](const char* known) {
                           return key == known;
                         }) == keys.end())
      return fail(ErrorCode::kPlanInvalid,
                  fmt::format("input {}: the distribution {} has no key {}", name, kind, key));
  if (json.contains("mean")) read.mean = json.at("mean").get<double>();
  if (json.contains("standard_deviation"))
    read.standard_deviation = json.at("standard_deviation").get<double>();
  if (json.contains("low")) read.low = json.at("low").get<double>();
  if (json.contains("high")) read.high = json.at("high").get<double>();
  if (json.contains("mode")) read.mode = json.at("mode").get<double>();
  if (json.contains("values")) read.values = json.at("values").get<std::vector<double>>();
  if (json.contains("probabilities"))
    read.probabilities = json.at("probabilities").get<std::vector<double>>();
  LEFORT_TRY_VOID(uncertainty::check_distribution(read, name));
  return read;
}

}  // namespace

Json as_json(const Distribution& distribution) {
  Json json{{"kind", name_of(distribution.kind)}};
  for (const std::string key : keys_of(distribution.kind)) {
    if (key == "mean") json[key] = distribution.mean;
    if (key == "standard_deviation") json[key] = distribution.standard_deviation;
    if (key == "low") json[key] = distribution.low;
    if (key == "high") json[key] = distribution.high;
    if (key == "mode") json[key] = distribution.mode;
    if (key == "values") json[key] = distribution.values;
    if (key == "probabilities") json[key] = distribution.probabilities;
  }
  return json;
}

Json as_json(std::span<const InputEntry> entries) {
  Json json{{"lefort_uncertain_inputs", 1}, {"inputs", Json::array()}};
  for (const InputEntry& entry : entries) {
    Json one{{"parameter", entry.parameter->name},
             {"distribution", pipeline::as_json(entry.distribution)},
             {"source", entry.source}};
    if (entry.segment) one["segment"] = *entry.segment;
    const bool has_levels = entry.parameter->effect == InputEffect::kBoundary ||
                            entry.parameter->effect == InputEffect::kAnatomy;
    if (has_levels && entry.distribution.kind != DistributionKind::kDiscrete)
      one["levels"] = entry.levels;
    json["inputs"].push_back(std::move(one));
  }
  return json;
}

Result<std::vector<InputEntry>> read_inputs(const std::filesystem::path& file) {
  constexpr std::uintmax_t kMaxBytes = 1 << 20;
  LEFORT_TRY(const std::string text, io::read_text(file, kMaxBytes));
  LEFORT_TRY_VOID(io::validate_json(text, io::kUncertainInputsSchema, "uncertain inputs"));
  std::vector<InputEntry> entries;
  const Json json = Json::parse(text);
  for (const Json& one : json.at("inputs")) {
    InputEntry entry;
    const auto name = one.at("parameter").get<std::string>();
    for (const InputParameter& parameter : input_parameters())
      if (name == parameter.name) entry.parameter = &parameter;
    LEFORT_TRY(entry.distribution, parse_distribution(one.at("distribution"), name));
    entry.source = one.at("source").get<std::string>();
    if (one.contains("segment")) entry.segment = one.at("segment").get<std::string>();
    if (one.contains("levels")) entry.levels = one.at("levels").get<int>();
    entries.push_back(std::move(entry));
  }
  return entries;
}

}  // namespace lefort::pipeline
