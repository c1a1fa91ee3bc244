#include <lefort/io/read_text.h>
#include <lefort/io/surface_files.h>

#include <gtest/gtest.h>
#include <support/result_file.h>
#include <support/run_program.h>
#include <support/shapes.h>
#include <support/temporary_folder.h>

#include <filesystem>
#include <string>

namespace lefort::app::test_result_schemas {
namespace {

using test::read_result;
using test::run_lefort;
using test::TemporaryFolder;

std::string quoted(const std::filesystem::path& path) { return "'" + path.string() + "'"; }

/// Runs the program; the test fails if that fails. \returns what it printed.
std::string output_of(const std::string& arguments) {
  const auto run = run_lefort(arguments + " --quiet");
  EXPECT_EQ(run.exit_code, 0) << arguments << ": " << run.error;
  return run.out;
}

TEST(ResultSchemas, FieldInfoOfEachMethod) {
  const TemporaryFolder folder;
  ASSERT_TRUE(io::write_surface(folder / "ball.stl", test::make_icosphere(10.0, 3)));
  const std::string field = quoted(folder / "ball.field");
  for (const char* method : {"bricks", "bricks --smooth", "hybrid", "uniform"}) {
    output_of("field build " + quoted(folder / "ball.stl") + " -o " + field +
              " --resolution 32 --method " + method);
    const std::string info = output_of("field info " + field + " --json");
    test::expect_schema(info, "field_info");
  }
}

TEST(ResultSchemas, Verify) {
  const std::string checks = output_of("verify --only patch --json");
  test::expect_schema(checks, "verify");
  EXPECT_TRUE(nlohmann::json::parse(checks)["passed"]);
}

/// The benchmarks take a skull that is in the output folder; here it is a ball.
TEST(ResultSchemas, BenchmarksOfFields) {
  const TemporaryFolder folder;
  ASSERT_TRUE(io::write_surface(folder / "skull.vtp", test::make_icosphere(60.0, 4)));
  const std::string output = " no-scan -o " + quoted(folder.path()) + " --repeats 1";
  output_of("bench table1" + output + " --resolution 64");
  EXPECT_EQ(read_result(folder / "table1.json", "bench_table1").size(), 8U);
  output_of("bench scaling" + output +
            " --band 2 --resolution 64 --subdivisions 1 --without-openvdb");
  EXPECT_EQ(read_result(folder / "scaling.json", "bench_scaling").size(), 3U);
}

TEST(ResultSchemas, BenchmarkOfTheSolver) {
  const TemporaryFolder folder;
  output_of("bench solve -o " + quoted(folder.path()) +
            " --repeats 1 --comparison-cells 3 --increments 1 --cells 4 6");
  const auto result = read_result(folder / "solve.json", "bench_solve");
  EXPECT_EQ(result["pair"]["runs"].size(), 1U);
  EXPECT_EQ(result["growth"]["multigrid"].size(), 2U);
}

/// A schema that accepts everything would pass the tests above.
TEST(ResultSchemas, AWrongValueIsRejected) {
  const TemporaryFolder folder;
  auto checks = nlohmann::json::parse(output_of("verify --only patch --json"));
  checks["cases"][0]["checks"][0]["required"] = "about";
  const auto schema =
      io::read_text(std::filesystem::path(LEFORT_CONTRACT) / "verify.schema.json", 1 << 24);
  ASSERT_TRUE(schema);
  EXPECT_FALSE(io::validate_json(checks.dump(), *schema, "checks"));
}

}  // namespace
}  // namespace lefort::app::test_result_schemas
