#include "adjustment/adjustment_options.h"

namespace rigmap {
namespace {

constexpr const char* kPrior =
    " Sigma of the prior that draws the rig back to it, as good calibrations with a board scatter "
    "when they are repeated; it also counts in the sigmas of poses and scale.";

OptionFields ResidualFields(AdjustmentOptions& o) {
  return {
      {"huber_sigmas", &o.huber_sigmas, "robust sigmas", MoreThan(0.0),
       "Residuals beyond this are weighted down (Huber). The sigma is the part's own, but at least "
       "min_noise_px."},
      {"outlier_sigmas", &o.outlier_sigmas, "robust sigmas", MoreThan(0.0),
       "Observations beyond this are dropped between rounds."},
      {"min_noise_px", &o.min_noise_px, "px", MoreThan(0.0),
       "Least sigma of an observation, whatever the residuals say."},
      {"shared_noise", &o.shared_noise, "", AtLeast(1.0),
       "Sigmas of poses grow by this factor, beside what the residuals of whole tracks say: noise "
       "that all observations of a frame share (windows that are drawn aside by the same "
       "perspective, relief within them) leaves no trace in residuals. Variances of the rig's "
       "calibration grow by a third of what it adds to those of poses, and by what all windows "
       "have in common. With 2 the squared errors of simulated drives, over the variances stated, "
       "are 0.7 to 1.2 by kind of drive (tools/sigmas)."},
      {"max_depth_baselines", &o.max_depth_baselines, "baselines", MoreThan(0.0),
       "Points further away are left out: they have less than a pixel of disparity and hardly move "
       "the result."},
      {"rounds", &o.rounds, "", AtLeast(2).UpTo(20),
       "Rounds of triangulating, adjusting and dropping observations. The rig is corrected before "
       "the last one."},
  };
}

}  // namespace

OptionFields AdjustmentOptions::Fields() {
  const OptionFields rig = {
      {"refine_rig",
       ChoiceOf(&refine_rig),
       "",
       {},
       "none: the calibration is kept. rotation: the right eye's rotation is corrected. "
       "rotation+focal: also one factor on all focal lengths. all-but-focal: rotation, principal "
       "points, distortion (k1 k2 p1 p2), fy / fx and a factor between the eyes' focal lengths. "
       "all: both. "
       "auto: none, then all-but-focal, then all, each step taken only where stretches of the part "
       "that were left out fit better with it (refine_sigmas), and by enough to matter, a "
       "twentieth of the prior; all only where regions of the image that were left out fit better, "
       "too. The baseline's length never moves: it is where the metres come from. A corrected rig "
       "is written to rig_refined.yaml and can serve as --rig."},
      {"refine_sigmas", &refine_sigmas, "sigmas", MoreThan(0.0),
       "How much better stretches of the part that were left out must fit, in sigmas, before "
       "refine_rig auto frees more of the rig: each of eight stretches is compared with a rig that "
       "was corrected from the others. No more than one of them may fit worse. For the focal "
       "length regions of the image have to gain as much, both at least half of what it would "
       "explain, and what is asked for to be so many times what they disagree by (jackknife). The "
       "sigmas are those of residuals, inflated by what residuals of whole tracks say and by "
       "shared_noise; chance exceeds three once in 700 times."},
      {"lens_field_px", &lens_field_px, "px", AtLeast(0.0),
       "What a lens does beyond its model: with refine_rig auto, where stretches of the part that "
       "were left out fit better with it, residuals that are the same in all frames are taken out "
       "by displacements of the pixels of each eye, bilinear over a grid of ten cells along the "
       "image. Their sigma is the part's own, at most this: residuals of calibrations with a board "
       "are larger. 0: never."},
  };
  const OptionFields priors = {
      {"rig_prior_deg", &rig_prior_deg, "degrees", MoreThan(0.0),
       std::string("How far the rotation of a calibration may be off.") + kPrior},
      {"focal_prior_pct", &focal_prior_pct, "per cent", MoreThan(0.0),
       "The same of focal lengths; further out than this it pulls ever less (Student's t with "
       "three degrees of freedom)."},
      {"aspect_prior_pct", &aspect_prior_pct, "per cent", MoreThan(0.0),
       "The same of fy / fx of both eyes, and of its ratio between them; that of both with as "
       "heavy a tail."},
      {"principal_point_prior_px", &principal_point_prior_px, "px", MoreThan(0.0),
       "The same of principal points."},
      {"distortion_prior_px", &distortion_prior_px, "px", MoreThan(0.0),
       "The same of the distortion: of each of k1, k2, p1 and p2, what it moves a pixel in the "
       "corner of the image by."},
      {"board_noise_px", &board_noise_px, "px", MoreThan(0.0),
       "What a calibration with a board leaves unknown of all these together, beside each by "
       "itself: rotation, principal points and distortion can make up for each other where the "
       "board was, and not where it was not. Noise of its corners in 25 views; of the size by "
       "which two calibrations of one rig differed."},
  };
  return JoinFields({rig, priors, ResidualFields(*this)});
}

}  // namespace rigmap
