#include <lefort/core/version.h>
#include <lefort/io/output_folder.h>
#include <lefort/io/predicted_poses.h>
#include <lefort/io/read_text.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/plan.h>
#include <lefort/pipeline/plan/worksheet.h>
#include <lefort/pipeline/variants.h>
#include <lefort/report/report_html.h>
#include <lefort/report/sheet_pdf.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <utility>

namespace lefort::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMaxDocumentBytes = 256 << 20, kMaxPictureBytes = 64 << 20;
constexpr std::size_t kMaxVariants = 4;

/// What is read of one plan.
struct Variant {
  std::string name;
  fs::path folder;
  nlohmann::json check;
  std::optional<nlohmann::json> prediction;  ///< Converged.
};

Result<nlohmann::json> document(const fs::path& file, const char* version) {
  LEFORT_TRY(const std::string text, io::read_text(file, kMaxDocumentBytes));
  nlohmann::json value = nlohmann::json::parse(text, nullptr, false);
  if (value.is_object() && value.contains(version)) return value;
  return fail(ErrorCode::kFileCorrupt, fmt::format("{}: no `{}`", file.string(), version));
}

/// A string of a document; empty if it is missing.
std::string text_at(const nlohmann::json& value, const char* object, const char* key) {
  const auto inner = value.find(object);
  if (inner == value.end() || !inner->is_object()) return {};
  const auto at = inner->find(key);
  return at != inner->end() && at->is_string() ? at->get<std::string>() : std::string();
}

/// Whether two checks are of one scan, or of one surface.
bool is_same_head(const nlohmann::json& a, const nlohmann::json& b) {
  for (const char* const key : {"ct_sha256", "skull_sha256"}) {
    const std::string first = text_at(a, "inputs", key), second = text_at(b, "inputs", key);
    if (!first.empty() && !second.empty()) return first == second;
  }
  return false;
}

Result<Variant> read_variant(const fs::path& folder, Progress& progress) {
  Variant one;
  one.folder = folder;
  one.name = fs::absolute(folder).lexically_normal().filename().string();
  if (one.name.empty()) one.name = fs::absolute(folder).parent_path().filename().string();
  LEFORT_TRY(one.check, document(folder / "check/check.json", "lefort_plan_check"));
  if (one.check["lefort_plan_check"] != kPlanCheckVersion)
    return fail(ErrorCode::kFileUnsupported,
                fmt::format("the check of {} is of another version of lefort: check the plan again",
                            one.name));
  const fs::path prediction = folder / "prediction/prediction.json";
  if (!fs::exists(prediction)) return one;
  LEFORT_TRY(nlohmann::json found, document(prediction, "lefort_prediction"));
  LEFORT_TRY_VOID(io::check_prediction_version(found));
  if (!found.contains("converged") || found["converged"] != true) {
    progress.note(fmt::format("the prediction of {} did not converge and is left out", one.name));
  } else if (text_at(found, "inputs", "plan_sha256") !=
             text_at(one.check, "inputs", "plan_sha256")) {
    progress.note(
        fmt::format("the prediction of {} is of another plan than its check and is left "
                    "out: predict again",
                    one.name));
  } else {
    one.prediction = std::move(found);
  }
  return one;
}

Result<std::vector<Variant>> read_variants(const VariantsJob& job, Progress& progress) {
  if (job.folders.size() < 2 || job.folders.size() > kMaxVariants)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{} folders, must be 2 to {}", job.folders.size(), kMaxVariants));
  std::vector<Variant> variants;
  std::set<std::string> names;
  for (const fs::path& folder : job.folders) {
    LEFORT_TRY(Variant one, read_variant(folder, progress));
    if (!names.insert(one.name).second)
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("two folders have the name {}: rename one", one.name));
    if (!variants.empty() && !is_same_head(one.check, variants[0].check))
      return fail(ErrorCode::kInvalidArgument, fmt::format("{} and {} are plans of different heads",
                                                           variants[0].name, one.name));
    variants.push_back(std::move(one));
  }
  return variants;
}

/// Rows by name, with a value for each variant.
class Rows {
 public:
  Rows(std::string title, std::vector<std::string> heads, std::size_t columns)
      : table_{std::move(title), std::move(heads), {}}, columns_(columns) {}

  /// Sets a value; a new name adds a row.
  void set(const std::string& row, std::size_t column, const std::string& value) {
    const auto [at, is_new] = number_of_.try_emplace(row, table_.rows.size());
    if (is_new) {
      table_.rows.emplace_back(columns_ + 1, "-");
      table_.rows.back()[0] = row;
    }
    table_.rows[at->second][column + 1] = value;
  }
  [[nodiscard]] const report::ReportTable& table() const { return table_; }

 private:
  report::ReportTable table_;
  std::size_t columns_;
  std::map<std::string, std::size_t> number_of_;
};

std::vector<std::string> names_of_variants(const std::vector<Variant>& variants) {
  std::vector<std::string> names;
  names.reserve(variants.size());
  for (const Variant& one : variants) names.push_back(one.name);
  return names;
}

std::vector<std::string> heads_of(const std::vector<Variant>& variants, const std::string& first) {
  std::vector<std::string> heads{first};
  for (const Variant& one : variants) heads.push_back(one.name);
  return heads;
}

/// A name of a file, in words.
std::string with_spaces(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

/// "5.0 forward, 2.9 up".
std::string translation_in_words(const nlohmann::json& terms) {
  std::string text;
  for (const auto& [key, positive, negative] : {std::tuple{"anterior_mm", "forward", "back"},
                                                {"superior_mm", "up", "down"},
                                                {"left_mm", "to left", "to right"}})
    if (const std::string word = movement_in_words(terms.value(key, 0.0), positive, negative);
        word != "-")
      text += (text.empty() ? "" : ", ") + word;
  return text.empty() ? "-" : text;
}

std::string rotation_in_words(const nlohmann::json& terms) {
  constexpr double kShown_deg = 0.05;
  std::string text;
  for (const auto& [key, name] :
       {std::pair{"yaw_deg", "yaw"}, {"pitch_deg", "pitch"}, {"roll_deg", "roll"}})
    if (const double value = terms.value(key, 0.0); std::abs(value) >= kShown_deg)
      text += fmt::format("{}{} {:+.1f}", text.empty() ? "" : ", ", name, value);
  return text.empty() ? "-" : text;
}

report::ReportTable movement_table(const std::vector<Variant>& variants) {
  Rows rows("Movements (mm; degrees: yaw to the left, pitch down, roll with the left side up)",
            heads_of(variants, "segment, point"), variants.size());
  for (std::size_t n = 0; n < variants.size(); ++n)
    for (const nlohmann::json& one :
         variants[n].check.value("movements", nlohmann::json::array())) {
      const std::string segment = one.value("segment", "");
      const nlohmann::json center = one.value("center", nlohmann::json::object());
      rows.set(fmt::format("{}, center", segment), n, translation_in_words(center));
      rows.set(fmt::format("{}, rotation", segment), n, rotation_in_words(center));
      const nlohmann::json landmarks = one.value("landmarks", nlohmann::json::object());
      for (const auto& [name, terms] : landmarks.items())
        rows.set(fmt::format("{}, {}", segment, name), n, translation_in_words(terms));
    }
  return rows.table();
}

report::ReportTable measure_table(const std::vector<Variant>& variants) {
  std::vector<std::string> heads = heads_of(variants, "measurement");
  heads.insert(heads.begin() + 1, "before");
  Rows rows("Measures after surgery", std::move(heads), variants.size() + 1);
  const auto number = [](const nlohmann::json& row, const char* key) {
    const auto at = row.find(key);
    return at != row.end() && at->is_number() ? fmt::format("{:.1f}", at->get<double>())
                                              : std::string("-");
  };
  for (std::size_t n = 0; n < variants.size(); ++n)
    for (const nlohmann::json& row :
         variants[n].check.value("cephalometry", nlohmann::json::array())) {
      const std::string after = number(row, "after");
      if (after == "-") continue;
      const std::string name =
          fmt::format("{} [{}]", row.value("measurement", ""), row.value("unit", ""));
      rows.set(name, 0, number(row, "before"));
      rows.set(name, n + 1, after);
    }
  return rows.table();
}

report::ReportTable result_table(const std::vector<Variant>& variants) {
  Rows rows("Findings of the check, and the predicted skin", heads_of(variants, ""),
            variants.size());
  for (std::size_t n = 0; n < variants.size(); ++n) {
    std::map<std::string, int> kinds;
    for (const nlohmann::json& finding :
         variants[n].check.value("findings", nlohmann::json::array()))
      ++kinds[with_spaces(finding.value("kind", "finding"))];
    for (const auto& [kind, count] : kinds) rows.set("findings: " + kind, n, fmt::to_string(count));
    if (!variants[n].prediction) continue;
    const nlohmann::json skin = variants[n].prediction->value("skin", nlohmann::json::object());
    rows.set("largest displacement of the skin [mm]", n,
             fmt::format("{:.1f}", skin.value("max_shift_mm", 0.0)));
    rows.set("mean displacement where the skin moves [mm]", n,
             fmt::format("{:.1f}", skin.value("mean_shift_where_moved_mm", 0.0)));
  }
  return rows.table();
}

/// Pictures of one view beside each other; a view is left out if a variant has no such picture.
Result<void> add_view(const std::vector<Variant>& variants, const std::string& file,
                      const std::string& title, std::vector<report::ReportPicture>& pictures) {
  std::vector<report::ReportPicture> row;
  for (const Variant& one : variants) {
    const fs::path path = one.folder / file;
    if (!fs::exists(path)) return {};
    LEFORT_TRY(std::string png, io::read_text(path, kMaxPictureBytes));
    row.push_back({title + ", " + one.name, "", std::move(png)});
  }
  pictures.insert(pictures.end(), std::make_move_iterator(row.begin()),
                  std::make_move_iterator(row.end()));
  return {};
}

Result<std::vector<report::ReportPicture>> pictures_of(const std::vector<Variant>& variants) {
  std::vector<report::ReportPicture> pictures;
  const bool has_faces = std::all_of(variants.begin(), variants.end(),
                                     [](const Variant& one) { return one.prediction.has_value(); });
  for (const char* const view : {"front", "right_profile", "right_three_quarter"}) {
    const std::string name = with_spaces(view);
    if (has_faces)
      LEFORT_TRY_VOID(add_view(variants, fmt::format("prediction/pictures/after_{}.png", view),
                               "Predicted face, " + name, pictures));
    LEFORT_TRY_VOID(add_view(variants, fmt::format("check/pictures/plan_after_{}.png", view),
                             "Bones, " + name, pictures));
  }
  return pictures;
}

std::string csv_of(const std::vector<report::ReportTable>& tables) {
  const auto quoted = [](const std::string& text) {
    std::string field = "\"";
    for (const char c : text) field += c == '"' ? std::string("\"\"") : std::string(1, c);
    return field + "\"";
  };
  std::string text;
  for (const report::ReportTable& table : tables)
    for (std::size_t n = 0; n <= table.rows.size(); ++n) {
      const std::vector<std::string>& row = n == 0 ? table.heads : table.rows[n - 1];
      for (std::size_t column = 0; column < row.size(); ++column)
        text += (column == 0 ? "" : ",") + quoted(row[column]);
      text += "\n";
    }
  return text;
}

nlohmann::json tables_json(const std::vector<report::ReportTable>& tables) {
  nlohmann::json all = nlohmann::json::array();
  for (const report::ReportTable& table : tables)
    all.push_back({{"title", table.title}, {"heads", table.heads}, {"rows", table.rows}});
  return all;
}

Result<void> write_variants(const fs::path& folder, const std::vector<Variant>& variants,
                            const std::vector<report::ReportTable>& tables,
                            const nlohmann::json& result) {
  constexpr const char* kTitle = "Plans of one case";
  LEFORT_TRY(std::vector<report::ReportPicture> pictures, pictures_of(variants));
  LEFORT_TRY_VOID(io::make_output_folder(folder));
  report::CaseReport page;
  page.title = kTitle;
  page.converged = true;  // Others are left out.
  for (const Variant& one : variants)
    page.subtitle += (page.subtitle.empty() ? "" : ", ") + one.name;
  page.pictures_heading = "Side by side";
  page.pictures = pictures;
  page.tables = tables;
  page.limitations = {kNotForClinicalUse};
  LEFORT_TRY_VOID(io::write_text(folder / "variants.html", report::report_html(page)));
  report::Sheet sheet{kTitle, {page.subtitle}, std::move(pictures), int(variants.size()), tables};
  LEFORT_TRY(const std::string pdf, report::sheet_pdf(sheet));
  LEFORT_TRY_VOID(io::write_text(folder / "variants.pdf", pdf));
  LEFORT_TRY_VOID(io::write_text(folder / "variants.csv", csv_of(tables)));
  return io::write_text(folder / "variants.json", result.dump(1) + "\n");
}

}  // namespace

Result<Summary> compare_variants(const VariantsJob& job, Progress& progress) {
  const io::EmptyFolderCleanup none_left(job.output);
  LEFORT_TRY(const std::vector<Variant> variants, read_variants(job, progress));
  std::vector<report::ReportTable> tables;
  try {
    tables = {movement_table(variants), measure_table(variants), result_table(variants)};
  } catch (const nlohmann::json::exception&) {
    return fail(ErrorCode::kFileCorrupt,
                "a check.json or prediction.json is damaged: check and predict the plan again");
  }
  Summary summary;
  summary.json = {{"lefort_variants", 1},
                  {"notice", kNotForClinicalUse},
                  {"variants", names_of_variants(variants)},
                  {"tables", tables_json(tables)}};
  progress.begin_stage("write");
  LEFORT_TRY_VOID(write_variants(job.output, variants, tables, summary.json));
  summary.text =
      fmt::format("{}: {} plans side by side\n{}", (job.output / "variants.html").string(),
                  variants.size(), kNotForClinicalUse);
  return summary;
}

}  // namespace lefort::pipeline
