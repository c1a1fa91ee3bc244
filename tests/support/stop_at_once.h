/// \file
/// A progress that requests a stop from the beginning.
#pragma once

#include <lefort/core/progress.h>

namespace lefort::test {

class StopAtOnce : public Progress {
 public:
  [[nodiscard]] bool stop_requested() const override { return true; }
};

}  // namespace lefort::test
