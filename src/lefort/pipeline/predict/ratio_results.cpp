#include <lefort/pipeline/predict/ratio_results.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <string>
#include <utility>

namespace lefort::pipeline {
namespace {

using compare::RatioSource;
using compare::SoftTissueRatio;
using Json = nlohmann::ordered_json;

Json published_json(const SoftTissueRatio& ratio) {
  if (!ratio.published) return nullptr;
  return {{"low", ratio.published->low},
          {"high", ratio.published->high},
          {"sources", ratio.published->sources},
          {"recalled", ratio.published->is_recalled},
          {"inside", ratio.published->contains(ratio.ratio())}};
}

const RatioSource* find_source(std::string_view key) {
  for (const RatioSource& source : compare::ratio_sources())
    if (source.key == key) return &source;
  return nullptr;
}

/// "0.69 to 0.95"; "1.00 (mean)" of a single value.
std::string range_in_words(const compare::PublishedRange& range) {
  if (!(range.low < range.high)) return fmt::format("{:.2f} (mean)", range.low);
  return fmt::format("{:.2f} to {:.2f}", range.low, range.high);
}

std::string sources_in_words(const compare::PublishedRange& range) {
  std::string words;
  for (const std::string_view key : range.sources)
    if (const RatioSource* source = find_source(key))
      words += (words.empty() ? "" : "; ") + std::string(source->label);
  return words + (range.is_recalled ? " (some figures not compared with the article)" : "");
}

std::vector<std::string> row_of(const SoftTissueRatio& ratio) {
  std::vector<std::string> row{
      fmt::format("{}: {}, {}", ratio.segment, compare::title_of(ratio.procedure),
                  compare::name_of(ratio.direction)),
      fmt::format("{}{}", compare::name_of(ratio.axis), ratio.is_main_axis ? " (main)" : ""),
      fmt::format("{} : {}", ratio.soft, ratio.hard),
      fmt::format("{:.2f}", ratio.soft_mm),
      fmt::format("{:.2f}", ratio.hard_mm),
      fmt::format("{:.2f}", ratio.ratio())};
  if (!ratio.published) {
    row.insert(row.end(), {"No published range is known for this movement.", "\u2013", "\u2013"});
    return row;
  }
  row.push_back(range_in_words(*ratio.published));
  row.push_back(ratio.published->contains(ratio.ratio()) ? "yes" : "no");
  row.push_back(sources_in_words(*ratio.published));
  return row;
}

Json by_interface_json(const ExplainedRatio& explained) {
  if (!explained.by_interface) return nullptr;
  return {{"attached", explained.by_interface->attached},
          {"contact", explained.by_interface->contact}};
}

/// A line for each ratio outside its published range.
report::ReportTable deviation_table(std::span<const ExplainedRatio> ratios) {
  report::ReportTable table{
      "Ratios outside the published range, and possible reasons", {"ratio", "reasons"}, {}};
  for (const ExplainedRatio& one : ratios)
    if (deviates(one.ratio))
      table.rows.push_back({fmt::format("{}, {} : {}, {}", one.ratio.segment, one.ratio.soft,
                                        one.ratio.hard, compare::name_of(one.ratio.axis)),
                            fmt::format("{}", fmt::join(deviation_reasons(one), " "))});
  return table;
}

/// The references of all published ranges of `ratios`, by key.
report::ReportTable source_table(std::span<const ExplainedRatio> ratios) {
  report::ReportTable table{"Sources of the published ranges", {"source", "reference"}, {}};
  for (const RatioSource& source : compare::ratio_sources()) {
    const bool is_used = std::any_of(ratios.begin(), ratios.end(), [&](const auto& explained) {
      const auto& published = explained.ratio.published;
      return published && std::find(published->sources.begin(), published->sources.end(),
                                    source.key) != published->sources.end();
    });
    if (is_used) table.rows.push_back({std::string(source.label), std::string(source.reference)});
  }
  return table;
}

}  // namespace

Json ratios_json(std::span<const ExplainedRatio> ratios) {
  Json list = Json::array();
  for (const ExplainedRatio& explained : ratios) {
    const SoftTissueRatio& ratio = explained.ratio;
    list.push_back({{"segment", ratio.segment},
                    {"procedure", compare::name_of(ratio.procedure)},
                    {"direction", compare::name_of(ratio.direction)},
                    {"axis", compare::name_of(ratio.axis)},
                    {"main_axis", ratio.is_main_axis},
                    {"soft", ratio.soft},
                    {"hard", ratio.hard},
                    {"soft_mm", ratio.soft_mm},
                    {"hard_mm", ratio.hard_mm},
                    {"ratio", ratio.ratio()},
                    {"published", published_json(ratio)},
                    {"by_interface", by_interface_json(explained)},
                    {"deviation_reasons", deviation_reasons(explained)}});
  }
  return list;
}

std::vector<report::ReportTable> ratio_tables(std::span<const ExplainedRatio> ratios) {
  if (ratios.empty()) return {};
  report::ReportTable table{"Soft tissue to bone: movement of the skin over that of the bone",
                            {"segment", "axis", "skin : bone", "skin [mm]", "bone [mm]", "ratio",
                             "published", "within the published range", "source"},
                            {}};
  for (const ExplainedRatio& one : ratios) table.rows.push_back(row_of(one.ratio));
  std::vector<report::ReportTable> tables{std::move(table)};
  std::array more{deviation_table(ratios), source_table(ratios)};
  for (report::ReportTable& one : more)
    if (!one.rows.empty()) tables.push_back(std::move(one));
  return tables;
}

}  // namespace lefort::pipeline
