#include <lefort/io/check_json.h>
#include <lefort/io/internal/checked_json.h>

namespace lefort::io {

Result<void> check_json(std::string_view text, const std::string& schema,
                        const std::string& subject) {
  LEFORT_TRY_VOID(internal::parse_checked(text, schema.c_str(), subject));
  return {};
}

}  // namespace lefort::io
