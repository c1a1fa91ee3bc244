#include <lefort/field/query/lattice_samples.h>
#include <lefort/io/field_file.h>
#include <lefort/pipeline/field.h>

#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

namespace lefort::pipeline {
namespace {

using field::DistanceField;

const char* kind_of(const DistanceField& distance) {
  constexpr std::array<const char*, 3> kNames{"bricks", "octree", "dense"};
  return kNames.at(distance.samples().index());
}

struct Part {
  const char* name;
  std::size_t bytes;
};

/// Memory of the parts of a field when it is queried.
std::vector<Part> memory_of(const DistanceField& distance) {
  std::vector<Part> parts;
  if (const auto* bricks = std::get_if<field::BrickSamples>(&distance.samples())) {
    parts.push_back({"brick_table", bricks->bricks().size_bytes()});
    parts.push_back({"codes", bricks->codes().size_bytes()});
  } else if (const auto* octree = std::get_if<field::Octree>(&distance.samples())) {
    parts.push_back({"tree_and_index", octree->bytes() - octree->samples().size_bytes()});
    parts.push_back({"samples", octree->samples().size_bytes()});
  } else {
    parts.push_back({"samples", distance.sample_bytes()});
  }
  if (distance.is_smooth()) parts.push_back({"smooth_lattice", distance.smooth_bytes()});
  return parts;
}

std::vector<std::pair<const char*, Index>> findings_of(const field::MeshRepairReport& report) {
  return {{"duplicate_vertices", report.duplicate_vertices},
          {"degenerate_triangles", report.degenerate_triangles},
          {"duplicate_triangles", report.duplicate_triangles},
          {"opposite_duplicates", report.opposite_duplicates},
          {"flipped_triangles", report.flipped_triangles},
          {"boundary_edges", report.boundary_edges},
          {"non_manifold_edges", report.non_manifold_edges},
          {"inconsistent_edges", report.inconsistent_edges}};
}

void report_source(const DistanceField& distance, Summary& summary) {
  if (!distance.source()) {
    summary.text += "surface: not described in this file; build the field again\n";
    summary.json["surface"] = nullptr;
    return;
  }
  const field::FieldSource& source = *distance.source();
  summary.text += fmt::format(
      "surface: {}, {} triangles in {} {}\n", distance.frame().closed ? "closed" : "open",
      source.triangles, source.components, source.components == 1 ? "component" : "components");
  for (const std::string& sentence : field::describe(source.report))
    summary.text += fmt::format("  {}\n", sentence);
  nlohmann::json& json = summary.json["surface"];
  json = {{"triangles", source.triangles}, {"components", source.components}};
  for (const auto& [name, count] : findings_of(source.report)) json[name] = count;
}

}  // namespace

Result<Summary> describe_field(const std::filesystem::path& file, Progress& progress) {
  progress.begin_stage("read");
  LEFORT_TRY(const DistanceField distance, io::read_field(file));
  progress.begin_stage("count the samples");
  LEFORT_TRY(const field::SampleCount count, field::count_samples(distance, progress));
  const field::FieldFrame& frame = distance.frame();
  const Box3 box = distance.box_B();
  std::error_code error;
  const std::uintmax_t file_bytes = std::filesystem::file_size(file, error);

  Summary summary;
  summary.json = {{"field", file.string()},
                  {"checksum", "ok"},  // Checked when the file was read.
                  {"file_bytes", error ? 0 : file_bytes},
                  {"kind", kind_of(distance)},
                  {"smooth", distance.is_smooth()},
                  {"closed", frame.closed},
                  {"resolution", frame.resolution},
                  {"cell_mm", frame.cell_mm},
                  {"band_mm", frame.band_mm},
                  {"guaranteed_mm", frame.guaranteed_mm()},
                  {"tolerance_mm", frame.tolerance_mm},
                  {"low_mm", {box.min().x(), box.min().y(), box.min().z()}},
                  {"high_mm", {box.max().x(), box.max().y(), box.max().z()}},
                  {"samples_in_band", count.known},
                  {"samples_outside", count.outside},
                  {"samples_inside", count.inside},
                  {"samples_unknown", count.unknown}};
  summary.text = fmt::format(
      "{}: {}{}, file complete (checksum ok), {:.1f} MB\n"
      "domain: {}^3 cells of {:.6g} mm, from ({:.6g}, {:.6g}, {:.6g}) to ({:.6g}, {:.6g}, {:.6g}) "
      "mm\n"
      "band: samples to {:.6g} mm, every point to {:.6g} mm\n",
      file.string(), kind_of(distance), distance.is_smooth() ? " and a smooth lattice" : "",
      double(file_bytes) * 1e-6, frame.resolution, frame.cell_mm, box.min().x(), box.min().y(),
      box.min().z(), box.max().x(), box.max().y(), box.max().z(), frame.band_mm,
      frame.guaranteed_mm());
  if (std::holds_alternative<field::Octree>(distance.samples()))
    summary.text += fmt::format("tolerance: {:.6g} mm\n", frame.tolerance_mm);
  const double percent = 100.0 / double(count.total());
  summary.text += fmt::format(
      "samples: {} in the band ({:.1f} %), beyond it {} outside, {} inside, {} unknown\n",
      count.known, double(count.known) * percent, count.outside, count.inside, count.unknown);
  report_source(distance, summary);
  summary.text += "memory:";
  std::string_view between = " ";
  for (const auto& [name, bytes] : memory_of(distance)) {
    summary.text += fmt::format("{}{} {:.3f} MB", between, name, double(bytes) * 1e-6);
    summary.json["memory_bytes"][name] = bytes;
    between = ", ";
  }
  return summary;
}

}  // namespace lefort::pipeline
