// The frames in order of time, those first that something is wrong with.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "report/html.h"
#include "report/part_content.h"

namespace rigmap {
namespace {

constexpr std::size_t kMostBadFrames = 40;

struct JudgedFrame {
  std::size_t index = 0;
  std::vector<std::string> faults;
};

std::vector<std::string> FaultsOf(const TimedPose& pose, const PartContent& content,
                                  double median_points) {
  std::vector<std::string> faults;
  if (pose.source == PoseSource::kPredicted) {
    faults.emplace_back("pose guessed: nothing in the images could be followed");
  } else if (pose.source == PoseSource::kOdometry && content.sparse) {
    faults.emplace_back("pose by odometry alone: not in the adjusted model");
  }
  if (!content.sparse) return faults;
  const auto image = content.sparse->images.find(pose.stamp_ns);
  if (image != content.sparse->images.end() &&
      static_cast<double>(image->second.points) < 0.25 * median_points) {
    faults.push_back(fmt::format("few points: {}, where the median frame has {:.0f}",
                                 image->second.points, median_points));
  }
  return faults;
}

std::vector<JudgedFrame> BadFrames(const PartContent& content) {
  const double median_points = content.sparse ? MedianPointsOfImages(*content.sparse) : 0.0;
  std::vector<JudgedFrame> bad;
  const Trajectory& trajectory = content.folder.trajectory;
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    std::vector<std::string> faults = FaultsOf(trajectory[i], content, median_points);
    if (!faults.empty()) bad.push_back({i, std::move(faults)});
  }
  return bad;
}

std::string FrameCaption(const PartContent& content, std::size_t index) {
  const Trajectory& trajectory = content.folder.trajectory;
  const double seconds =
      1e-9 * static_cast<double>(trajectory[index].stamp_ns - trajectory.front().stamp_ns);
  return fmt::format("frame {}, {:.1f} s", index, seconds);
}

// `with_id`: the one picture of the frame that scripts look for.
std::string Thumbnail(const PartContent& content, std::size_t index, const std::string& note,
                      bool with_id) {
  const auto found = content.thumbnails.find(content.folder.trajectory[index].stamp_ns);
  const std::string caption = FrameCaption(content, index);
  const std::string image =
      found == content.thumbnails.end()
          ? "<div class=\"missing\">no picture</div>"
          : fmt::format("<img loading=\"lazy\" {}src=\"{}\" alt=\"left image of {}\">",
                        with_id ? fmt::format("data-frame=\"{}\" ", index) : "", found->second,
                        caption);
  return fmt::format("<figure>{}<figcaption>{}{}</figcaption></figure>\n", image, caption, note);
}

std::string BadFramesOf(const PartContent& content) {
  const std::vector<JudgedFrame> bad = BadFrames(content);
  if (bad.empty()) return "<p>Every frame has a measured pose and enough points.</p>\n";
  std::string pictures;
  for (std::size_t i = 0; i < bad.size() && i < kMostBadFrames; ++i) {
    pictures += Thumbnail(content, bad[i].index,
                          fmt::format("<br>{}", fmt::join(bad[i].faults, "; ")), true);
  }
  const std::string more =
      bad.size() > kMostBadFrames ? fmt::format(", the first {} of them here", kMostBadFrames) : "";
  return fmt::format("<h3>{} frames that stand out{}</h3>\n<div class=\"thumbnails\">{}</div>\n",
                     bad.size(), more, pictures);
}

std::string AllFrames(const PartContent& content) {
  std::set<std::size_t> shown;
  const std::vector<JudgedFrame> bad = BadFrames(content);
  for (std::size_t i = 0; i < bad.size() && i < kMostBadFrames; ++i) shown.insert(bad[i].index);
  std::string pictures;
  for (std::size_t i = 0; i < content.folder.trajectory.size(); ++i) {
    if (shown.contains(i)) continue;
    if (!content.thumbnails.contains(content.folder.trajectory[i].stamp_ns)) continue;
    pictures += Thumbnail(content, i, "", true);
  }
  if (pictures.empty()) return "";
  return fmt::format(
      "<details class=\"all-frames\"><summary>Images of {} frames</summary>\n"
      "<div class=\"thumbnails\">{}</div></details>\n",
      content.thumbnails.size(), pictures);
}

// One mark per frame, of the colour of how its pose was got.
std::string Timeline(const PartContent& content) {
  const Trajectory& trajectory = content.folder.trajectory;
  if (trajectory.size() < 2) return "";
  std::string marks;
  const double width = 1000.0 / static_cast<double>(trajectory.size());
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    const std::size_t first = i;
    const PoseSource source = trajectory[i].source;
    while (i + 1 < trajectory.size() && trajectory[i + 1].source == source) ++i;
    marks += fmt::format(
        "<rect class=\"{}\" x=\"{:.2f}\" y=\"0\" width=\"{:.2f}\" height=\"18\">"
        "<title>frames {} to {}: {}</title></rect>\n",
        Name(source), width * static_cast<double>(first),
        width * static_cast<double>(i - first + 1), first, i, Name(source));
  }
  return "<svg class=\"timeline\" role=\"img\" aria-label=\"how each frame's pose was got\" "
         "viewBox=\"0 0 1000 18\" preserveAspectRatio=\"none\">" +
         marks +
         "</svg>\n<p class=\"legend-line\"><span><i class=\"key "
         "adjusted\"></i>adjusted</span><span>"
         "<i class=\"key odometry\"></i>odometry</span><span><i class=\"key "
         "predicted\"></i>guessed</span></p>\n";
}

std::string ListOf(const Json& summary, const std::vector<const char*>& pointers,
                   const char* heading) {
  std::string list;
  for (const char* pointer : pointers) {
    for (const Json& line : At(summary, pointer)) {
      if (line.is_string()) list += "<li>" + Escaped(line.get<std::string>()) + "</li>\n";
    }
  }
  return list.empty() ? "" : fmt::format("<h3>{}</h3><ul>{}</ul>\n", heading, list);
}

}  // namespace

std::set<StampNs> FramesThatStandOut(const PartContent& content) {
  std::set<StampNs> stamps;
  for (const JudgedFrame& frame : BadFrames(content)) {
    if (stamps.size() == kMostBadFrames) break;
    stamps.insert(content.folder.trajectory[frame.index].stamp_ns);
  }
  return stamps;
}

std::string FramesSection(const PartContent& content) {
  const FigureSource summary = content.folder.Summary();
  HtmlTable table({"Images", "Pairs", "Keyframes", "Mapped by COLMAP", "Posed"});
  if (HasFigure(summary, "/frames/read")) {
    table.Row({Figure(summary, "/frames/read", Quantity::kCount),
               Figure(summary, "/frames/paired", Quantity::kCount),
               Figure(summary, "/frames/keyframes", Quantity::kCount),
               Figure(summary, "/frames/registered", Quantity::kCount),
               Figure(summary, "/frames/posed", Quantity::kCount)});
  }
  std::string body = table.Text() + Timeline(content);
  if (!content.folder.trajectory.empty()) body += BadFramesOf(content);
  body += ListOf(summary.json, {"/health/unreadable_images"}, "Images that cannot be read");
  body += ListOf(summary.json, {"/health/remarks", "/mapping/remarks"}, "Remarks");
  body += AllFrames(content);
  return HtmlSection("frames", "Frames", "How each frame's pose was got, in order of time.", body);
}

}  // namespace rigmap
