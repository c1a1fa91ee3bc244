#include <lefort/report/mesh_plots.h>
#include <lefort/report/plot_lines.h>

#include <fmt/format.h>

#include <span>

namespace lefort::report {
namespace {

/// \returns the outline of a histogram over [0, end]; empty bins are gaps on the log axis.
PlotLine outline(std::string name, std::span<const Index> bins, double end) {
  Index all = 0;
  for (const Index count : bins) all += count;
  PlotLine line{std::move(name), {}, {}};
  for (std::size_t b = 0; b < bins.size(); ++b)
    for (const std::size_t edge : {b, b + 1}) {
      line.x.push_back(end * double(edge) / double(bins.size()));
      line.y.push_back(all > 0 ? 100.0 * double(bins[b]) / double(all) : 0.0);
    }
  return line;
}

}  // namespace

std::vector<std::pair<std::string, std::string>> mesh_plots(const mesh::MeshQuality& quality) {
  LinePlot jacobian{.title = "Scaled Jacobians of the elements",
                    .x_label = "scaled Jacobian, 1 if ideal",
                    .y_label = "fraction of the elements of one shape [%]",
                    .y_axis = Axis::kLog};
  LinePlot dihedral{.title = "Smallest dihedral angles of the elements",
                    .x_label = "smallest dihedral angle [degrees]",
                    .y_label = "fraction of the elements of one shape [%]",
                    .y_axis = Axis::kLog};
  for (const auto& [shape, summary] : quality.by_shape) {
    const std::string name = fmt::format("{}, {} elements", mesh::name_of(shape), summary.elements);
    jacobian.lines.push_back(
        outline(fmt::format("{}, min {:.3f}", name, summary.min_scaled_jacobian),
                summary.jacobian_histogram, 1.0));
    dihedral.lines.push_back(
        outline(fmt::format("{}, min {:.1f}\u00b0", name, summary.min_dihedral_deg),
                summary.dihedral_histogram, 90.0));
  }
  return {{"mesh_scaled_jacobian.svg", plot_file(jacobian)},
          {"mesh_dihedral.svg", plot_file(dihedral)}};
}

}  // namespace lefort::report
