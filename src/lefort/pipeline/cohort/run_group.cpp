#include <lefort/core/version.h>
#include <lefort/io/output_folder.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/cohort/group_report.h>
#include <lefort/pipeline/run.h>
#include <lefort/report/plot_lines.h>
#include <lefort/report/report_html.h>

#include <fmt/format.h>

#include <array>

namespace lefort::pipeline {

namespace fs = std::filesystem;

Result<Summary> run_group(const RunJob& job, Progress& progress) {
  LEFORT_TRY(const GroupResults results, collect_group(job, progress));
  const io::EmptyFolderCleanup cleanup(job.output);
  LEFORT_TRY_VOID(io::make_output_folder(job.output));
  const fs::path page = job.output / "report.html", document = job.output / "group.json",
                 figures = job.output / "figures";
  LEFORT_TRY_VOID(
      io::remove_earlier_files(std::array{document, page, figures / "displacement.svg",
                                          figures / "difference.svg", figures / "error.svg"}));
  progress.begin_stage("write the report");
  LEFORT_TRY_VOID(io::make_output_folder(figures));
  for (auto& [name, plot] : group_plots(results)) {
    plot.x_label += fmt::format(" ({})", kNotForClinicalUse);  // A figure is used without its page.
    LEFORT_TRY_VOID(io::write_text(figures / name, report::plot_file(plot)));
  }
  LEFORT_TRY_VOID(io::write_text(job.output / "group.csv", group_csv(results)));
  LEFORT_TRY_VOID(io::write_text(job.output / "regions.csv", regions_csv(results)));
  LEFORT_TRY_VOID(io::write_text(page, report::report_html(group_report(results))));
  const auto json = group_json(results);
  LEFORT_TRY_VOID(io::write_text(document, json.dump(2) + "\n"));
  return Summary{job.output.string() + ": " + group_text(results), json};
}

}  // namespace lefort::pipeline
