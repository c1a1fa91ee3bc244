#include <lefort/core/units.h>
#include <lefort/io/internal/rename_keys.h>
#include <lefort/io/internal/validated_json.h>

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

constexpr int kMaxNesting = 32;

/// Limit of the number of values: the validator stores a message of about 400 bytes for each
/// invalid value. A curve of 10,000 points has 150,000 values.
constexpr Index kMaxValues = 1'000'000;

/// Receives the events of the parser to reject repeated keys, deep nesting and too many values,
/// which the parser accepts.
class Listener {
 public:
  /// \returns false if a limit is exceeded; then the value is discarded.
  bool operator()(int depth, Json::parse_event_t event, const Json& value) {
    using Event = Json::parse_event_t;
    if (too_deep_ || has_too_many_values()) return false;
    if (event == Event::value || event == Event::object_start || event == Event::array_start)
      ++values_;
    if ((event == Event::object_start || event == Event::array_start) && depth >= kMaxNesting) {
      too_deep_ = true;
      return false;
    }
    if (event == Event::object_start) open_.emplace_back();
    if (event == Event::object_end) open_.pop_back();
    if (event == Event::key && !open_.back().insert(value.get<std::string>()).second && !repeated_)
      repeated_ = value.get<std::string>();
    return true;
  }
  [[nodiscard]] const std::optional<std::string>& repeated() const { return repeated_; }
  [[nodiscard]] bool is_too_deep() const { return too_deep_; }
  [[nodiscard]] bool has_too_many_values() const { return values_ > kMaxValues; }

 private:
  std::vector<std::set<std::string>> open_;  ///< Keys of the open objects.
  std::optional<std::string> repeated_;
  Index values_ = 0;
  bool too_deep_ = false;
};

Result<Json> parse_json(std::string_view text) {
  const auto refuse = [](std::string why) { return fail(ErrorCode::kPlanInvalid, std::move(why)); };
  Listener listener;
  try {
    Json json = Json::parse(text, std::ref(listener));
    if (listener.is_too_deep())
      return refuse(fmt::format("nested more than {} deep, must be less", kMaxNesting));
    if (listener.has_too_many_values())
      return refuse(fmt::format("more than {} values, must be less", kMaxValues));
    if (listener.repeated())
      return refuse(fmt::format("key {} stands twice", *listener.repeated()));
    return json;
  } catch (const Json::parse_error& error) {
    return refuse(fmt::format("not JSON: {} (byte {})",
                              text.empty() ? "the file is empty" : "syntax error", error.byte));
  } catch (const Json::exception&) {  // A number out of the range of double.
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

/// Returns the deepest cause among the validator's messages, reworded.
Error describe(const valijson::ValidationResults& results, const std::string& subject) {
  constexpr std::string_view kFollowUp = "Failed to validate ";  // A child failed.
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
  if (cause == nullptr) return {ErrorCode::kPlanInvalid, subject + " does not match its schema"};
  std::string what = cause->description;
  if (!what.empty()) what.front() = char(std::tolower(what.front()));
  while (what.ends_with('.')) what.pop_back();
  if (what.find("enum values") != std::string::npos || what.find("'const'") != std::string::npos)
    what = "the value is not one of those allowed";
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

Result<CheckedJson> parse_renamed(std::string_view text, const DeprecatedNames& deprecated) {
  CheckedJson result;
  LEFORT_TRY(result.json, parse_json(text));
  LEFORT_TRY(result.warnings, rename_deprecated(result.json, deprecated));
  return result;
}

Result<CheckedJson> parse_checked(std::string_view text, const char* schema,
                                  const std::string& subject, const DeprecatedNames& deprecated) {
  LEFORT_TRY(CheckedJson result, parse_renamed(text, deprecated));
  LEFORT_TRY_VOID(check_against_schema(result.json, schema, subject));
  return result;
}

const Json& section(const Json& whole, const char* key) {
  static const Json empty = Json::object();
  const auto found = whole.find(key);
  return found == whole.end() ? empty : *found;
}

const Json& list(const Json& whole, const char* key) {
  static const Json empty = Json::array();
  const auto found = whole.find(key);
  return found == whole.end() ? empty : *found;
}

std::vector<geometry::Keyframe> read_keyframes(const Json& keyframes, const char* at_key) {
  std::vector<geometry::Keyframe> frames;
  for (const Json& json : keyframes) {
    geometry::Keyframe frame;
    Vec3 rotation_deg = Vec3::Zero();
    read(json, at_key, frame.path_fraction);
    read(json, "translation_mm", frame.translation_mm);
    read(json, "rotation_deg", rotation_deg);
    read(json, "about_mm", frame.center_L);
    frame.rotation_rad = rotation_deg * radians_from_degrees(1.0);
    frames.push_back(frame);
  }
  return frames;
}

}  // namespace lefort::io::internal
