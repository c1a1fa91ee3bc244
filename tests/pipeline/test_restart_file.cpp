#include <lefort/io/read_text.h>
#include <lefort/io/sha256.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/cache/restart_file.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "support/temporary_folder.h"

namespace lefort::pipeline::test_restart_file {
namespace {

predict::Restart some_restart() {
  predict::Restart restart;
  predict::PredictionStep step;
  step.path_fraction = 0.25;
  step.segments.resize(2);
  for (predict::SegmentStep& segment : step.segments) segment.X_LB = RigidTransform::Identity();
  step.segments[1].X_LB.translation() = Vec3(1.0, -2.0, 3.5);
  step.displacement_mm = {Vec3(0.1, 0.2, 0.3), Vec3(-1e-300, 0.0, 1.0 / 3.0)};
  step.segments[1].contact.points = 17;
  step.segments[1].contact.p99_penetration_increase_mm = 0.04;
  step.segments[1].supports = {.nodes = 5, .max_slip_mm = 0.7};
  step.stationary_supports.max_opening_mm = 0.3;
  step.min_J = 0.9;
  fem::LoadAttempt attempt;
  attempt.t_to = 0.25;
  attempt.extrapolated = true;
  attempt.stop = fem::NewtonStop::kStagnated;
  attempt.reason = "no step lowers the energy";
  attempt.history = {{.residual_n = 1.0}, {.residual_n = 1e-9, .contacts = 3}};
  step.attempts = {attempt};
  restart.steps = {step, step};
  restart.stepper.last.t = 0.25;
  restart.stepper.last.u = VectorX::LinSpaced(6, 0.0, 1.0);
  restart.stepper.before_last.emplace();
  restart.stepper.before_last->u = VectorX::Ones(6);
  restart.stepper.increment = 0.0625;
  return restart;
}

TEST(RestartFile, IsReadAsItWasWritten) {
  const test::TemporaryFolder folder;
  const auto path = folder / "steps.restart", again = folder / "again.restart";
  ASSERT_TRUE(write_restart(path, some_restart()));
  const auto read = read_restart(path);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->steps[1].displacement_mm, some_restart().steps[1].displacement_mm);
  EXPECT_EQ(read->steps[1].segments[1].X_LB.translation(), Vec3(1.0, -2.0, 3.5));
  EXPECT_EQ(read->steps[1].segments[1].contact.points, 17);
  EXPECT_EQ(read->steps[1].segments[1].supports.nodes, 5);
  EXPECT_EQ(read->steps[1].segments[1].supports.max_slip_mm, 0.7);
  EXPECT_EQ(read->steps[1].stationary_supports.max_opening_mm, 0.3);
  EXPECT_EQ(read->steps[0].attempts[0].reason, "no step lowers the energy");
  EXPECT_EQ(read->stepper.before_last->u, VectorX::Ones(6));
  ASSERT_TRUE(write_restart(again, *read));
  EXPECT_EQ(io::read_text(path, 1 << 20).value(), io::read_text(again, 1 << 20).value());
}

/// A file of another program has a valid SHA-256, too.
TEST(RestartFile, ValuesThatAreNoneOfTheirTypeAreRejected) {
  const test::TemporaryFolder folder;
  const auto path = folder / "steps.restart";
  constexpr std::size_t kHead = 17 + 64;  // Magic and SHA-256.
  const auto body_of = [&](bool is_extrapolated) {
    predict::Restart restart = some_restart();
    restart.steps[1].attempts[0].extrapolated = is_extrapolated;
    EXPECT_TRUE(write_restart(path, restart));
    return io::read_text(path, 1 << 20).value();
  };
  const std::string whole = body_of(true), other = body_of(false);
  const auto read_with = [&](std::string_view body) {
    const std::string hash = io::Sha256().add(body).hex();
    EXPECT_TRUE(io::write_text(path, whole.substr(0, 17) + hash + std::string(body)));
    return read_restart(path);
  };
  const std::size_t at =
      std::size_t(std::mismatch(whole.begin() + kHead, whole.end(), other.begin() + kHead).first -
                  whole.begin());
  ASSERT_EQ(whole[at], 1);
  std::string body = whole.substr(kHead);
  EXPECT_TRUE(read_with(body));
  body[at - kHead] = 2;
  EXPECT_FALSE(read_with(body));
  // As many steps as bytes, each of which would be hundreds of bytes in memory.
  std::string many(1 << 20, '\0');
  const std::uint64_t count = many.size() - sizeof(count);
  std::memcpy(many.data(), &count, sizeof(count));
  EXPECT_FALSE(read_with(many));
}

TEST(RestartFile, ATruncatedOrDamagedFileIsRejected) {
  const test::TemporaryFolder folder;
  const auto path = folder / "steps.restart";
  ASSERT_TRUE(write_restart(path, some_restart()));
  const std::string whole = io::read_text(path, 1 << 20).value();
  std::string flipped = whole;
  flipped[whole.size() / 2] = char(flipped[whole.size() / 2] ^ 1);
  for (const std::string& text : {std::string(), whole.substr(0, 30), whole.substr(0, 100),
                                  whole.substr(0, whole.size() - 1), whole + "x", flipped}) {
    ASSERT_TRUE(io::write_text(path, text));
    const auto read = read_restart(path);
    ASSERT_FALSE(read);
    EXPECT_EQ(read.error().code, ErrorCode::kFileCorrupt);
  }
  EXPECT_EQ(read_restart(folder / "none").error().code, ErrorCode::kFileNotFound);
}

}  // namespace
}  // namespace lefort::pipeline::test_restart_file
