#include "pipeline/internal/schedule.h"

#include <gmock/gmock.h>

#include <stdexcept>

#include "tests/support/temporary_folder.h"

namespace rigmap {
namespace {

using testing::ElementsAre;
using namespace std::string_literals;
using testing::IsEmpty;

struct AddOptions {
  int summand = 1;
  OptionFields Fields() { return {{"summand", &summand}}; }
};
int Add(const StageContext&, const int& value, const AddOptions& options) {
  return value + options.summand;
}
int Double(const StageContext&, const int& value) { return 2 * value; }
Report Judge(const int& value) { return {{"value", value}}; }

// images -> first -> (view) -> second, a check on first; truth -> third.
StageGraph Line(const std::string& images, int summand) {
  using Adding = Stage<int, Takes<int>, Reads<AddOptions>>;
  StageGraph graph;
  const auto source =
      graph.AddSource<int>("images", [images] { return std::pair<std::string, int>(images, 3); });
  const AddOptions options{summand};
  const auto stage = [&](const char* name, Node<int> input) {
    return graph.AddStage(
        Adding{.name = name, .code = "v1", .make = Add, .publishes = {std::string(name) + ".txt"}},
        Reading(options), input);
  };
  const auto first = stage("first", source);
  const auto view = graph.AddView(Double, first);
  stage("second", view);
  graph.AddCheck(Check<Takes<int>, Reads<>>{"check", "v1", Judge}, Reading(), first);
  const auto truth = graph.AddSource<int>(
      "truth", []() -> std::pair<std::string, int> { throw std::runtime_error("no truth here"); });
  stage("third", truth);
  return graph;
}

RunPlan Until(const std::string& stage) { return {.recipe = "line", .until = stage, .from = {}}; }

TEST(ScheduleTest, SelectsWhatIsAskedForAndTheChecksOnIt) {
  const StageGraph graph = Line("a", 1);
  const Schedule first = MakeSchedule(graph, Until("first"), {});
  EXPECT_THAT(first.selected, ElementsAre(true, true, false, false, true, false, false));
  const Schedule second = MakeSchedule(graph, Until("second"), {});
  EXPECT_THAT(second.selected, ElementsAre(true, true, true, true, true, false, false));
}

// The view is there for the check alone.
TEST(ScheduleTest, SelectsChecksOnViewsOfWhatIsAskedFor) {
  StageGraph graph;
  const auto source = graph.AddSource<int>("images", [] { return std::pair("a"s, 3); });
  const auto first = graph.AddStage(
      Stage<int, Takes<int>, Reads<AddOptions>>{.name = "first", .code = "v1", .make = Add},
      Reading(AddOptions{}), source);
  const auto view = graph.AddView(Double, first);
  graph.AddCheck(Check<Takes<int>, Reads<>>{"check", "v1", Judge}, Reading(), view);
  const auto second = graph.AddStage(
      Stage<int, Takes<int>, Reads<AddOptions>>{.name = "second", .code = "v1", .make = Add},
      Reading(AddOptions{}), first);
  const auto later = graph.AddView(Double, second);
  graph.AddCheck(Check<Takes<int>, Reads<>>{"later", "v1", Judge}, Reading(), later);
  EXPECT_THAT(MakeSchedule(graph, Until("first"), {}).selected,
              ElementsAre(true, true, true, true, false, false, false));
}

TEST(ScheduleTest, OpensOnlyWhatIsSelected) {
  EXPECT_NO_THROW(MakeSchedule(Line("a", 1), Until("second"), {}));
  EXPECT_THROW(MakeSchedule(Line("a", 1), {}, {}), std::runtime_error);
  EXPECT_THROW(MakeSchedule(Line("a", 1), Until("fourth"), {}), std::logic_error);
}

TEST(ScheduleTest, KeepsTheKeyOfASourceThatNobodyAsksForNow) {
  const StageGraph graph = Line("a", 1);
  EXPECT_FALSE(MakeSchedule(graph, Until("second"), {}).keys[graph.IndexOf("third")]);
  Ledger ledger;
  ledger.Put({.name = "truth", .key = "as it was"});
  EXPECT_TRUE(MakeSchedule(graph, Until("second"), ledger).keys[graph.IndexOf("third")]);
}

TEST(ScheduleTest, KeysFollowInputsAndOptions) {
  const auto key = [](const StageGraph& graph) {
    return *MakeSchedule(graph, Until("second"), {}).keys[graph.IndexOf("second")];
  };
  EXPECT_EQ(key(Line("a", 1)), key(Line("a", 1)));
  EXPECT_NE(key(Line("a", 1)), key(Line("b", 1)));
  EXPECT_NE(key(Line("a", 1)), key(Line("a", 2)));
}

TEST(ScheduleTest, WhatWasMadeOtherwiseIsOutdated) {
  const TemporaryFolder folder;
  for (const char* file : {"first.txt", "second.txt", "stray.txt", "mine.txt"}) {
    folder.Write(file, "x");
  }
  const auto ledger_of = [](const StageGraph& graph) {
    const Schedule schedule = MakeSchedule(graph, Until("second"), {});
    Ledger ledger;
    for (const char* name : {"first", "second"}) {
      ledger.Put({.name = name,
                  .key = *schedule.keys[graph.IndexOf(name)],
                  .published = {std::string(name) + ".txt"}});
    }
    return ledger;
  };
  const std::vector<std::string> known{"first.txt", "second.txt", "stray.txt", "third.txt"};
  const auto find = [&](const StageGraph& graph, const RunPlan& plan, const Ledger& ledger) {
    return FindOutdated(graph, MakeSchedule(graph, plan, ledger), ledger, known, folder.Path());
  };
  const StageGraph graph = Line("a", 1);
  const Ledger ledger = ledger_of(graph);
  const Outdated same = find(graph, Until("second"), ledger);
  EXPECT_THAT(same.stages, IsEmpty());
  EXPECT_THAT(same.outputs, ElementsAre("stray.txt"));  // known, but no record speaks of it
  const Outdated shorter = find(graph, Until("first"), ledger);
  EXPECT_THAT(shorter.stages, IsEmpty());
  const Outdated other = find(Line("a", 2), Until("first"), ledger);
  EXPECT_THAT(other.stages, ElementsAre("first", "second"));
  EXPECT_THAT(other.outputs, ElementsAre("first.txt", "second.txt", "stray.txt"));
  const Outdated from =
      find(graph, {.recipe = "line", .until = "second", .from = "second"}, ledger);
  EXPECT_THAT(from.stages, ElementsAre("second"));
}

}  // namespace
}  // namespace rigmap
