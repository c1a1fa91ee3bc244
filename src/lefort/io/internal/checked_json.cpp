#include <lefort/core/units.h>
#include <lefort/io/internal/checked_json.h>

#include <fmt/format.h>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validator.hpp>

#include <functional>
#include <optional>
#include <set>
#include <utility>

namespace lefort::io::internal {
namespace {

/// Listens to the parser, which takes the last of two equal keys without a word.
class DuplicateKeys {
 public:
  bool operator()(int /*depth*/, Json::parse_event_t event, const Json& value) {
    if (event == Json::parse_event_t::object_start) open_.emplace_back();
    if (event == Json::parse_event_t::object_end) open_.pop_back();
    if (event == Json::parse_event_t::key &&
        !open_.back().insert(value.get<std::string>()).second && !first_)
      first_ = value.get<std::string>();
    return true;
  }
  [[nodiscard]] const std::optional<std::string>& first() const { return first_; }

 private:
  std::vector<std::set<std::string>> open_;  ///< Keys of the objects begun and not ended.
  std::optional<std::string> first_;
};

Result<Json> parse_json(std::string_view text) {
  const auto refuse = [](std::string why) { return fail(ErrorCode::kPlanInvalid, std::move(why)); };
  DuplicateKeys duplicates;
  try {
    Json json = Json::parse(text, std::ref(duplicates));
    if (duplicates.first()) return refuse(fmt::format("key {} stands twice", *duplicates.first()));
    return json;
  } catch (const Json::parse_error& error) {
    return refuse(fmt::format("not JSON: {} (byte {})",
                              text.empty() ? "the file is empty" : "syntax error", error.byte));
  } catch (const Json::exception&) {  // A number that no double holds.
    return refuse("not JSON: a number is too large");
  }
}

/// `<root>`, `[segments]`, `[0]`, `[path]` becomes `segments[0].path`.
std::string readable_path(const std::vector<std::string>& context, const std::string& subject) {
  std::string path;
  for (const std::string& part : context) {
    if (part.size() < 3 || part.front() != '[') continue;
    const std::string key = part.substr(1, part.size() - 2);
    const bool is_index = key.find_first_not_of("0123456789") == std::string::npos;
    if (is_index) {
      path += part;
    } else {
      if (!path.empty()) path += '.';
      path += key;
    }
  }
  return path.empty() ? subject : path;
}

/// The deepest cause among the validator's messages, in our words.
Error describe(const valijson::ValidationResults& results, const std::string& subject) {
  constexpr std::string_view kFollowUp = "Failed to validate ";  // Says that a child failed.
  constexpr std::string_view kUnknownKey = "Object contains a property that could not be validated";
  const valijson::ValidationResults::Error* cause = nullptr;
  for (const auto& error : results) {
    if (error.description.starts_with(kUnknownKey)) {
      const std::size_t quote = error.description.find(": '");
      return {ErrorCode::kPlanInvalid,
              fmt::format("{}: unknown key {}", readable_path(error.context, subject),
                          error.description.substr(quote + 2))};
    }
    const bool is_cause = !error.description.starts_with(kFollowUp);
    if (is_cause && (cause == nullptr || error.context.size() > cause->context.size()))
      cause = &error;
  }
  if (cause == nullptr) return {ErrorCode::kPlanInvalid, subject + " breaks its schema"};
  std::string what = cause->description;
  if (!what.empty()) what.front() = char(std::tolower(what.front()));
  while (what.ends_with('.')) what.pop_back();
  return {ErrorCode::kPlanInvalid,
          fmt::format("{}: {}", readable_path(cause->context, subject), what)};
}

Result<void> check_against_schema(const Json& json, const char* schema_text,
                                  const std::string& subject) {
  const Json schema_json = Json::parse(schema_text);
  valijson::Schema schema;
  valijson::SchemaParser().populateSchema(valijson::adapters::NlohmannJsonAdapter(schema_json),
                                          schema);
  valijson::ValidationResults results;
  valijson::Validator validator;
  if (validator.validate(schema, valijson::adapters::NlohmannJsonAdapter(json), &results))
    return {};
  return tl::unexpected(describe(results, subject));
}

}  // namespace

Result<Json> parse_checked(std::string_view text, const char* schema, const std::string& subject) {
  LEFORT_TRY(Json json, parse_json(text));
  LEFORT_TRY_VOID(check_against_schema(json, schema, subject));
  return json;
}

std::vector<plan::Keyframe> read_keyframes(const Json& keyframes) {
  std::vector<plan::Keyframe> frames;
  for (const Json& json : keyframes) {
    plan::Keyframe frame;
    Vec3 rotation_deg = Vec3::Zero();
    read(json, "at", frame.at);
    read(json, "translation_mm", frame.translation_mm);
    read(json, "rotation_deg", rotation_deg);
    read(json, "about_mm", frame.centre_L);
    frame.rotation_rad = rotation_deg * radians_from_degrees(1.0);
    frames.push_back(frame);
  }
  return frames;
}

}  // namespace lefort::io::internal
