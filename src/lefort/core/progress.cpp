#include <lefort/core/progress.h>

namespace lefort {

Progress& Progress::none() {
  static Progress silent;  // Stateless, so sharing it is harmless.
  return silent;
}

}  // namespace lefort
