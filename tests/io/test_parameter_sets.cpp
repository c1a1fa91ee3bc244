#include <lefort/io/parameter_sets.h>
#include <lefort/io/write_atomically.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <array>
#include <string>

#include "support/temporary_folder.h"

namespace lefort::io::test_parameter_sets {
namespace {

using nlohmann::json;

class ParameterSets : public testing::Test {
 protected:
  Result<std::vector<ParameterSet>> read(const std::string& name, const std::string& text) {
    EXPECT_TRUE(write_text(folder_ / name, text));
    return read_parameter_sets(folder_ / name);
  }
  std::string error(const std::string& name, const std::string& text) {
    const auto sets = read(name, text);
    return sets ? "no error" : sets.error().message;
  }
  static std::string sets(const std::string& text) {
    return R"({"lefort_parameter_sets": 1, "sets": {)" + text + "}}";
  }
  test::TemporaryFolder folder_;
};

TEST_F(ParameterSets, AreReadFromJson) {
  const auto found = read("a.json", sets(R"("stiff": {"tissue": {"margin_mm": 47}}, "plain": {})"));
  ASSERT_TRUE(found) << found.error().message;
  ASSERT_EQ(found->size(), 2U);
  EXPECT_EQ((*found)[0].name, "plain");  // By name: an object has no order.
  EXPECT_EQ(json::parse((*found)[1].overrides)["tissue"]["margin_mm"], 47);
}

TEST_F(ParameterSets, ATableHasTheSameMeaningAndKeepsItsOrder) {
  const auto found = read("a.csv",
                          "set,tissue.margin_mm,boundary.interface,tissue.skin.layers\r\n"
                          "z,47,bonded,\r\n"
                          "\r\n"
                          "a,,\"contact\",3\r\n");
  ASSERT_TRUE(found) << found.error().message;
  ASSERT_EQ(found->size(), 2U);
  EXPECT_EQ((*found)[0].name, "z");
  EXPECT_EQ(json::parse((*found)[0].overrides),
            json::parse(R"({"tissue": {"margin_mm": 47}, "boundary": {"interface": "bonded"}})"));
  EXPECT_EQ(
      json::parse((*found)[1].overrides),
      json::parse(R"({"tissue": {"skin": {"layers": 3}}, "boundary": {"interface": "contact"}})"));
}

TEST_F(ParameterSets, ErrorsNameTheSetAndTheKeyAsThePlanReaderDoes) {
  const auto says = [](const std::string& message, const std::string& part) {
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  says(error("a.json", sets(R"("x": {"tissue": {"color": 1}})")),
       "parameter set x: tissue: unknown key 'color'");
  says(error("a.json", sets(R"("x": {"tissue": {"margin_mm": -6}})")),
       "parameter set x: tissue.margin_mm");
  says(error("a.json", sets(R"("x": {"ct": "a.nrrd"})")), "unknown key 'ct'");
  says(error("a.json", sets(R"("x": {"segmentation": {"labels": "a.seg.nrrd"}})")),
       "names the file a.seg.nrrd, must name none");
  says(error("a.json", sets(R"("x y": {})")),
       "the set \"x y\" must have a name of 1 to 40 letters");
  says(error("a.json", sets(R"("x": {}, "x": {})")), "x");
  says(error("a.json", sets("")), "sets");
  says(error("a.json", "{"), "a.json: ");
  says(error("a.csv", "name,tissue.margin_mm\n"), "the first column is \"name\", must be \"set\"");
  says(error("a.csv", "set,tissue..margin_mm\n"), "is no key of a plan");
  says(error("a.csv", "set,tissue.margin_mm,tissue.margin_mm\n"), "occurs twice");
  says(error("a.csv", "set,tissue.margin_mm\nx\n"), "line 2 has 1 cells, the first line has 2");
  says(error("a.csv", "set,tissue.margin_mm\nx,40\nx,40\n"), "the set x occurs twice");
  says(error("a.csv", "set,tissue,tissue.margin_mm\nx,3,40\n"), "have both a value");
  says(error("a.csv", "set,tissue.margin_mm\nx,nan\n"), "parameter set x: tissue.margin_mm");
  says(error("a.csv", ""), "sets");
}

TEST_F(ParameterSets, OfAFileCanBeChosen) {
  const auto all = *read("a.csv", "set,tissue.margin_mm\na,40\nb,41\nc,42\n");
  EXPECT_EQ(select_sets(all, {})->size(), 3U);
  const auto chosen = select_sets(all, std::array<std::string, 2>{"c", "a"});
  ASSERT_TRUE(chosen);
  ASSERT_EQ(chosen->size(), 2U);
  EXPECT_EQ(chosen->front().name, "a");
  EXPECT_NE(select_sets(all, std::array<std::string, 1>{"d"}).error().message.find("a, b, c"),
            std::string::npos);
  EXPECT_FALSE(select_sets(all, std::array<std::string, 2>{"a", "a"}));
}

TEST_F(ParameterSets, AreMergedIntoAPlan) {
  const std::string plan =
      R"({"lefort_plan": 1, "tissue": {"poisson": 0.4, "margin_mm": 9}, "segments": [1]})";
  const auto changed =
      change_plan(plan, {"x", R"({"tissue": {"poisson": 0.45, "margin_mm": null}})"});
  ASSERT_TRUE(changed);
  EXPECT_EQ(json::parse(*changed),
            json::parse(R"({"lefort_plan": 1, "tissue": {"poisson": 0.45}, "segments": [1]})"));
  EXPECT_EQ(json::parse(*change_plan(plan, default_set())), json::parse(plan));
  EXPECT_FALSE(change_plan("no plan", default_set()));
}

}  // namespace
}  // namespace lefort::io::test_parameter_sets
