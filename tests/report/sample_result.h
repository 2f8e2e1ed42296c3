// A finished result as files, small and known.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <numbers>
#include <string>

#include "export/ply.h"
#include "report/figures.h"
#include "tests/support/temporary_folder.h"

namespace rigmap {

// The keys that a report cannot do without, and a few numbers.
inline Json SampleSummary(const std::string& status = "ok") {
  return {
      {"status", status},
      {"reason", status == "ok" ? Json(nullptr) : Json("because of <b>this</b>")},
      {"technique", "rig"},
      {"stages", {{{"name", "dense"}, {"seconds", 12.5}, {"peak_rss_mb", 370.0}}}},
      {"frames", {{"read", 8}, {"paired", 4}, {"keyframes", 4}, {"registered", 4}, {"posed", 4}}},
      {"mapping", {{"remarks", {"a <script>remark()</script>"}}}},
      {"gates",
       {{{"name", "registered"},
         {"value", 1.0},
         {"limit", 0.9},
         {"passed", true},
         {"why", "share of keyframes in the model used"}}}},
      {"verdict",
       {{"text", "metres good to 0.31 %"},
        {"scale_95_pct", 0.3074684517416307},
        {"position_95_m", 0.016755793352781743},
        {"known", {{"path_m", 3.0}}}}},
      {"versions", {{"rigmap", "0.1.0"}, {"colmap", "3.8"}}},
      {"command", "rigmap part --dataset '<script>alert(1)</script>'"}};
}

// Along x at 1.5 m, a metre a step, looking ahead and down; sigmas grow.
inline std::string SampleTrajectory(int poses, double step_m = 1.0) {
  std::string text = "stamp_ns,tx,ty,tz,qx,qy,qz,qw,sx,sy,sz,srx,sry,srz,source,keyframe\n";
  for (int i = 0; i < poses; ++i) {
    text +=
        fmt::format("{},{},0,1.5,-0.5963678,0.5963678,-0.3799282,0.3799282,{},{},{},0,0,0,{},1\n",
                    1'000'000'000'000 + 1'000'000'000LL * i, step_m * i - 1.0, 1e-4 * i, 1e-4 * i,
                    1e-4 * i, i == 2 ? "odometry" : "adjusted");
  }
  return text;
}

// A plane of 1 cm with two posts, whose tops are single points at (0, 0, 1) and (2, 0, 1).
inline PointCloud SamplePlane() {
  PointCloud cloud;
  const auto add = [&](double x, double y, double z, std::uint8_t grey) {
    SurfacePoint point;
    point.x_in_world = Eigen::Vector3d(x, y, z).cast<float>();
    point.rgb = {grey, grey, grey};
    point.observations = 5;
    point.sigma_m = 0.002F;
    point.grain_m = 0.01F;
    cloud.push_back(point);
  };
  for (int i = -100; i < 300; ++i) {
    for (int k = -100; k < 100; ++k) {
      add(0.01 * i, 0.01 * k, 0.0, static_cast<std::uint8_t>(90 + (i + 7 * k + 1000) % 60));
    }
  }
  for (const double x : {0.0, 2.0}) {
    for (int i = 1; i <= 5; ++i) add(x, 0.0, 0.2 * i, 250);
  }
  return cloud;
}

inline void WriteSamplePly(const std::filesystem::path& path, const PointCloud& cloud) {
  std::ofstream stream(path, std::ios::binary);
  PlyWriter writer(stream);
  writer.Write(cloud);
  writer.Finish();
}

inline std::filesystem::path WriteSampleResult(const TemporaryFolder& folder,
                                               const std::string& name = "result",
                                               const Json& summary = SampleSummary()) {
  const std::filesystem::path root = folder.Path() / name;
  folder.Write(name + "/summary.json", summary.dump(1));
  folder.Write(name + "/trajectory.csv", SampleTrajectory(4));
  WriteSamplePly(root / "dense.ply", SamplePlane());
  return root;
}

}  // namespace rigmap
