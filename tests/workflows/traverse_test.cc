// `rigmap plan`, `run` and `join` on the simulated part.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "colmap/model_io.h"
#include "core/file.h"
#include "export/tum.h"
#include "tests/support/simulated_part.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_file.h"
#include "tests/workflows/rigmap_program.h"
#include "workflows/output_folder.h"
#include "workflows/stages/joined_parts.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;

json ReadJson(const fs::path& path) { return json::parse(ReadTextFile(path)); }

class TraverseTest : public testing::Test {
 protected:
  ProgramEnd Run(const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"run",   "--dataset", SimulatedPartFolder(),
                                       "--out", out_,        "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunRigmap(arguments);
  }
  ProgramEnd Part(const std::string& frames, const fs::path& out,
                  const std::vector<std::string>& more = {}) {
    return Part(SimulatedPartFolder(), frames, out, more);
  }
  ProgramEnd Part(const fs::path& dataset, const std::string& frames, const fs::path& out,
                  const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{"part",     "--dataset", dataset,   "--out",      out,
                                       "--frames", frames,      "--until", "adjustment", "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunRigmap(arguments);
  }

  TemporaryFolder folder_;
  fs::path out_ = folder_.Path() / "whole";
};

TEST_F(TraverseTest, PartsBecomeOneWorld) {
  // A truth for each part of the data, as Katwijk's parts have.
  const fs::path truth = folder_.Path() / "truth";
  fs::create_directories(truth / "Part1");
  fs::copy(SimulatedPartFolder() / "groundtruth_tum.txt", truth / "Part1" / "trajectory.tum");
  const std::vector<std::string> cut{"--split", "2", "--overlap", "1", "--truth", truth};
  const ProgramEnd first = Run(cut);
  ASSERT_EQ(first.exit_code, 0) << first.err;
  EXPECT_TRUE(fs::exists(out_ / "parts" / "1.1" / "trajectory.tum"));
  EXPECT_TRUE(fs::exists(out_ / "parts" / "1.2" / "dense.ply"));
  const json summary = ReadJson(out_ / "summary.json");
  EXPECT_EQ(summary["technique"], "join");
  ASSERT_EQ(summary["parts"].size(), 2U);
  EXPECT_EQ(summary["parts"][0]["shared_with_earlier"], 0);
  EXPECT_EQ(summary["parts"][1]["shared_with_earlier"], 1);
  EXPECT_EQ(summary["worlds"], json::array({json::array({"1.1", "1.2"})}));
  EXPECT_EQ(ReadTum(out_ / "trajectory.tum").size(), 8U);
  const json evaluation = ReadJson(out_ / "evaluation.json");
  EXPECT_LT(evaluation["ate_se3_m"], 0.005);  // over 2.1 m
  EXPECT_EQ(evaluation["steps"]["parts"]["frames"], 8);
  for (const char* part : {"part-1.1", "part-1.2"}) {
    for (const char* when : {"-alone", "-joined"}) {
      EXPECT_LT(evaluation["steps"][std::string(part) + when]["ate_se3_m"], 0.005) << part << when;
    }
  }
  EXPECT_EQ(ReadModel(out_ / "sparse").images.size(), 16U);
  EXPECT_TRUE(fs::exists(out_ / "dense.ply"));
  const ProgramEnd read = RunProgram(kPython, {RIGMAP_G2O_READER, out_ / "posegraph.g2o"});
  ASSERT_EQ(read.exit_code, 0) << read.err;
  const json graph = json::parse(read.out);
  EXPECT_EQ(graph["vertices"], 8);
  EXPECT_GE(graph["edges"], 7);
  EXPECT_EQ(graph["groups"], 1);
  EXPECT_LT(graph["worst_m"], 0.02);  // ends of the way that see the same beach, 2 m apart
  EXPECT_LT(graph["worst_sigmas"], 2.0);
  for (const char* eye : {"left", "right"}) {
    const auto images = FilesIn(out_ / "colmap" / "images" / eye);
    EXPECT_EQ(images.size(), 8U);
    for (const std::string& image : images) {
      EXPECT_TRUE(fs::exists(out_ / "colmap" / "images" / eye / image)) << image;
    }
  }

  const ProgramEnd judged = RunRigmap({"evaluate", out_, "--truth", truth, "--json"});
  EXPECT_EQ(json::parse(judged.out)["ate_se3_m"], evaluation["ate_se3_m"]) << judged.err;

  // The same again finds everything done, and changes nothing.
  const std::string before = ReadTextFile(out_ / "trajectory.tum");
  const ProgramEnd again = Run(cut);
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(ReadTextFile(out_ / "trajectory.tum"), before);
  const json stages = ReadJson(out_ / "summary.json")["stages"];
  for (const json& stage : stages) {
    if (stage["name"] == "adjustment" || stage["name"] == "fusion") {
      EXPECT_EQ(stage["reused"], true) << stage;
    }
  }
}

TEST_F(TraverseTest, PartsAtTheSameTimeLeaveWhatPartsInTurnLeave) {
  const std::vector<std::string> cut{"--split", "2", "--overlap", "1", "--until", "adjustment"};
  const auto run = [&](const char* threads) {
    std::vector<std::string> more = cut;
    more.insert(more.end(), {"--threads", threads, "--force"});
    const ProgramEnd end = Run(more);
    EXPECT_EQ(end.exit_code, 0) << end.err;
    std::vector<std::string> texts;
    for (const char* file :
         {"parts/1.1/sparse.ply", "parts/1.1/trajectory.csv", "parts/1.2/sparse.ply",
          "parts/1.2/trajectory.csv", "sparse.ply", "trajectory.csv"}) {
      texts.push_back(ReadTextFile(out_ / file));
    }
    return texts;
  };
  const auto in_turn = run("1");
  EXPECT_EQ(run("2"), in_turn);
}

TEST_F(TraverseTest, APartThatIsMissingIsNamedAndTheRestIsJoined) {
  const fs::path data = CopyOfSimulatedPart(folder_.Path());
  const ProgramEnd whole = RunRigmap({"run", "--dataset", data, "--split", "2", "--overlap", "1",
                                      "--out", out_, "--quiet", "--until", "adjustment"});
  ASSERT_EQ(whole.exit_code, 0) << whole.err;
  // The second part's images are gone; what was made of them lies elsewhere.
  fs::remove_all(out_);
  for (int i = 5; i < 8; ++i) {
    for (const char* eye : {"left", "right"}) {
      WriteFileAtomically(data / eye / ("000" + std::to_string(i) + ".png"),
                          [](std::ostream& stream) { stream << "no image"; });
    }
  }
  const ProgramEnd rest = RunRigmap({"run", "--dataset", data, "--split", "2", "--overlap", "1",
                                     "--out", out_, "--quiet", "--until", "adjustment"});
  EXPECT_EQ(rest.exit_code, 3) << rest.err;
  EXPECT_THAT(rest.err, HasSubstr("NOT TRUSTED"));
}

// The same rig an hour later on another beach.
void WriteOtherPart(const fs::path& folder) {
  SimulatedPart(SimulatedWay::kElsewhere).WriteStereoFolder(folder);
  std::string times;
  for (int i = 0; i < 8; ++i) times += fmt::format("{}.0\n", 1448555018 + i);
  WriteFileAtomically(folder / "times.txt", [&](std::ostream& stream) { stream << times; });
}

TEST_F(TraverseTest, AnotherWorldIsJoinedByItself) {
  const fs::path elsewhere = folder_.Path() / "elsewhere";
  WriteOtherPart(elsewhere);
  const auto of = [&](const char* name) { return folder_.Path() / name; };
  Part("0:4", of("a"));
  Part("3:8", of("b"));
  Part(elsewhere, "0:4", of("c"));
  Part(elsewhere, "3:7", of("d"));
  const ProgramEnd join = RunRigmap(
      {"join", of("a"), of("b"), of("c"), of("d"), "--out", out_, "--until", "steps", "--quiet"});
  EXPECT_EQ(join.exit_code, 3) << join.err;
  const fs::path other = out_ / "worlds" / "2";
  EXPECT_THAT(join.err, HasSubstr("parts c, d could not be tied to parts a, b: they are joined by "
                                  "themselves in " +
                                  other.string()));
  EXPECT_EQ(ReadTum(out_ / "trajectory.tum").size(), 8U);
  EXPECT_EQ(ReadTum(other / "trajectory.tum").size(), 7U);
  // The same again goes on from what is there, in both.
  const ProgramEnd again = RunRigmap(
      {"join", of("a"), of("b"), of("c"), of("d"), "--out", out_, "--until", "steps", "--quiet"});
  EXPECT_EQ(again.exit_code, 3) << again.err;
  EXPECT_THAT(again.err, HasSubstr("they are joined by themselves in " + other.string()));
  for (const fs::path& world : {out_, other}) {
    const json summary = ReadJson(world / "summary.json");
    for (const json& stage : summary["stages"]) {
      if (stage["name"] == "adjustment") {
        EXPECT_EQ(stage["reused"], true) << world;
      }
    }
  }
  // What was another world once is none where it is not asked for; what is not rigmap's stays.
  const fs::path notes = out_ / "worlds" / "notes.txt";
  WriteFileAtomically(notes, [](std::ostream& stream) { stream << "mine\n"; });
  const ProgramEnd without = RunRigmap(
      {"join", of("a"), of("b"), "--out", out_, "--force", "--until", "steps", "--quiet"});
  EXPECT_EQ(without.exit_code, 0) << without.err;
  EXPECT_FALSE(fs::exists(other));
  EXPECT_TRUE(fs::exists(notes));
}

// What it throws is no error of rigmap's own kind.
TEST_F(TraverseTest, APartThatFailsForReasonsOfTheDiskIsNamedAndTheRestIsJoined) {
  const std::vector<std::string> cut{"--split", "2", "--overlap", "1", "--until", "adjustment"};
  ASSERT_EQ(Run(cut).exit_code, 0);
  const fs::path parts = out_ / "parts";
  out_ = folder_.Path() / "again";
  fs::create_directories(out_);
  fs::rename(parts, out_ / "parts");
  const fs::path in_the_way = out_ / "parts" / "1.2" / "summary.json";
  fs::remove(in_the_way);
  fs::create_directories(in_the_way / "folder");
  const ProgramEnd rest = Run(cut);
  EXPECT_EQ(rest.exit_code, 3) << rest.err;
  EXPECT_THAT(rest.err, HasSubstr("part 1.2 failed: " + in_the_way.string() + ": "));
  EXPECT_EQ(ReadJson(out_ / "summary.json")["parts"].size(), 1U);
}

TEST_F(TraverseTest, EndsWithThePartsWhereAJoinCannotTakeThemYet) {
  const ProgramEnd end = RunRigmap({"run", "--dataset", SimulatedPartFolder(), "--out", out_,
                                    "--split", "2", "--overlap", "1", "--until", "features"});
  EXPECT_EQ(end.exit_code, 0) << end.err;
  EXPECT_THAT(end.LastErrorLine(), HasSubstr("done up to features, each part by itself"));
  EXPECT_TRUE(fs::exists(out_ / "parts" / "1.2" / "summary.json"));
  EXPECT_FALSE(fs::exists(out_ / "summary.json"));
}

TEST_F(TraverseTest, LeavesARunOfOtherDataAsItIs) {
  const std::vector<std::string> cut{"--split", "2", "--overlap", "1", "--until", "features"};
  ASSERT_EQ(Run(cut).exit_code, 0);
  const fs::path path = out_ / "plan.json";
  json plan = ReadJson(path);
  ASSERT_EQ(plan["parts"].size(), 1U);
  plan["dataset"] = "another";
  plan["parts"][0]["first_s"] = 5.0;
  WriteFileAtomically(path, [&](std::ostream& stream) { stream << plan; });
  const std::string before = ReadTextFile(path);
  const ProgramEnd end = Run(cut);
  EXPECT_EQ(end.exit_code, 1);
  EXPECT_THAT(end.LastErrorLine(), HasSubstr("holds a run of other data (another)"));
  EXPECT_EQ(ReadTextFile(path), before);
}

// However its plan has been changed.
TEST_F(TraverseTest, ByForceRemovesNothingOutsideOfItsFolder) {
  const std::vector<std::string> cut{"--split", "2",        "--overlap", "1",
                                     "--until", "features", "--force"};
  ASSERT_EQ(Run(cut).exit_code, 0);
  const fs::path path = out_ / "plan.json", other = folder_.Path() / "other";
  fs::copy(out_ / "parts" / "1.1", other, fs::copy_options::recursive);
  json plan = ReadJson(path);
  plan["jobs"].push_back(plan["jobs"][0]);
  plan["jobs"].back()["name"] = fs::relative(other, out_ / "parts").string();
  WriteFileAtomically(path, [&](std::ostream& stream) { stream << plan; });
  EXPECT_EQ(Run(cut).exit_code, 0);
  EXPECT_TRUE(fs::exists(other / "summary.json"));
}

TEST_F(TraverseTest, LeavesPartsThatWereCutOtherwiseUntilForced) {
  const auto cut = [&](const char* split) {
    return std::vector<std::string>{"--split", split, "--overlap", "1", "--until", "features"};
  };
  ASSERT_EQ(Run(cut("3")).exit_code, 0);
  const std::string before = ReadTextFile(out_ / "plan.json");
  const ProgramEnd end = Run(cut("2"));
  EXPECT_EQ(end.exit_code, 1);
  EXPECT_THAT(end.LastErrorLine(), HasSubstr("holds parts that were cut otherwise (1.1 of frames"));
  EXPECT_EQ(ReadTextFile(out_ / "plan.json"), before);
  EXPECT_TRUE(fs::exists(out_ / "parts" / "1.3"));

  auto forced = cut("2");
  forced.push_back("--force");
  for (const char* busy : {"parts", "parts/1.3"}) {
    const OutputLock lock(out_ / busy);
    EXPECT_THAT(Run(forced).LastErrorLine(), HasSubstr("another rigmap is working")) << busy;
    EXPECT_TRUE(fs::exists(out_ / "parts" / "1.3" / "summary.json")) << busy;
    EXPECT_EQ(ReadTextFile(out_ / "plan.json"), before) << busy;
  }
  EXPECT_EQ(Run(forced).exit_code, 0);
  EXPECT_FALSE(fs::exists(out_ / "parts" / "1.3"));
  EXPECT_TRUE(fs::exists(out_ / "parts" / "1.2"));
}

TEST_F(TraverseTest, KnowsBeforeAnyPartIsDoneThatNoFixesCanTieIt) {
  const ProgramEnd end = Run({"--use-rtk"});
  EXPECT_EQ(end.exit_code, 1);
  EXPECT_THAT(end.LastErrorLine(), HasSubstr("--use-rtk: expected"));
  const ProgramEnd by_images = Run({"--until", "rtk"});
  EXPECT_EQ(by_images.exit_code, 2);
  EXPECT_THAT(by_images.LastErrorLine(), HasSubstr("--until rtk: expected --use-rtk beside it"));
  EXPECT_FALSE(fs::exists(out_));
}

TEST_F(TraverseTest, ByForceRemovesNoPartWhereOneHoldsWhatIsNotOurs) {
  const std::vector<std::string> cut{"--split", "2", "--overlap", "1", "--until", "features"};
  ASSERT_EQ(Run(cut).exit_code, 0);
  WriteTestFile(out_ / "parts" / "1.2" / "note.txt", "mine\n");
  const auto made = fs::last_write_time(out_ / "parts" / "1.1" / "summary.json");
  std::vector<std::string> by_force = cut;
  by_force.push_back("--force");
  const ProgramEnd end = Run(by_force);
  EXPECT_EQ(end.exit_code, 1);
  EXPECT_THAT(end.LastErrorLine(), HasSubstr("--force would remove note.txt"));
  EXPECT_EQ(fs::last_write_time(out_ / "parts" / "1.1" / "summary.json"), made);
}

TEST_F(TraverseTest, RefusesPartsWhoseKeypointsWereDeleted) {
  const fs::path one = folder_.Path() / "one";
  ASSERT_NE(Part("0:5", one).exit_code, 1);
  fs::remove_all(one / "stages");
  const ProgramEnd join = RunRigmap({"join", one, "--out", out_});
  EXPECT_EQ(join.exit_code, 1);
  EXPECT_THAT(join.LastErrorLine(), HasSubstr("expected the keypoints of its frames (stages/"));
  EXPECT_THAT(join.LastErrorLine(), HasSubstr("run the part again"));
  EXPECT_FALSE(fs::exists(out_));
}

TEST_F(TraverseTest, WhatIsAskedForAnewIsDoneAnewOnce) {
  const fs::path one = folder_.Path() / "one";
  ASSERT_NE(Part("0:5", one).exit_code, 1);
  const ProgramEnd fixes = RunRigmap({"join", one, "--out", out_, "--use-rtk"});
  EXPECT_EQ(fixes.exit_code, 1);
  EXPECT_THAT(fixes.LastErrorLine(), HasSubstr("--use-rtk: expected"));
  EXPECT_FALSE(fs::exists(out_));

  const ProgramEnd no_rtk = RunRigmap({"join", one, "--out", out_, "--from", "rtk"});
  EXPECT_EQ(no_rtk.exit_code, 2);
  EXPECT_THAT(no_rtk.LastErrorLine(), HasSubstr("--from rtk: expected --use-rtk beside it"));
  EXPECT_FALSE(fs::exists(out_));

  const ProgramEnd keypoints =
      RunRigmap({"join", one, "--out", out_, "--set", "features.max_keypoints=700"});
  EXPECT_EQ(keypoints.exit_code, 2);
  EXPECT_THAT(keypoints.LastErrorLine(), HasSubstr("a join takes the keypoints of its parts"));
  EXPECT_FALSE(fs::exists(out_));

  const auto join = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"join", one, "--out", out_, "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    ASSERT_NE(RunRigmap(arguments).exit_code, 1);
  };
  join({"--until", "pose_graph"});
  join({"--until", "pose_graph", "--missing", "part b failed: no images"});
  const json known = ReadJson(out_ / "summary.json");
  EXPECT_EQ(known["status"], "untrusted");
  EXPECT_THAT(known["gates"].dump(), HasSubstr("part b failed: no images"));
  join({"--until", "pose_graph", "--from", "matching"});
  const json joined = ReadJson(out_ / "summary.json");
  for (const json& stage : joined["stages"]) {
    // The second of its two runs, which goes on from the adjustment.
    if (stage["name"] == "matching") {
      EXPECT_EQ(stage["reused"], true);
    }
  }
}

TEST_F(TraverseTest, APartOfTheDataThatCannotBeUsedIsLeftOutOfThePlan) {
  const fs::path data = folder_.Path() / "katwijk";
  fs::create_directories(data / "Part1" / "LocCam");
  fs::create_directories(data / "Part2" / "LocCam");
  fs::copy(SimulatedPartFolder() / "calib.yaml", data / "rig.yaml");
  const auto put = [&](const char* part, const char* eye, int second) {
    const std::string name = "LocCam_2015_11_26_15_23_" + std::to_string(second) + "_619_" +
                             (eye[0] == 'l' ? "0.png" : "1.png");
    fs::copy(SimulatedPartFolder() / eye / "0000.png", data / part / "LocCam" / name);
  };
  for (const int second : {36, 37, 38}) {
    put("Part1", "left", second);
    put("Part1", "right", second);
  }
  put("Part2", "left", 50);  // without a right one
  const ProgramEnd end = RunRigmap({"plan", "--dataset", data, "--quiet"});
  ASSERT_EQ(end.exit_code, 0) << end.err;
  const json plan = json::parse(end.out);
  ASSERT_EQ(plan["parts"].size(), 2U);
  EXPECT_EQ(plan["parts"][1]["pairs"], 0);
  EXPECT_THAT(plan["parts"][1]["remarks"][0].get<std::string>(), HasSubstr("Part2"));
  ASSERT_EQ(plan["jobs"].size(), 1U);
  EXPECT_EQ(plan["jobs"][0]["name"], "1");
  EXPECT_THAT(RunRigmap({"plan", "--dataset", data, "--quiet", "--sbatch"}).out,
              HasSubstr("# Part 2 is left out: "));
  // Of nothing else there is no plan.
  EXPECT_EQ(RunRigmap({"plan", "--dataset", data, "--part", "2", "--quiet"}).exit_code, 1);
}

TEST_F(TraverseTest, APlanTellsWhatThereIsAndWhatToRun) {
  const ProgramEnd end = RunRigmap(
      {"plan", "--dataset", SimulatedPartFolder(), "--split", "2", "--overlap", "1", "--quiet"});
  ASSERT_EQ(end.exit_code, 0) << end.err;
  const json plan = json::parse(end.out);
  EXPECT_EQ(plan["parts"][0]["pairs"], 8);
  EXPECT_EQ(plan["parts"][0]["gaps"], json::array());
  ASSERT_EQ(plan["jobs"].size(), 2U);
  EXPECT_EQ(plan["jobs"][0]["name"], "1.1");
  EXPECT_EQ(plan["jobs"][0]["arguments"],
            json({"--dataset", SimulatedPartFolder().string(), "--frames", "0:5"}));
  EXPECT_EQ(plan["jobs"][1]["arguments"].back(), "4:8");
  EXPECT_GT(plan["jobs"][0]["minutes"], 0);
  EXPECT_GT(plan["total"]["minutes_of_the_join"], 0);
}

TEST_F(TraverseTest, ThePlanAsAScriptForABatchSystemIsOneThatAShellTakes) {
  const ProgramEnd end = RunRigmap({"plan", "--dataset", SimulatedPartFolder(), "--split", "2",
                                    "--overlap", "1", "--sbatch", "--set", "dense.blocks=it's"});
  ASSERT_EQ(end.exit_code, 2);  // no such option
  const ProgramEnd script =
      RunRigmap({"plan", "--dataset", SimulatedPartFolder(), "--split", "2", "--overlap", "1",
                 "--sbatch", "--quiet", "--accuracy", "0.5", "--truth", SimulatedPartFolder()});
  ASSERT_EQ(script.exit_code, 0) << script.err;
  EXPECT_THAT(script.out, HasSubstr("#SBATCH --array=0-1\n"));
  const fs::path file = folder_.Path() / "job.sh";
  WriteFileAtomically(file, [&](std::ostream& stream) { stream << script.out; });
  // The task's command, by a program of that name that only tells what it was given.
  const fs::path bin = folder_.Path() / "bin";
  fs::create_directories(bin);
  WriteFileAtomically(bin / "rigmap", [](std::ostream& stream) {
    stream << "#!/bin/sh\nfor word; do echo \"[$word]\"; done\n";
  });
  fs::permissions(bin / "rigmap", fs::perms::owner_all);
  const ProgramEnd task =
      RunProgram("/bin/sh", {"-c", "PATH=" + bin.string() + ":$PATH SLURM_ARRAY_TASK_ID=1 OUT=" +
                                       folder_.Path().string() + "/o bash " + file.string()});
  ASSERT_EQ(task.exit_code, 0) << task.err;
  EXPECT_THAT(task.out, HasSubstr("[--frames]\n[4:8]\n"));
  EXPECT_THAT(task.out, HasSubstr("[--accuracy]\n[0.5]\n"));
  EXPECT_THAT(task.out, HasSubstr("[--truth]\n[" + SimulatedPartFolder().string() + "]\n"));
  EXPECT_THAT(task.out, EndsWith("/o/parts/1.2]\n"));
}

TEST_F(TraverseTest, CutsThatCannotBeAreRefused) {
  const auto refused = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"plan", "--dataset", SimulatedPartFolder()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProgramEnd end = RunRigmap(arguments);
    EXPECT_EQ(end.exit_code, 2);
    return end.LastErrorLine();
  };
  EXPECT_THAT(refused({"--split", "3"}), HasSubstr("expected at least 43 pairs for 3 jobs"));
  EXPECT_THAT(refused({"--split", "0"}), HasSubstr("expected 1 or more"));
  EXPECT_THAT(refused({"--split", "2", "--max-frames", "4"}), HasSubstr("found both"));
  EXPECT_THAT(refused({"--max-frames", "4"}), HasSubstr("more than twice the overlap"));
  EXPECT_THAT(refused({"--max-frames", "7", "--overlap", "3"}),
              HasSubstr("--max-frames 7: expected at least 11 pairs for 2 jobs"));
}

TEST_F(TraverseTest, WhatIsNoPartOrOfAnotherRigIsRefusedAndNothingWritten) {
  const fs::path one = folder_.Path() / "one", other = folder_.Path() / "other";
  ASSERT_NE(Part("0:5", one).exit_code, 1);
  fs::create_directories(folder_.Path() / "empty");
  const ProgramEnd none = RunRigmap({"join", one, folder_.Path() / "empty", "--out", out_});
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_THAT(none.LastErrorLine(), HasSubstr("expected a part to be joined"));

  const fs::path rig = folder_.Path() / "rig.yaml";
  std::string text = ReadTextFile(SimulatedPartFolder() / "calib.yaml");
  text.replace(text.find("fx: "), 5, "fx: 3");
  WriteFileAtomically(rig, [&](std::ostream& stream) { stream << text; });
  ASSERT_NE(Part("4:8", other, {"--rig", rig}).exit_code, 2);
  const ProgramEnd wrong = RunRigmap({"join", one, other, "--out", out_});
  EXPECT_EQ(wrong.exit_code, 1);
  EXPECT_THAT(wrong.LastErrorLine(), HasSubstr("expected the rig of"));
  EXPECT_FALSE(fs::exists(out_));
}

// Frames 0 to 5 of two parts; the odometry tells the step from 2 to 3 or does not.
struct TwoParts {
  JoinedParts parts;
  AdjustedPart whole;

  explicit TwoParts(bool tied) {
    parts.parts = {{"a", 3, 0, "ok", {}}, {"b", 3, 0, "ok", {}}};
    parts.first_part = {0, 0, 0, 1, 1, 1};
    for (int i = 0; i < 6; ++i) {
      const bool starts = i == 0 || (i == 3 && !tied);
      whole.odometry.push_back(
          {.stamp_ns = i,
           .reference = starts ? i : i - 1,
           .source = i == 3 && !tied ? PoseSource::kPredicted : PoseSource::kOdometry});
    }
    whole.adjustment.world_from_left.resize(6);
    whole.adjustment.datum_frames = {0, 1, 2, 3, 4, 5};
  }
};

TEST(JoinGates, PartsThatNothingTiesAreTwoWorlds) {
  const TwoParts tied(true), apart(false);
  const Report good = JoinGates().make(tied.parts, tied.whole);
  EXPECT_EQ(good["worlds"], Report::array({Report::array({"a", "b"})}));
  EXPECT_EQ(good["gates"][0]["passed"], true);
  const Report bad = JoinGates().make(apart.parts, apart.whole);
  EXPECT_EQ(bad["worlds"].size(), 2U);
  EXPECT_EQ(bad["gates"][0]["passed"], false);
  EXPECT_THAT(bad["gates"][0]["why"].get<std::string>(), HasSubstr("a | b"));
}

TEST(JoinGates, APartThatIsMissingIsAGate) {
  TwoParts two(true);
  two.parts.missing = {"part c failed: no images"};
  const Report report = JoinGates().make(two.parts, two.whole);
  EXPECT_EQ(report["gates"][1]["passed"], false);
  EXPECT_EQ(report["gates"][1]["why"], "part c failed: no images");
}

}  // namespace
}  // namespace rigmap
