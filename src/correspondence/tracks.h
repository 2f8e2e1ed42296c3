// Pairwise correspondences joined into tracks.
#pragma once

#include <vector>

#include "scene/correspondences.h"

namespace rigmap {

// Joins matches that share a feature. Where that would put two features of one frame into a track,
// the match that came later (in the order of pairs) is dropped. Besides tracks over several frames,
// every feature with a stereo match that no match names makes a track of its own if
// `with_single_frames`. Deterministic; nearly linear in the number of matches.
std::vector<Track> BuildTracks(const Correspondences& correspondences, bool with_single_frames);

// Cut before each of these frames, which rise: a track for each side that one has elements on.
std::vector<Track> CutTracks(std::vector<Track> tracks, const std::vector<int>& frames);

}  // namespace rigmap
