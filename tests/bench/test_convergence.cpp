#include <lefort/bench/convergence.h>
#include <lefort/io/read_text.h>

#include <gtest/gtest.h>
#include <support/temporary_folder.h>

#include <string>
#include <string_view>

namespace lefort::bench::test_convergence {
namespace {

/// Requests a stop after a number of notes; there is one for each step.
class StopAfter : public Progress {
 public:
  explicit StopAfter(int notes) : left_(notes) {}
  void note(std::string_view /*sentence*/) override { --left_; }
  [[nodiscard]] bool stop_requested() const override { return left_ <= 0; }

 private:
  int left_;
};

TEST(Convergence, AStoppedRunKeepsItsResults) {
  const test::TemporaryFolder folder;
  const auto cases = synthetic_cases(Progress::none());
  ASSERT_TRUE(cases) << cases.error().message;
  ConvergenceOptions options{.output = folder.path()};
  options.methods = {contact_methods()[2]};
  StopAfter second(2);
  const auto table = run_convergence(std::span(*cases).subspan(1), options, second);
  ASSERT_FALSE(table);
  EXPECT_EQ(table.error().code, ErrorCode::kCancelled);
  constexpr std::uintmax_t kMaximum = 1 << 20;
  const auto written = io::read_text(folder.path() / "convergence.md", kMaximum);
  ASSERT_TRUE(written) << written.error().message;
  EXPECT_NE(written->find("| coarse-sphere | field-smooth | 2 of 20 |"), std::string::npos)
      << *written;
  const auto csv = io::read_text(folder.path() / "convergence.csv", kMaximum);
  ASSERT_TRUE(csv) << csv.error().message;
  EXPECT_NE(csv->find("\ncoarse-sphere,field-smooth,4,0.075,0.1,"), std::string::npos) << *csv;
}

}  // namespace
}  // namespace lefort::bench::test_convergence
