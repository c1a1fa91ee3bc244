#include <lefort/io/internal/validated_json.h>
#include <lefort/io/validate_json.h>

namespace lefort::io {

Result<void> validate_json(std::string_view text, const std::string& schema,
                           const std::string& subject) {
  LEFORT_TRY_VOID(internal::parse_checked(text, schema.c_str(), subject));
  return {};
}

}  // namespace lefort::io
