#include "raster/raster_options.h"

namespace rigmap {

OptionFields RasterOptions::Fields() {
  return {
      {"max_hole_cells", &max_hole_cells, "cells", AtLeast(0).UpTo(100),
       "Widest hole that is filled, however long. Three: a voxel that missed its few observations, "
       "and its neighbours. Wider holes are shadows and far ground, where a value would be a "
       "guess."},
  };
}

OptionFields FootprintOptions::Fields() {
  return {
      {"footprint_m", &footprint_m, "m", AtLeast(0.0).UpTo(100.0),
       "Diameter of the circle of ground that carries the rover, over which slope, roughness and "
       "step height are taken. 0: that of the circle around the wheels that the rig file states, "
       "else 1 m, the size of the rovers whose drives these are."},
      {"max_slope_deg", &max_slope_deg, "deg", MoreThan(0.0).Below(90.0),
       "Slope whose excess has a probability. Wheels on dry loose sand begin to slip without end "
       "at about half its angle of repose of 30 to 35 degrees."},
      {"level_sigma_deg", &level_sigma_deg, "deg", AtLeast(0.0).UpTo(90.0),
       "Sigma of the world's up about each axis, which all slopes share: 0.01 rad, as "
       "dead_reckoning.inclinometer_sigma_rad. Where up comes from the ground or the camera, "
       "slopes "
       "are relative to that."},
  };
}

OptionFields PictureOptions::Fields() {
  return {
      {"picture_px", &picture_px, "px", AtLeast(1000).UpTo(4096),
       "Longest side of a picture: fits a screen and a page."},
  };
}

}  // namespace rigmap
