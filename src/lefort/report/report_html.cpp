#include <lefort/core/version.h>
#include <lefort/report/annotate.h>
#include <lefort/report/internal/base64.h>
#include <lefort/report/internal/page_style.h>
#include <lefort/report/internal/plain_text.h>
#include <lefort/report/plot_lines.h>
#include <lefort/report/report_html.h>
#include <lefort/report/solver_plots.h>

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

namespace lefort::report {

namespace {

/// \returns `markup` under a heading, or nothing if it is empty.
std::string section(std::string_view heading, const std::string& markup) {
  if (markup.empty()) return {};
  return fmt::format("<section>\n<h2>{}</h2>\n{}</section>\n", escaped(heading), markup);
}

std::string image(std::string_view png, std::string_view css_class, std::string_view alternative) {
  return fmt::format("<img class=\"{}\" alt=\"{}\" src=\"data:image/png;base64,{}\"/>", css_class,
                     escaped(alternative), base64(png));
}

/// The banner over pictures and numbers. Pictures have one of their own, too; this one does not
/// depend on how they were drawn.
std::string alarm_over(const CaseReport& report) {
  if (report.converged) return {};
  return fmt::format("<p class=\"alarm\">{}</p>\n", escaped(kNotConvergedBanner));
}

std::string figcaption(const std::string& title, const std::string& caption) {
  return fmt::format("<figcaption><strong>{}</strong>{}</figcaption>\n", escaped(title),
                     escaped(caption));
}

std::string comparison(const CaseReport& report, const BeforeAfter& pair) {
  return fmt::format(
      "<figure class=\"compare\">\n{}"
      "<div class=\"frame stack\">{}{}</div>\n"
      "<label class=\"slider\"><span>before</span><input type=\"range\" min=\"0\" max=\"100\" "
      "value=\"50\" aria-label=\"visible part of the picture before, in percent\" "
      "oninput=\"this.closest('figure').style.setProperty('--at', this.value + '%')\"/>"
      "<span>predicted</span></label>\n{}</figure>\n",
      alarm_over(report), image(pair.before_png, "before", pair.title + ", before"),
      image(pair.after_png, "after", pair.title + ", predicted"),
      figcaption(pair.title, pair.caption));
}

std::string pictures(const CaseReport& report) {
  std::string figures;
  for (const BeforeAfter& pair : report.comparisons) figures += comparison(report, pair);
  for (const ReportPicture& picture : report.pictures)
    figures += fmt::format("<figure>\n{}<div class=\"frame\">{}</div>\n{}</figure>\n",
                           alarm_over(report), image(picture.png, "whole", picture.title),
                           figcaption(picture.title, picture.caption));
  if (figures.empty()) return {};
  return "<div class=\"pictures\">\n" + figures + "</div>\n";
}

std::string key_numbers(const CaseReport& report) {
  std::string entries;
  for (const KeyNumber& number : report.key_numbers)
    entries += fmt::format("<div><dt>{}</dt><dd>{}</dd></div>\n", escaped(number.name),
                           escaped(number.value));
  if (entries.empty()) return {};
  return alarm_over(report) + "<dl class=\"numbers\">\n" + entries + "</dl>\n";
}

std::string table(const ReportTable& table) {
  std::string html = fmt::format(
      "<div class=\"scroll\"><table>\n<caption>{}</caption>\n<thead><tr>", escaped(table.title));
  std::size_t columns = table.heads.size();
  for (const auto& row : table.rows) columns = std::max(columns, row.size());
  for (std::size_t c = 0; c < columns; ++c)
    html += fmt::format("<th scope=\"col\">{}</th>",
                        c < table.heads.size() ? escaped(table.heads[c]) : "");
  html += "</tr></thead>\n<tbody>\n";
  for (const auto& row : table.rows) {
    html += "<tr>";
    for (std::size_t c = 0; c < columns; ++c) {
      const std::string cell = c < row.size() ? escaped(row[c]) : "";
      html += c == 0 ? fmt::format("<th scope=\"row\">{}</th>", cell)
                     : fmt::format("<td>{}</td>", cell);
    }
    html += "</tr>\n";
  }
  return html + "</tbody>\n</table></div>\n";
}

std::string tables(const CaseReport& report) {
  std::string html;
  for (const ReportTable& each : report.tables) html += table(each);
  return html;
}

std::string plot_figure(const std::string& title, const std::string& svg) {
  return fmt::format("<figure>\n<h3>{}</h3>\n{}</figure>\n", escaped(title), svg);
}

std::string in_row(const std::string& figures) {
  return figures.empty() ? figures : "<div class=\"pictures plots\">\n" + figures + "</div>\n";
}

std::string plots(const std::vector<LinePlot>& plots) {
  std::string figures;
  for (const LinePlot& plot : plots) figures += plot_figure(plot.title, plot_lines(plot));
  return in_row(figures);
}

std::string all_plots(const CaseReport& report) {
  std::string figures;
  for (const BandPlot& plot : report.bands) figures += plot_figure(plot.title, plot_band(plot));
  for (const BarPlot& plot : report.bars) figures += plot_figure(plot.title, plot_bars(plot));
  return in_row(figures) + plots(report.plots);
}

std::string solver(const CaseReport& report) {
  if (report.steps.empty()) return {};
  return plots(
      {residual_plot(report.steps, report.residual_tolerance), penetration_plot(report.steps)});
}

std::string list(const std::vector<std::string>& sentences) {
  std::string items;
  for (const std::string& sentence : sentences)
    items += fmt::format("<li>{}</li>\n", escaped(sentence));
  return items.empty() ? items : "<ul>\n" + items + "</ul>\n";
}

std::string provenance(const CaseReport& report) {
  std::string rows;
  for (const ProvenanceRow& row : report.provenance)
    rows += fmt::format("<tr><th scope=\"row\">{}</th><td>{}</td></tr>\n", escaped(row.name),
                        escaped(row.value));
  if (rows.empty()) return {};
  return "<div class=\"scroll\"><table class=\"provenance\"><tbody>\n" + rows +
         "</tbody></table></div>\n";
}

std::string limitations(const CaseReport& report) {
  std::string paragraphs;
  for (const std::string& paragraph : report.limitations)
    paragraphs += fmt::format("<p>{}</p>\n", escaped(paragraph));
  return paragraphs;
}

std::string head(const CaseReport& report) {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\" xmlns=\"http://www.w3.org/1999/xhtml\">\n<head>\n"
      "<meta charset=\"utf-8\"/>\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; "
      "style-src 'unsafe-inline'; script-src 'unsafe-inline'\"/>\n"
      "<meta name=\"generator\" content=\"lefort {}\"/>\n"
      "<title>{}{}</title>\n<style>{}</style>\n</head>\n",
      kVersion, report.converged ? "" : "NOT CONVERGED: ", escaped(report.title), kPageStyle);
}

std::string banners(const CaseReport& report) {
  std::string html = fmt::format("<p class=\"caution\">{}</p>\n", kNotForClinicalUse);
  if (!report.converged) {
    html += fmt::format("<header class=\"alarm\" role=\"alert\"><p>{}</p>",
                        escaped(kNotConvergedBanner));
    if (!report.failure.empty()) html += fmt::format("<p>{}</p>", escaped(report.failure));
    html += "</header>\n";
  }
  return html;
}

}  // namespace

std::string report_html(const CaseReport& report) {
  std::string html = head(report);
  html += "<body>\n" + banners(report) + "<main>\n";
  html += fmt::format("<h1>{}</h1>\n<p class=\"subtitle\">{}</p>\n<p class=\"plan\">{}</p>\n",
                      escaped(report.title), escaped(report.subtitle), escaped(report.plan));
  html += section(report.pictures_heading, pictures(report));
  html += section("Key numbers", key_numbers(report));
  html += section("Please note", list(report.notes));
  html += section("Measurements", tables(report));
  html += section(report.plots_heading, all_plots(report));
  html += section("Convergence of the solver", solver(report));
  html += section("Provenance", provenance(report));
  html += section("Limitations", limitations(report));
  html += fmt::format("<footer><p>{} Made by lefort {}.</p></footer>\n</main>\n</body>\n</html>\n",
                      kNotForClinicalUse, kVersion);
  return html;
}

}  // namespace lefort::report
