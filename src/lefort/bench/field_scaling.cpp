#include <lefort/bench/field_process.h>
#include <lefort/bench/field_scaling.h>
#include <lefort/core/version.h>
#include <lefort/io/write_atomically.h>
#include <lefort/report/plot_lines.h>

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <string_view>
#include <utility>

namespace lefort::bench {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Large enough for the widest band at 256 cells, and for the coarsest cells.
constexpr double kBandSide_mm = 290.0, kSide_mm = 220.0;
constexpr int kBandCells = 3, kResolution = 256;
/// Beyond these, OpenVDB takes minutes and most of the memory.
constexpr int kMaxOpenVdbResolution = 1024, kMaxOpenVdbParts = 4;

/// One build.
struct Run {
  double abscissa = 0.0;
  double seconds = 0.0;
  double retained_bytes = 0.0;
  double peak_bytes = 0.0;
};

/// A series of builds with one varying quantity.
struct Sweep {
  std::string title;
  std::string quantity;  ///< The varying quantity with its unit.
  std::vector<Run> ours, openvdb;
};

/// Slope of the line through (ln x, ln y) by least squares.
double exponent(const std::vector<Run>& runs, double Run::*of) {
  double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
  const auto n = double(runs.size());
  for (const Run& run : runs) {
    const double u = std::log(run.abscissa), v = std::log(run.*of);
    x += u;
    y += v;
    xx += u * u;
    xy += u * v;
  }
  return (n * xy - x * y) / (n * xx - x * x);
}

Result<Run> measure(const fs::path& skull, Json task, const std::string& method, int repeats,
                    double abscissa, Progress& progress) {
  task["method"] = method;
  task["only_build"] = true;
  task["repeats"] = repeats;
  LEFORT_TRY(const Json result, measure_in_process(skull, task, progress));
  for (const char* key : {"seconds", "retained_bytes", "peak_bytes", "triangles"})
    if (!result.contains(key) || !result.at(key).is_number())
      return fail(ErrorCode::kFileCorrupt,
                  fmt::format("the task {} reported no {}", task.dump(), key));
  return Run{abscissa > 0.0 ? abscissa : result.at("triangles").get<double>(),
             result.at("seconds").get<double>(), result.at("retained_bytes").get<double>(),
             result.at("peak_bytes").get<double>()};
}

std::string table_of(const Sweep& sweep) {
  std::string table =
      fmt::format("## {}\n\n| {} | build s | retained MB | peak MB |", sweep.title, sweep.quantity);
  const bool has_openvdb = !sweep.openvdb.empty();
  if (has_openvdb) table += " OpenVDB s | OpenVDB MB | OpenVDB peak MB |";
  table += has_openvdb ? "\n|---|---|---|---|---|---|---|\n" : "\n|---|---|---|---|\n";
  const auto cells = [](const Run& run) {
    return fmt::format(" {:.3f} | {:.2f} | {:.1f} |", run.seconds, run.retained_bytes * 1e-6,
                       run.peak_bytes * 1e-6);
  };
  for (std::size_t i = 0; i < sweep.ours.size(); ++i) {
    table += fmt::format("| {:.0f} |", sweep.ours[i].abscissa) + cells(sweep.ours[i]);
    if (has_openvdb)
      table += i < sweep.openvdb.size() ? cells(sweep.openvdb[i]) : std::string(" – | – | – |");
    table += "\n";
  }
  const auto exponents = [](const std::vector<Run>& runs) {
    if (runs.size() < 2) return std::string(" – | – | – |");
    return fmt::format(" {:.2f} | {:.2f} | {:.2f} |", exponent(runs, &Run::seconds),
                       exponent(runs, &Run::retained_bytes), exponent(runs, &Run::peak_bytes));
  };
  table += "| **exponent** |" + exponents(sweep.ours);
  if (has_openvdb) table += exponents(sweep.openvdb);
  return table + "\n";
}

std::string plot_of(const Sweep& sweep) {
  report::LinePlot plot;
  plot.title = sweep.title;
  plot.x_label = "log2 of " + sweep.quantity;
  plot.y_label = "s, one thread";
  plot.y_axis = report::Axis::kLog;
  const auto add = [&](const char* name, const std::vector<Run>& runs) {
    report::PlotLine line;
    line.name = name;
    for (const Run& run : runs) {
      line.x.push_back(std::log2(run.abscissa));
      line.y.push_back(run.seconds);
    }
    if (!runs.empty()) plot.lines.push_back(std::move(line));
  };
  add("bricks (our default)", sweep.ours);
  add("OpenVDB", sweep.openvdb);
  return report::plot_lines(plot);
}

/// Builds one field, also with OpenVDB if required, and adds the runs to the sweep.
///
/// \param abscissa  0: the number of triangles.
Result<void> run_point(const fs::path& skull, const ScalingOptions& options, const Json& task,
                       double abscissa, bool with_openvdb, Sweep& sweep, Progress& progress) {
  progress.begin_stage(fmt::format("{}: {}", sweep.title,
                                   abscissa > 0.0 ? fmt::format("{:.0f}", abscissa) : task.dump()));
  LEFORT_TRY(const Run ours, measure(skull, task, "bricks", options.repeats, abscissa, progress));
  sweep.ours.push_back(ours);
  if (!with_openvdb || !options.with_openvdb) return {};
  LEFORT_TRY(const Run openvdb, measure(skull, task, "openvdb", 1, abscissa, progress));
  sweep.openvdb.push_back(openvdb);
  return {};
}

/// Sweeps of band, resolution and triangles.
Result<std::vector<Sweep>> run_sweeps(const fs::path& skull, const ScalingOptions& options,
                                      Progress& progress) {
  Sweep bands{
      fmt::format("Half width of the band, {}³ cells of {:.0f} mm", kResolution, kBandSide_mm),
      "cells",
      {},
      {}};
  Sweep resolutions{
      fmt::format("Resolution, band of {} cells", kBandCells), "cells along a side", {}, {}};
  Sweep triangles{fmt::format("Triangles, {}³, band of {} cells", kResolution, kBandCells),
                  "triangles",
                  {},
                  {}};
  for (const int cells : options.bands)
    LEFORT_TRY_VOID(run_point(
        skull, options,
        {{"resolution", kResolution}, {"half_band_cells", cells}, {"side_mm", kBandSide_mm}}, cells,
        true, bands, progress));
  for (const int resolution : options.resolutions)
    LEFORT_TRY_VOID(run_point(
        skull, options,
        {{"resolution", resolution}, {"half_band_cells", kBandCells}, {"side_mm", kSide_mm}},
        resolution, resolution <= kMaxOpenVdbResolution, resolutions, progress));
  for (const int parts : options.parts)
    LEFORT_TRY_VOID(run_point(skull, options,
                              {{"resolution", kResolution},
                               {"half_band_cells", kBandCells},
                               {"side_mm", kSide_mm},
                               {"parts", parts}},
                              0.0, parts <= kMaxOpenVdbParts, triangles, progress));
  return std::vector<Sweep>{std::move(bands), std::move(resolutions), std::move(triangles)};
}

void add_points(const Sweep& sweep, std::string_view method, const std::vector<Run>& runs,
                std::string& csv, Json& json) {
  for (const Run& point : runs) {
    csv += fmt::format("{},{},{},{:.9g},{},{}\n", sweep.quantity, method, point.abscissa,
                       point.seconds, point.retained_bytes, point.peak_bytes);
    json.push_back({{"sweep", sweep.quantity},
                    {"method", method},
                    {"x", point.abscissa},
                    {"seconds", point.seconds},
                    {"retained_bytes", point.retained_bytes},
                    {"peak_bytes", point.peak_bytes}});
  }
}

}  // namespace

Result<std::string> run_field_scaling(const ScalingOptions& options, Progress& progress) {
  LEFORT_TRY(const fs::path skull, prepare_skull(options.ct, options.output, progress));
  LEFORT_TRY(const std::vector<Sweep> sweeps, run_sweeps(skull, options, progress));
  std::string markdown = fmt::format(
      "# Growth of distance fields of a skull\n\nlefort {}, `lefort bench scaling`. One thread; "
      "our times are medians of {}, OpenVDB's of one build. Peak is above the input.\n\n",
      kVersion, options.repeats);
  std::string plots, csv = "sweep,method,x,seconds,retained_bytes,peak_bytes\n";
  Json json = Json::array();
  for (const Sweep& sweep : sweeps) {
    if (sweep.ours.empty()) continue;
    markdown += table_of(sweep) + "\n";
    plots += plot_of(sweep);
    add_points(sweep, "bricks", sweep.ours, csv, json);
    add_points(sweep, "openvdb", sweep.openvdb, csv, json);
  }
  const std::string page =
      "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><title>Growth of fields</title>"
      "<style>body{font:15px/1.5 sans-serif;max-width:70em;margin:2em auto;padding:0 1em;"
      "color-scheme:light dark}pre{overflow-x:auto}</style>" +
      plots + "<pre>" + markdown + "</pre></html>";
  for (const auto& [name, text] : {std::pair<const char*, std::string>{"scaling.md", markdown},
                                   {"scaling.csv", csv},
                                   {"scaling.json", json.dump(1) + "\n"},
                                   {"scaling.html", page}})
    LEFORT_TRY_VOID(io::write_text(options.output / name, text));
  return markdown;
}

}  // namespace lefort::bench
