#include "pipeline/stage_graph.h"

#include <gmock/gmock.h>

#include <stdexcept>

namespace rigmap {
namespace {

using testing::ElementsAre;

struct TimesOptions {
  int factor = 2;
  OptionFields Fields() { return {{"factor", &factor}}; }
};
struct PlusOptions {
  int summand = 1;
  OptionFields Fields() { return {{"summand", &summand}}; }
};

int Times(const StageContext&, const int& value, const TimesOptions& options) {
  return value * options.factor;
}
int Plus(const StageContext&, const int& a, const int& b, const PlusOptions& options) {
  return a + b + options.summand;
}
Report Compare(const int& value, const TimesOptions& options) {
  return {{"equal", value == options.factor}};
}

Stage<int, Takes<int>, Reads<TimesOptions>> TimesStage(std::string name, std::string_view code) {
  return {.name = std::move(name), .code = code, .make = Times};
}

// source -> times -> plus (of both), and a check on times.
StageGraph Diamond(const TimesOptions& times, const PlusOptions& plus,
                   std::string_view code = "v1") {
  StageGraph graph;
  const auto source =
      graph.AddSource<int>("source", [] { return std::pair<std::string, int>("three", 3); });
  const auto product = graph.AddStage(TimesStage("times", code), Reading(times), source);
  graph.AddStage(
      Stage<int, Takes<int, int>, Reads<PlusOptions>>{
          .name = "plus", .code = "v1", .make = Plus, .publishes = {"sum.txt"}},
      Reading(plus), source, product);
  graph.AddCheck(Check<Takes<int>, Reads<TimesOptions>>{"check", "v1", Compare}, Reading(times),
                 product);
  return graph;
}

TEST(StageGraphTest, KnowsItsStagesOutputsAndTheirOrder) {
  const StageGraph graph = Diamond({}, {});
  EXPECT_THAT(graph.StageNames(), ElementsAre("times", "plus"));  // the source reports nothing
  EXPECT_THAT(graph.Outputs(), ElementsAre("sum.txt"));
  EXPECT_EQ(graph.IndexOf("plus"), 2U);
  EXPECT_THROW(graph.IndexOf("minus"), std::logic_error);
}

TEST(StageGraphTest, FollowsArrowsBothWays) {
  const StageGraph graph = Diamond({}, {});
  EXPECT_THAT(graph.Ancestors(graph.IndexOf("times")), ElementsAre(true, true, false, false));
  EXPECT_THAT(graph.Ancestors(graph.IndexOf("plus")), ElementsAre(true, true, true, false));
  EXPECT_THAT(graph.Descendants(graph.IndexOf("times")), ElementsAre(false, true, true, true));
  EXPECT_THAT(graph.Descendants(graph.IndexOf("plus")), ElementsAre(false, false, true, false));
}

TEST(StageGraphTest, GivesEachStageItsInputsAndOptions) {
  const StageGraph graph = Diamond({.factor = 5}, {.summand = 100});
  const StageContext context;
  const auto& nodes = graph.nodes();
  const std::any three = nodes[0].open().second;
  const std::any fifteen = nodes[1].make(context, {three});
  const std::any sum = nodes[2].make(context, {three, fifteen});
  EXPECT_EQ(*std::any_cast<std::shared_ptr<const int>>(sum), 3 + 15 + 100);
  EXPECT_EQ(nodes[3].report(nodes[3].make(context, {fifteen}), {}), (Report{{"equal", false}}));
}

TEST(StageGraphTest, IdentityChangesWithNameCodeAndOwnOptionsOnly) {
  const StageGraph before = Diamond({}, {});
  const auto identity = [](const StageGraph& graph, const char* name) {
    return graph.nodes()[graph.IndexOf(name)].identity;
  };
  const StageGraph other_option = Diamond({.factor = 7}, {});
  EXPECT_NE(identity(other_option, "times"), identity(before, "times"));
  EXPECT_NE(identity(other_option, "check"), identity(before, "check"));
  EXPECT_EQ(identity(other_option, "plus"), identity(before, "plus"));
  const StageGraph other_code = Diamond({}, {}, "v2");
  EXPECT_NE(identity(other_code, "times"), identity(before, "times"));
  EXPECT_EQ(identity(other_code, "plus"), identity(before, "plus"));
  EXPECT_NE(identity(before, "plus"), identity(before, "times"));
}

TEST(StageGraphTest, RefusesAnInputOfAnotherGraph) {
  StageGraph graph;
  EXPECT_THROW(graph.AddStage(TimesStage("times", "v1"), Reading(TimesOptions()), Node<int>{4}),
               std::logic_error);
}

}  // namespace
}  // namespace rigmap
