#include <lefort/bench/field_process.h>
#include <lefort/bench/measure_field.h>
#include <lefort/bench/table1.h>
#include <lefort/core/version.h>
#include <lefort/io/write_atomically.h>
#include <lefort/report/plot_lines.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

namespace lefort::bench {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// The paper's Table 1: 2009 hardware, 96,190 triangles.
struct PaperRow {
  std::string_view method;
  std::array<double, 3> seconds;
  std::array<double, 3> megabytes;
};
constexpr std::array<int, 3> kPaperResolutions = {128, 256, 512};
constexpr std::array<double, 3> kPaperTolerances = {5e-5, 1e-5, 1e-6};
constexpr std::array<PaperRow, 3> kPaper = {
    PaperRow{"uniform (Fuhrmann et al.)", {3.12, 13.15, 60.62}, {8.4, 67.1, 536.9}},
    PaperRow{"adaptive (Frisken et al.)", {11.78, 107.54, 965.83}, {3.2, 19.9, 99.5}},
    PaperRow{"hybrid (the paper's own)", {4.26, 16.75, 68.15}, {2.9, 18.1, 95.1}}};

const std::map<std::string, std::string, std::less<>> kTitles = {
    {"bricks", "**bricks (our default)**"},
    {"hybrid", "hybrid (the paper's)"},
    {"adaptive", "adaptive (Frisken's)"},
    {"uniform", "uniform (Fuhrmann's)"},
    {"openvdb", "OpenVDB narrow band"},
    {"embree", "Embree at the band samples, unsigned"},
    {"cgal", "CGAL at the band samples, unsigned"}};

double relative_tolerance(int resolution) {
  for (std::size_t i = 0; i < kPaperResolutions.size(); ++i)
    if (kPaperResolutions[i] == resolution) return kPaperTolerances[i];
  return resolution < kPaperResolutions.front() ? kPaperTolerances.front()
                                                : kPaperTolerances.back();
}

/// One measured cell of the table.
struct Cell {
  std::string method;
  int resolution;
  int threads;
  Json result;

  [[nodiscard]] std::optional<double> number(const std::string& pointer) const {
    const Json::json_pointer at(pointer);
    if (!result.contains(at) || !result.at(at).is_number()) return std::nullopt;
    return result.at(at).get<double>();
  }
};

std::string shown(const std::optional<double>& value, double factor, int digits) {
  return value ? fmt::format("{:.{}f}", *value * factor, digits) : "–";
}

std::string error_text(const Cell& cell) {
  const auto mean = cell.number("/error_mm/mean"), p99 = cell.number("/error_mm/p99"),
             max = cell.number("/error_mm/max");
  if (!mean) return "–";
  return fmt::format("{:.4f} / {:.3f} / {:.3f}", *mean, *p99, *max);
}

std::string lattice_text(const Cell& cell) {
  const auto error = cell.number("/lattice_error_mm"), wrong = cell.number("/lattice_wrong_signs");
  if (!error) return "–";
  return fmt::format("{:.1e} / {:.0f}", *error, *wrong);
}

std::string measured_table(const std::vector<Cell>& cells, int resolution) {
  std::string table =
      "| method | threads | build s | retained MB | peak MB | error between samples, mean / P99 / "
      "max mm | at samples, max mm / wrong signs | value M/s | + gradient M/s |\n"
      "|---|---|---|---|---|---|---|---|---|\n";
  for (const Cell& cell : cells) {
    if (cell.resolution != resolution) continue;
    const auto title = kTitles.find(cell.method);
    table += fmt::format("| {} | {} | {} | {} | {} | {} | {} | {} | {} |\n",
                         title == kTitles.end() ? cell.method : title->second, cell.threads,
                         shown(cell.number("/seconds"), 1.0, 3),
                         shown(cell.number("/retained_bytes"), 1e-6, 2),
                         shown(cell.number("/peak_bytes"), 1e-6, 1), error_text(cell),
                         lattice_text(cell), shown(cell.number("/rates/value"), 1e-6, 2),
                         shown(cell.number("/rates/value_and_gradient"), 1e-6, 2));
  }
  return table;
}

const Cell* find(const std::vector<Cell>& cells, std::string_view method, int resolution,
                 int threads = 1) {
  const auto found = std::find_if(cells.begin(), cells.end(), [&](const Cell& cell) {
    return cell.method == method && cell.resolution == resolution && cell.threads == threads;
  });
  return found == cells.end() ? nullptr : &*found;
}

/// Ratios of time, memory and query rate to our default, at each resolution.
std::string ratio_table(const std::vector<Cell>& cells, const std::vector<int>& resolutions) {
  std::string head = "| our default compared with |", rule = "|---|";
  for (const int n : resolutions) {
    head += fmt::format(" {}³ |", n);
    rule += "---|";
  }
  std::string table = head + "\n" + rule + "\n";
  const auto row = [&](const std::string& title, const auto& ratio) {
    table += "| " + title + " |";
    for (const int n : resolutions) {
      const std::optional<double> r = ratio(n);
      table += r ? fmt::format(" {:.{}f} |", *r, *r < 10.0 ? 2 : 1) : " – |";
    }
    table += "\n";
  };
  const auto quotient = [&](const char* method, const char* pointer, bool larger_is_ours) {
    return [&cells, method, pointer, larger_is_ours](int n) -> std::optional<double> {
      const Cell *ours = find(cells, "bricks", n), *other = find(cells, method, n);
      if (ours == nullptr || other == nullptr) return std::nullopt;
      const auto a = ours->number(pointer), b = other->number(pointer);
      if (!a || !b) return std::nullopt;
      return larger_is_ours ? *a / *b : *b / *a;
    };
  };
  row("OpenVDB, build time", quotient("openvdb", "/seconds", false));
  row("Embree at the band samples, time", quotient("embree", "/seconds", false));
  row("CGAL at the band samples, time", quotient("cgal", "/seconds", false));
  row("OpenVDB, retained memory", quotient("openvdb", "/retained_bytes", false));
  row("OpenVDB, value queries", quotient("openvdb", "/rates/value", true));
  row("OpenVDB, value and gradient queries",
      quotient("openvdb", "/rates/value_and_gradient", true));
  row("Embree, value queries", quotient("embree", "/rates/value", true));
  row("CGAL, value queries", quotient("cgal", "/rates/value", true));
  const auto one_by_two = [&](const char* pointer) {
    return [&cells, pointer](int n) -> std::optional<double> {
      const Cell *one = find(cells, "bricks", n), *two = find(cells, "bricks", n, 2);
      if (one == nullptr || two == nullptr) return std::nullopt;
      return *one->number(pointer) / *two->number(pointer);
    };
  };
  row("one thread, by two: time", one_by_two("/seconds"));
  row("one thread, by two: processor time", one_by_two("/processor_seconds"));
  return table;
}

std::string paper_table() {
  std::string table =
      "| paper's Table 1 (2009 hardware) | 128³ s / MB | 256³ s / MB | 512³ s / MB |\n"
      "|---|---|---|---|\n";
  for (const PaperRow& row : kPaper) {
    table += fmt::format("| {} |", row.method);
    for (std::size_t i = 0; i < 3; ++i)
      table += fmt::format(" {:.2f} / {:.1f} |", row.seconds[i], row.megabytes[i]);
    table += "\n";
  }
  return table;
}

std::string csv(const std::vector<Cell>& cells) {
  static constexpr std::array kColumns = {"/seconds",
                                          "/processor_seconds",
                                          "/retained_bytes",
                                          "/peak_bytes",
                                          "/samples",
                                          "/samples_asked",
                                          "/error_mm/mean",
                                          "/error_mm/p99",
                                          "/error_mm/max",
                                          "/wrong_signs",
                                          "/unknown",
                                          "/lattice_error_mm",
                                          "/lattice_wrong_signs",
                                          "/rates/value",
                                          "/rates/value_and_gradient",
                                          "/rates/single"};
  std::string text = "method,resolution,threads";
  for (const std::string_view column : kColumns) {
    std::string name(column.substr(1));
    std::replace(name.begin(), name.end(), '/', '_');
    text += "," + name;
  }
  text += "\n";
  for (const Cell& cell : cells) {
    text += fmt::format("{},{},{}", cell.method, cell.resolution, cell.threads);
    for (const std::string_view column : kColumns) {
      const auto value = cell.number(std::string(column));
      text += value ? fmt::format(",{:.9g}", *value) : ",";
    }
    text += "\n";
  }
  return text;
}

std::string plot(const std::vector<Cell>& cells, const std::string& pointer, double factor,
                 const std::string& title, const std::string& unit) {
  report::LinePlot drawing;
  drawing.title = title;
  drawing.x_label = "cells along a side";
  drawing.y_label = unit;
  drawing.y_axis = report::Axis::kLog;
  std::map<std::string, report::PlotLine> lines;
  std::vector<std::string> order;
  for (const Cell& cell : cells) {
    const auto value = cell.number(pointer);
    if (!value || cell.threads != 1) continue;
    if (!lines.contains(cell.method)) order.push_back(cell.method);
    report::PlotLine& line = lines[cell.method];
    line.name = cell.method;
    line.x.push_back(cell.resolution);
    line.y.push_back(*value * factor);
  }
  for (const std::string& method : order) drawing.lines.push_back(lines.at(method));
  return report::plot_lines(drawing);
}

std::string page(const std::string& markdown, const std::vector<Cell>& cells) {
  return "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><title>Table 1</title>"
         "<style>body{font:15px/1.5 sans-serif;max-width:70em;margin:2em auto;padding:0 1em;"
         "color-scheme:light dark}pre{overflow-x:auto}</style>"
         "<h1>Distance fields of a skull of 96,190 triangles</h1>" +
         plot(cells, "/seconds", 1.0, "Build time, one thread", "s") +
         plot(cells, "/retained_bytes", 1e-6, "Memory kept", "MB") +
         plot(cells, "/rates/value", 1e-6, "Value queries within 0.5 mm, one thread",
              "million points a second") +
         "<pre>" + markdown + "</pre></html>";
}

}  // namespace

Result<std::string> run_table1(const Table1Options& options, Progress& progress) {
  LEFORT_TRY(const fs::path skull, prepare_skull(options.ct, options.output, progress));

  std::vector<Cell> cells;
  for (const int resolution : options.resolutions)
    for (const std::string& method : options.methods)
      for (const int threads : {1, 2}) {
        if (threads == 2 && method != "bricks") continue;
        progress.begin_stage(fmt::format("{} at {}, threads: {}", method, resolution, threads));
        // The slow ones differ by large factors; one run is enough.
        const int repeats = method == "adaptive" || method == "cgal" ? 1 : options.repeats;
        const Json task = {{"method", method},
                           {"resolution", resolution},
                           {"relative_tolerance", relative_tolerance(resolution)},
                           {"threads", threads},
                           {"repeats", repeats}};
        LEFORT_TRY(Json result, measure_in_process(skull, task, progress));
        cells.push_back({method, resolution, threads, std::move(result)});
      }

  std::string markdown = fmt::format(
      "# Distance fields of a skull of 96,190 triangles\n\n"
      "lefort {}, `lefort bench table1`. Cube of 210 mm, samples up to three cells from the "
      "surface. Times are medians of {} (adaptive and CGAL once), each in a separate process; "
      "queries "
      "within "
      "{} mm of the surface, best of five. Peak is above the input. CGAL is queried at no more "
      "than 200,000 samples, and its time is scaled to all.\n\n",
      kVersion, options.repeats, kQueryReach_mm);
  for (const int resolution : options.resolutions)
    markdown += fmt::format("## {}³, tolerance {:g} of the side\n\n{}\n", resolution,
                            relative_tolerance(resolution), measured_table(cells, resolution));
  markdown += "## Ratios\n\n" + ratio_table(cells, options.resolutions) + "\n" +
              "## The paper's own figures, for comparison\n\n" + paper_table();

  Json all = Json::array();
  for (const Cell& cell : cells)
    all.push_back({{"method", cell.method},
                   {"resolution", cell.resolution},
                   {"threads", cell.threads},
                   {"result", cell.result}});
  LEFORT_TRY_VOID(io::write_text(options.output / "table1.json", all.dump(1) + "\n"));
  LEFORT_TRY_VOID(io::write_text(options.output / "table1.csv", csv(cells)));
  LEFORT_TRY_VOID(io::write_text(options.output / "table1.html", page(markdown, cells)));
  LEFORT_TRY_VOID(io::write_text(options.output / "table1.md", markdown));
  return markdown;
}

}  // namespace lefort::bench
