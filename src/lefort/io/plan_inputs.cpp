#include <lefort/io/plan_inputs.h>
#include <lefort/io/sha256.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <system_error>

namespace lefort::io {
namespace {

namespace fs = std::filesystem;
using OrderedJson = nlohmann::ordered_json;

/// Calls `visit` for each file name in the plan except that of the scan.
template <class Visit>
void visit_files(OrderedJson& plan, const Visit& visit_string) {
  const auto visit = [&](OrderedJson& object, const char* key) {
    const auto found = object.find(key);
    if (found != object.end() && found->is_string()) visit_string(*found);
  };
  const bool are_found = plan.value("landmarks", OrderedJson()) == "auto";  // Not a file.
  const auto visit_cuts = [&](OrderedJson& region) {
    for (const char* cuts : {"planes", "curves"})
      if (region.contains(cuts))
        for (OrderedJson& cut : region[cuts]) visit(cut, "file");
  };
  if (!are_found) visit(plan, "landmarks");
  if (plan.contains("segmentation")) {
    OrderedJson& segmentation = plan["segmentation"];
    visit(segmentation, "labels");
    const OrderedJson teeth = segmentation.value("teeth", OrderedJson());
    if (teeth != "auto" && teeth != "none") visit(segmentation, "teeth");
  }
  if (plan.contains("boundary")) visit(plan["boundary"], "labels");
  for (OrderedJson& segment : plan["segments"]) {
    OrderedJson& osteotomy = segment["osteotomy"];
    visit_cuts(osteotomy);
    if (osteotomy.contains("template") && osteotomy["template"].is_object())
      visit(osteotomy["template"], "nerve");
    for (const char* regions : {"additional_regions", "also"})  // The latter is deprecated.
      if (osteotomy.contains(regions))
        for (OrderedJson& region : osteotomy[regions]) visit_cuts(region);
    if (!segment["path"].contains("keyframes")) continue;
    for (OrderedJson& keyframe : segment["path"]["keyframes"]) {
      visit(keyframe, "transform");
      visit(keyframe, "targets");
    }
  }
}

}  // namespace

Result<fs::path> scan_of(const fs::path& plan_file, const PlanFile& plan,
                         const std::optional<fs::path>& given) {
  if (!given && !plan.ct)
    return fail(ErrorCode::kPlanInvalid,
                fmt::format("plan {} names no ct, and --ct was not given", plan_file.string()));
  const fs::path ct = given ? *given : *plan.ct;
  std::error_code error;
  if (!fs::exists(ct, error))
    return fail(ErrorCode::kFileNotFound, fmt::format("the scan {} does not exist", ct.string()));
  return ct;
}

std::vector<std::string> files_of_plan(const std::string& text) {
  auto json = OrderedJson::parse(text);
  std::vector<std::string> names;
  visit_files(json, [&](const OrderedJson& name) { names.push_back(name.get<std::string>()); });
  return names;
}

std::string rename_files(const std::string& text,
                         const std::function<std::string(const std::string&)>& new_name) {
  auto json = OrderedJson::parse(text);
  visit_files(json, [&](OrderedJson& name) { name = new_name(name.get<std::string>()); });
  return json.dump(2, ' ', false, OrderedJson::error_handler_t::replace) + "\n";
}

Result<std::vector<InputFile>> fingerprints(const std::string& text, const fs::path& plan_file) {
  std::vector<InputFile> files;
  for (const std::string& name : files_of_plan(text)) {
    LEFORT_TRY(std::string sha256, sha256_of_file(plan_file.parent_path() / name));
    files.push_back({name, std::move(sha256)});
  }
  return files;
}

std::string portable_plan(const std::string& text, const fs::path& plan_file, const fs::path& ct,
                          const fs::path& folder) {
  const auto seen_from_there = [&](const fs::path& file) {
    std::error_code error;
    const fs::path relative = fs::proximate(file, folder, error);
    return (error ? file : relative).generic_string();
  };
  auto json = OrderedJson::parse(text);
  json["ct"] = seen_from_there(ct);
  visit_files(json, [&](OrderedJson& name) {
    name = seen_from_there(plan_file.parent_path() / name.get<std::string>());
  });
  return json.dump(2, ' ', false, OrderedJson::error_handler_t::replace) + "\n";
}

}  // namespace lefort::io
