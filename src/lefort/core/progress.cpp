#include <lefort/core/progress.h>

namespace lefort {

Progress& Progress::none() {
  static Progress silent;  // Stateless, so all callers can use the same object.
  return silent;
}

}  // namespace lefort
