// Which options redo which stages.
#include "workflows/recipes.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <map>
#include <set>

#include "core/error.h"
#include "core/file.h"
#include "tests/support/message_of.h"
#include "workflows/join_recipe.h"
#include "workflows/print_stages.h"

namespace rigmap {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsSupersetOf;
using testing::Not;

using Names = std::set<std::string>;

// Stages and checks that read an option, by section, and by option where they differ from the rest
// of it: what docs/stages.md says.
const std::map<std::string, Names> kReaders{
    {"masks", {"adjustment", "bridging", "dense", "features", "matching", "odometric_adjustment"}},
    {"features", {"adjustment", "bridging", "features", "matching", "odometric_adjustment"}},
    {"odometry", {"odometry", "bridging", "odometric_adjustment", "adjustment"}},
    {"dead_reckoning", {"bridging", "odometric_adjustment", "adjustment", "sensor_gates"}},
    {"filter", {"bridging", "odometric_adjustment", "adjustment", "sensor_gates"}},
    {"matching", {"matching", "odometric_adjustment", "adjustment"}},
    {"matching.min_inliers", {"matching", "mapping", "odometric_adjustment", "adjustment"}},
    {"colmap", {}},
    {"mapping", {"mapping"}},
    {"mapping.tracks_per_keyframe", {"database"}},
    {"klt", {"bridging", "odometric_adjustment", "adjustment"}},
    {"sfm", {}},
    {"scale", {"mapping"}},
    {"adjustment", {"odometric_adjustment", "adjustment"}},
    {"dense", {"dense"}},
    {"dense.depth_maps", {"depth_maps"}},
    {"fusion", {"fusion"}},
    {"fusion.voxel_m", {"dense"}},
    {"raster", {"raster"}},
    {"raster.picture_px", {"views"}},
    {"registration", {}},
    {"evaluation", {"evaluation"}},
    {"georeference", {"georeference", "evaluation"}},
    {"georeference.max_map_sigma_m", {"georeference"}},
    {"georeference.las", {"las"}},
    {"rocks", {"evaluation"}},
    {"rocks.min_height_m", {"georeference", "evaluation"}},
    {"rocks.min_height_sigmas", {"georeference", "evaluation"}},
    {"rocks.min_top_m", {"georeference", "evaluation"}},
    {"rocks.min_width_m", {"georeference", "evaluation"}},
    {"gates", {"gates"}},
    {"gates.baseline_spread", {"adjustment", "gates"}},
    {"gates.baseline_rejected", {"adjustment", "gates"}},
    {"gates.registered", {"adjustment", "gates"}},
    {"gates.motion_agreement_sigmas", {"adjustment", "gates"}},
    {"gates.motion_agreement_pct", {"adjustment", "gates"}},
    {"gates.reprojection_px", {"adjustment", "gates"}},
    {"gates.outlier_share", {"adjustment", "gates"}},
    {"gates.depth_bias_px", {"depth_gates"}},
    {"gates.unheld", {}},
    {"gates.closure_sigmas", {}},
    {"gates.closure_pct", {}},
};

const Names& ReadersOf(const std::string& section, const std::string& option) {
  const auto exact = kReaders.find(section + "." + option);
  return exact != kReaders.end() ? exact->second : kReaders.at(section);
}

StageGraph GraphOf(const PartOptions& options) { return RigRecipe({}, {}, options); }

// Named nodes whose code or options differ.
Names Changed(const StageGraph& a, const StageGraph& b) {
  Names names;
  for (std::size_t i = 0; i < a.nodes().size(); ++i) {
    if (a.nodes()[i].identity != b.nodes()[i].identity) names.insert(a.nodes()[i].name);
  }
  return names;
}

// Another value that the option may have.
void ChangeOption(OptionField& field) {
  if (auto* flag = std::get_if<bool*>(&field.value)) {
    **flag = !**flag;
  } else if (auto* number = std::get_if<int*>(&field.value)) {
    **number += 1;
  } else if (auto* value = std::get_if<double*>(&field.value)) {
    **value = **value * 0.99 + 1e-6;
  } else {
    const auto& choice = std::get<OptionChoice>(field.value);
    choice.choose((choice.index() + 1) % choice.names.size());
  }
}

TEST(RigRecipe, EachOptionAloneRedoesExactlyTheStagesThatReadIt) {
  const StageGraph before = GraphOf({});
  std::size_t options = 0;
  PartOptions defaults;
  for (const OptionSection& section : defaults.Sections()) {
    for (const OptionField& field : section.fields) {
      PartOptions changed;
      for (OptionSection& other : changed.Sections()) {
        for (OptionField& candidate : other.fields) {
          if (other.name == section.name && candidate.name == field.name) ChangeOption(candidate);
        }
      }
      EXPECT_EQ(Changed(before, GraphOf(changed)), ReadersOf(section.name, field.name))
          << section.name << "." << field.name;
      ++options;
    }
  }
  EXPECT_GT(options, 80U);
}

TEST(RigRecipe, EveryOptionThatIsNamedHereIsThere) {
  PartOptions defaults;
  Names names;
  for (const OptionSection& section : defaults.Sections()) {
    names.insert(section.name);
    for (const OptionField& field : section.fields) names.insert(section.name + "." + field.name);
  }
  for (const auto& [name, readers] : kReaders) EXPECT_TRUE(names.contains(name)) << name;
}

// Names of the stages that depend on one, itself included.
std::vector<std::string> DescendantsOf(const StageGraph& graph, const std::string& name) {
  const auto reached = graph.Descendants(graph.IndexOf(name));
  std::vector<std::string> names;
  for (std::size_t i = 0; i < reached.size(); ++i) {
    if (reached[i] && !graph.nodes()[i].name.empty()) names.push_back(graph.nodes()[i].name);
  }
  return names;
}

TEST(RigRecipe, StagesDependOnWhatTheyTakeAndNoMore) {
  const StageGraph graph = GraphOf({});
  EXPECT_THAT(
      StageNames(Technique::kRig),
      ElementsAre("dataset", "features", "odometry", "bridging", "matching", "database", "mapping",
                  "scale", "odometric_adjustment", "adjustment", "pose_graph", "steps", "dense",
                  "depth_maps", "fusion", "georeference", "raster", "las", "views", "evaluation"));
  EXPECT_THAT(DescendantsOf(graph, "views"), ElementsAre("views"));
  EXPECT_THAT(DescendantsOf(graph, "raster"), ElementsAre("raster"));
  EXPECT_THAT(DescendantsOf(graph, "truth"), ElementsAre("truth", "evaluation"));
  // Fixes say where finished products lie, and move no pose.
  EXPECT_THAT(DescendantsOf(graph, "fixes"), ElementsAre("fixes", "georeference", "raster", "las"));
  EXPECT_THAT(DescendantsOf(graph, "fusion"),
              ElementsAre("fusion", "georeference", "raster", "las", "views", "evaluation"));
  EXPECT_THAT(DescendantsOf(graph, "scale"),
              ElementsAre("scale", "adjustment", "gates", "sensor_gates", "pose_graph", "steps",
                          "dense", "depth_maps", "depth_gates", "fusion", "georeference", "raster",
                          "las", "views", "evaluation"));
}

std::vector<Technique> AllTechniques() {
  std::vector<Technique> techniques;
  for (const char* name : NamesOf(Technique{})) techniques.push_back(ParseTechnique(name));
  return techniques;
}

// To make the table anew: rigmap stages.
TEST(PrintStages, GivesTheTableOfTheDocument) {
  EXPECT_THAT(ReadTextFile(RIGMAP_DOCS "/stages.md"),
              HasSubstr("\n\n" + PrintStages(MakeRecipe(Technique::kRig, {}, {}, {})) + "\n"));
}

TEST(StageNamesTest, AreThoseOfTheDocument) {
  const std::string document = ReadTextFile(RIGMAP_DOCS "/techniques.md");
  for (const Technique technique : AllTechniques()) {
    EXPECT_THAT(document, HasSubstr(fmt::format("\n- `{}`: {}\n", NameOf(technique),
                                                fmt::join(StageNames(technique), ", "))));
  }
}

TEST(PrintStages, NamesASectionOnlyWhereAllOfItIsRead) {
  const std::string table = PrintStages(MakeRecipe(Technique::kRig, {}, {}, {}));
  EXPECT_THAT(table, HasSubstr("| `database` | `colmap`, `dataset`, `bridging`, `matching` | "
                               "`mapping.tracks_per_keyframe` | "));
  EXPECT_THAT(table, HasSubstr("| `odometry` | `dataset`, `features` | `odometry` | "));
}

// So that the one takes up what the other has left.
TEST(VisualOdometryRecipe, SharesItsFirstStagesWithTheRigRecipe) {
  const StageGraph rig = RigRecipe({}, {}, {}), vo = VisualOdometryRecipe({}, {}, {});
  for (const char* name : {"features", "odometry"}) {
    const StageNode &a = rig.nodes()[rig.IndexOf(name)], &b = vo.nodes()[vo.IndexOf(name)];
    EXPECT_EQ(a.identity, b.identity) << name;
    EXPECT_EQ(a.inputs, b.inputs) << name;
  }
  EXPECT_THAT(StageNames(Technique::kVisualOdometry),
              ElementsAre("dataset", "features", "odometry", "trajectory", "dense", "depth_maps",
                          "fusion", "georeference", "raster", "las", "views", "evaluation"));
}

TEST(ColmapRecipe, LeavesThePosesOfTheMappingAsTheyAre) {
  EXPECT_THAT(StageNames(Technique::kColmap),
              ElementsAre("dataset", "features", "odometry", "matching", "database", "mapping",
                          "scale", "trajectory", "dense", "depth_maps", "fusion", "georeference",
                          "raster", "las", "views", "evaluation"));
  const StageGraph rig = RigRecipe({}, {}, {}), colmap = ColmapRecipe({}, {}, {});
  const auto same = [&](const char* stage) {
    return rig.nodes()[rig.IndexOf(stage)].identity ==
           colmap.nodes()[colmap.IndexOf(stage)].identity;
  };
  EXPECT_TRUE(same("database"));
  EXPECT_TRUE(same("mapping"));
  PartOptions without;
  without.mapping.method = MappingMethod::kNone;
  EXPECT_THAT(MessageOf<UsageError>([&] { ColmapRecipe({}, {}, without); }),
              HasSubstr("mapping.method"));
}

// The odometry goes into the adjustment, and the mapping is not asked.
TEST(RigRecipe, AdjustsTheOdometryWhileItMaps) {
  const StageGraph graph = GraphOf({});
  EXPECT_TRUE(graph.nodes()[graph.IndexOf("mapping")].waits_for_child);
  EXPECT_THAT(DescendantsOf(graph, "mapping"), Not(testing::Contains("odometric_adjustment")));
}

TEST(RigRecipe, WithoutMappingAdjustsTheOdometry) {
  PartOptions without;
  without.mapping.method = MappingMethod::kNone;
  EXPECT_THAT(Changed(GraphOf({}), GraphOf(without)),
              AllOf(testing::Contains("mapping"), testing::Contains("adjustment")));
}

// Depth comes before the poses, and their own map takes the place of fusion.
TEST(IcpRecipe, HasItsOwnWayFromDepthToAMap) {
  EXPECT_THAT(
      StageNames(Technique::kIcp),
      ElementsAre("dataset", "features", "odometry", "dense", "registration", "trajectory",
                  "depth_maps", "merging", "georeference", "raster", "las", "views", "evaluation"));
  const StageGraph before = IcpRecipe({}, {}, {});
  PartOptions grid, way, merge, limit;
  grid.clouds.grid_m = 0.07;
  EXPECT_EQ(Changed(before, IcpRecipe({}, {}, grid)), (Names{"registration", "merging"}));
  way.registration.way = RegistrationWay::kImproved;
  EXPECT_EQ(Changed(before, IcpRecipe({}, {}, way)), (Names{"registration"}));
  merge.merging.merge_grid_m = 0.02;
  EXPECT_EQ(Changed(before, IcpRecipe({}, {}, merge)), (Names{"merging"}));
  limit.gates.registration.closure_pct = 3.0;
  EXPECT_EQ(Changed(before, IcpRecipe({}, {}, limit)), (Names{"gates"}));
}

TEST(IcpRecipe, StartsFromWheelsWhereTheyAreAskedFor) {
  PartOptions wheels;
  wheels.registration.first_guess = FirstGuess::kWheels;
  const StageGraph plain = IcpRecipe({}, {}, wheels);  // which has its own first guess
  for (const StageNode& node : plain.nodes()) EXPECT_NE(node.name, "dead_reckoning");
  wheels.registration.way = RegistrationWay::kImproved;
  const StageGraph improved = IcpRecipe({}, {}, wheels);
  EXPECT_THAT(DescendantsOf(improved, "dead_reckoning"), testing::Contains("registration"));
  PartOptions slipping = wheels;
  slipping.dead_reckoning.wheel_slip = 0.04;
  EXPECT_EQ(Changed(improved, IcpRecipe({}, {}, slipping)), Names{"dead_reckoning"});
}

TEST(RoverRecipes, WheelsNeedNoImagesForTheirPoses) {
  const StageGraph wheels = WheelsRecipe({}, {}, {});
  EXPECT_THAT(StageNames(Technique::kWheels),
              ElementsAre("dataset", "dead_reckoning", "features", "dense", "depth_maps", "fusion",
                          "georeference", "raster", "las", "views", "evaluation"));
  EXPECT_EQ(wheels.nodes()[wheels.IndexOf("dead_reckoning")].inputs,
            std::vector{wheels.IndexOf("dataset")});
}

TEST(RoverRecipes, TheFilterSharesItsFirstStagesWithVisualOdometry) {
  const StageGraph filter = FilterRecipe({}, {}, {}), vo = VisualOdometryRecipe({}, {}, {});
  for (const char* name : {"features", "odometry"}) {
    const StageNode &a = filter.nodes()[filter.IndexOf(name)], &b = vo.nodes()[vo.IndexOf(name)];
    EXPECT_EQ(a.identity, b.identity) << name;
  }
}

TEST(RoverRecipes, TheirOptionsRedoTheirStage) {
  PartOptions changed;
  changed.dead_reckoning.wheel_slip = 0.04;
  EXPECT_EQ(Changed(WheelsRecipe({}, {}, {}), WheelsRecipe({}, {}, changed)),
            Names{"dead_reckoning"});
  EXPECT_EQ(Changed(FilterRecipe({}, {}, {}), FilterRecipe({}, {}, changed)), Names{"filter"});
  PartOptions without;
  without.filter.use_gyro = false;
  EXPECT_EQ(Changed(WheelsRecipe({}, {}, {}), WheelsRecipe({}, {}, without)), Names{});
  EXPECT_EQ(Changed(FilterRecipe({}, {}, {}), FilterRecipe({}, {}, without)), Names{"filter"});
}

TEST(KnownOutputsTest, AreThoseOfAllTechniquesOnce) {
  const auto outputs = KnownOutputs();
  EXPECT_THAT(outputs, IsSupersetOf({"trajectory.tum", "sparse", "dense.ply", "view_top.png",
                                     "colmap/models", "rig_refined.yaml", "evaluation.json"}));
  EXPECT_EQ(Names(outputs.begin(), outputs.end()).size(), outputs.size());
}

TEST(TechniqueNames, ReadBackAndListWhatThereIs) {
  for (const Technique technique : AllTechniques()) {
    EXPECT_EQ(ParseTechnique(NameOf(technique)), technique);
  }
  EXPECT_THAT(MessageOf<UsageError>([] { ParseTechnique("icp2"); }),
              AllOf(HasSubstr("rig, colmap, sfm, combined, icp, vo, klt, wheels, filter"),
                    HasSubstr("'icp2'")));
}

// What the source of that name holds.
template <class Value>
Value Opened(const StageGraph& graph, const std::string& name) {
  const auto node = std::ranges::find(graph.nodes(), name, &StageNode::name);
  return *std::any_cast<std::shared_ptr<const Value>>(node->open().second);
}

// Fixes that do not move poses may all say where the world lies; those that judge must not tie.
TEST(JoinRecipe, AllFixesLayTheWorldOnEarthAndTheOddTurnsJudge) {
  Dataset dataset;
  for (int second = 0; second < 40; ++second) {
    dataset.fixes.emplace_back().stamp_ns = 1'000'000'000LL * second;
  }
  const SplitFixes split = SplitByTurns(dataset.fixes);
  ASSERT_EQ(split.judging.size(), 20U);
  const StageGraph tied = JoinRecipe(dataset, {}, {}, {}, split, {});
  EXPECT_EQ(Opened<Fixes>(tied, "fixes").fixes.size(), 40U);
  EXPECT_EQ(Opened<Truth>(tied, "truth").fixes.size(), 20U);
  EXPECT_EQ(Opened<SplitFixes>(tied, "split_fixes").tying.size(), 20U);
  const StageGraph untied = JoinRecipe(dataset, {}, {}, {}, std::nullopt, {});
  EXPECT_EQ(Opened<Truth>(untied, "truth").fixes.size(), 40U);
}

}  // namespace
}  // namespace rigmap
