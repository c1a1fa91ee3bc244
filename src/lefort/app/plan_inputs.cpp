#include <lefort/app/plan_inputs.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <system_error>

namespace lefort::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Names the file of a key, if it holds one, as seen from another folder.
class Renamer {
 public:
  Renamer(fs::path from, fs::path to) : from_(std::move(from)), to_(std::move(to)) {}

  void operator()(Json& object, const char* key) const {
    const auto found = object.find(key);
    if (found != object.end() && found->is_string())
      *found = seen_from_there(from_ / found->get<std::string>());
  }
  [[nodiscard]] std::string seen_from_there(const fs::path& file) const {
    std::error_code error;
    const fs::path relative = fs::proximate(file, to_, error);
    return (error ? file : relative).generic_string();
  }

 private:
  fs::path from_, to_;
};

void rename_curves(Json& region, const Renamer& rename) {
  if (region.contains("curves"))
    for (Json& curve : region["curves"]) rename(curve, "file");
}

}  // namespace

Result<fs::path> scan_of(const fs::path& plan_file, const io::PlanFile& plan,
                         const std::optional<fs::path>& given) {
  if (!given && !plan.ct)
    return fail(ErrorCode::kPlanInvalid,
                fmt::format("plan {} names no ct, and --ct was not given", plan_file.string()));
  const fs::path ct = given ? *given : *plan.ct;
  std::error_code error;
  if (!fs::exists(ct, error))
    return fail(ErrorCode::kFileNotFound, fmt::format("there is no scan at {}", ct.string()));
  return ct;
}

std::string portable_plan(const std::string& text, const fs::path& plan_file, const fs::path& ct,
                          const fs::path& folder) {
  const Renamer rename(plan_file.parent_path(), folder);
  auto json = Json::parse(text);
  json["ct"] = rename.seen_from_there(ct);
  rename(json, "landmarks");
  if (json.contains("segmentation")) rename(json["segmentation"], "labels");
  for (Json& segment : json["segments"]) {
    Json& osteotomy = segment["osteotomy"];
    rename_curves(osteotomy, rename);
    if (osteotomy.contains("also"))
      for (Json& region : osteotomy["also"]) rename_curves(region, rename);
    if (!segment["path"].contains("keyframes")) continue;
    for (Json& keyframe : segment["path"]["keyframes"]) {
      rename(keyframe, "transform");
      rename(keyframe, "targets");
    }
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace lefort::app
