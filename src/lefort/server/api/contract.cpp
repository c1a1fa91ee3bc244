#include <lefort/core/check.h>
#include <lefort/io/validate_json.h>
#include <lefort/server/api/contract.h>
#include <lefort/server/api/contract_text.h>

namespace lefort::server {

const nlohmann::json& contract() {
  static const nlohmann::json document = nlohmann::json::parse(kContract);
  return document;
}

Result<nlohmann::json> parse_by_contract(std::string_view text, const std::string& schema) {
  const auto& schemas = contract()["components"]["schemas"];
  LEFORT_CHECK(schemas.contains(schema));
  // References stay what they are: from the root of the document.
  const nlohmann::json whole{{"$ref", "#/components/schemas/" + schema},
                             {"components", {{"schemas", schemas}}}};
  LEFORT_TRY_VOID(io::validate_json(text, whole.dump(), "the body"));
  return nlohmann::json::parse(text);
}

}  // namespace lefort::server
