// The command line of the traverse simulator.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <thread>

#include "core/config_file.h"
#include "core/error.h"
#include "core/file.h"
#include "core/job.h"
#include "dataset/rig_file.h"
#include "simulation/faults.h"
#include "simulation/rig_errors.h"
#include "simulation/rover_path.h"
#include "simulation/scaled_rig.h"
#include "simulation/scene_options.h"
#include "simulation/simulate_part.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;
constexpr int kExitFailed = 1, kExitUsage = 2;

struct Arguments {
  SimulationRequest request;
  std::string rig, out;
  double image_scale = 1.0;
  int threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  bool force = false, quiet = false, rig_only = false;
};

// Else CLI11 takes -1 for the largest number there is. Its way to say that all is well: "".
std::string RequireNoSign(const std::string& number) {
  if (!number.starts_with('-')) return "";
  return fmt::format("expected a whole number of 0 or more, found {}", number);
}

void AddOptions(CLI::App& app, Arguments& a) {
  SimulationRequest& r = a.request;
  app.add_option("--scene", r.scene, fmt::format("{}", fmt::join(kSceneNames, ", ")))->required();
  app.add_option("--path", r.path, fmt::format("{}", fmt::join(kPathNames, ", ")))->required();
  app.add_option("--pairs", r.pairs, "Pairs of images to drive through")->required();
  app.add_option("--spacing", r.spacing_m,
                 "Metres from pair to pair: 0.2 as in Katwijk's traverse "
                 "3, 0.63 as in 1 and 2")
      ->required();
  app.add_option("--seed", r.seed, "Equal seeds give equal bytes")
      ->required()
      ->check(CLI::Validator(RequireNoSign, ""));
  app.add_option("--fault", r.faults, "NAME=VALUE, see below; may be repeated")
      ->allow_extra_args(false);
  app.add_option("--out", a.out, "Folder for data/ and truth/")->required();
  app.add_option("--rig", a.rig, "Rig file; default: LocCam");
  app.add_option(
         "--image-scale", a.image_scale,
         "Size of the images, as a share of the rig file's: 0.5 takes a quarter of the time")
      ->check(CLI::Range(0.1, 2.0))
      ->capture_default_str();
  app.add_option("--contrast", r.contrast, "Factor on the sand's and rocks' texture")
      ->capture_default_str();
  app.add_option("--interval", r.interval_s, "Seconds from pair to pair")->capture_default_str();
  app.add_option("--clock-offset", r.clock_offset_s,
                 "Seconds by which GPS stamps are later than the images' clock")
      ->capture_default_str();
  app.add_option("--traverse", r.traverse, "Traverse to call it")->capture_default_str();
  app.add_option("--part", r.part, "Part to call it")->capture_default_str();
  app.add_option("--depth-every", r.depth_every, "Frames from one true depth map to the next")
      ->capture_default_str();
  app.add_flag("!--no-surface", r.true_surface,
               "Leave the true surface out, which takes longer than the images of a short drive; "
               "without it maps cannot be judged");
  app.add_option("--surface-within", r.surface_reach_m,
                 "Metres from the path within which the true surface is written")
      ->check(CLI::Range(0.5, 7.0))
      ->capture_default_str();
  app.add_option("--markers", r.markers, "Discs in the sand to check the cameras with")
      ->capture_default_str();
  app.add_option("--threads", a.threads, "Threads; default: one per core");
  app.add_flag("--rig-only", a.rig_only,
               "Write data/rig.yaml and truth/rig.yaml alone: another --rig-error for images that "
               "are there already");
  app.add_flag("--force", a.force, "Replace the output folder, where it holds a simulated drive");
  app.add_flag("--quiet", a.quiet, "No progress, errors only");
  app.add_option("--rig-error", r.rig_errors,
                 "NAME=VALUE, see below: what data/rig.yaml says differs from the rig by so much; "
                 "may be repeated")
      ->allow_extra_args(false);
  app.footer("Faults:\n" + DescribeFaultNames() + "Errors of the calibration:\n" +
             DescribeRigErrorNames());
}

// Something in the folder that a simulation, finished or not, does not leave there.
std::optional<fs::path> StrangerIn(const fs::path& folder) {
  for (const auto& entry : fs::directory_iterator(folder)) {
    const fs::path name = entry.path().filename();
    if (name != "data" && name != "truth") return name;
  }
  return std::nullopt;
}

// What a run that was killed has left beside the folder it would have made.
std::optional<fs::path> UnfinishedBeside(const fs::path& out) {
  const fs::path parent = fs::absolute(out).parent_path();
  if (!fs::is_directory(parent)) return std::nullopt;
  for (const auto& entry : fs::directory_iterator(parent)) {
    const fs::path name = entry.path().filename();
    if (IsTemporaryName(name.string()) && name.stem() == out.filename()) return entry.path();
  }
  return std::nullopt;
}

bool IsSimulation(const fs::path& folder) {
  return !StrangerIn(folder) && fs::exists(folder / "data" / "rig.yaml") &&
         fs::exists(folder / "truth" / "rig.yaml");
}

// Nothing is taken away that this program did not write.
void RequireUsableFolder(const fs::path& name, bool force) {
  const fs::path out = name.has_filename() ? name : name.parent_path();
  if (const auto unfinished = UnfinishedBeside(out); unfinished && fs::is_directory(*unfinished)) {
    if (const auto stranger = StrangerIn(*unfinished)) {
      throw DataError(
          fmt::format("{}: expected nothing, or what was left of a simulation, found {}",
                      unfinished->string(), stranger->string()));
    }
  }
  if (!fs::exists(out)) return;
  if (!fs::is_directory(out)) {
    throw DataError(fmt::format("{}: expected a folder or nothing, found a file", out.string()));
  }
  if (fs::is_empty(out)) return;
  if (!IsSimulation(out)) {
    throw DataError(
        fmt::format("{}: expected a simulated drive, an empty folder or nothing, found {}",
                    out.string(), StrangerIn(out).value_or("no rig files").string()));
  }
  if (!force) {
    throw DataError(
        fmt::format("{}: expected an empty folder or nothing, found a simulated drive; --force "
                    "replaces it",
                    out.string()));
  }
}

int Main(int argc, char** argv) {
  CLI::App app("Simulates a rover's stereo drive over a beach: data in Katwijk's form, and truth",
               "rigmap-simulate");
  Arguments a;
  AddOptions(app, a);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help
    throw UsageError(fmt::format("{} (--help lists what there is)", error.what()));
  }
  if (a.threads < 1) {
    throw UsageError(fmt::format("--threads: expected 1 or more, found {}", a.threads));
  }
  a.request.Validate();
  RequireUsableFolder(a.out, a.force);
  a.request.rig = Scaled(
      ReadRigFile(a.rig.empty() ? ConfigFile("rigs/loccam.yaml") : fs::path(a.rig)), a.image_scale);
  cv::setNumThreads(1);
  Job(a.threads, a.quiet).Run([&] {
    WriteFolderAtomically(a.out, [&](const fs::path& folder) {
      (a.rig_only ? WriteRigFiles : SimulatePart)(a.request, folder);
    });
  });
  return 0;
}

}  // namespace
}  // namespace rigmap

int main(int argc, char** argv) {
  try {
    return rigmap::Main(argc, argv);
  } catch (const rigmap::UsageError& error) {
    fmt::print(stderr, "rigmap-simulate: {}\n", error.what());
    return rigmap::kExitUsage;
  } catch (const std::exception& error) {
    fmt::print(stderr, "rigmap-simulate: {}\n", error.what());
    return rigmap::kExitFailed;
  }
}
