// Between our clouds and those of PCL.
#pragma once

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include "geometry/rigid3.h"
#include "registration/frame_cloud.h"

namespace rigmap {

// `curvature` carries sigma_m through PCL's filters.
using PclPoint = pcl::PointXYZRGBNormal;
using PclCloud = pcl::PointCloud<PclPoint>;

PclCloud::Ptr ToPcl(const FrameCloud& cloud);
// The same points in b's axes, behind those that are there.
void AppendMoved(const FrameCloud& cloud, const Rigid3& b_from_left, PclCloud& all);
FrameCloud FromPcl(const PclCloud& cloud);

// The mean of the points in each box of a grid.
PclCloud::Ptr OnGrid(const PclCloud::Ptr& cloud, double grid_m);

}  // namespace rigmap
