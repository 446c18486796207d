// SPDX-License-Identifier: MIT
/// @file
/// @brief Everything of the geometry room.
#pragma once

#include <surfleet/geometry/fwd.hpp>

#include <surfleet/geometry/bvh.hpp>
#include <surfleet/geometry/camera_models.hpp>
#include <surfleet/geometry/clean_surface.hpp>
#include <surfleet/geometry/cloud_filters.hpp>
#include <surfleet/geometry/cloud_normals.hpp>
#include <surfleet/geometry/curvature.hpp>
#include <surfleet/geometry/delaunay.hpp>
#include <surfleet/geometry/geodesic.hpp>
#include <surfleet/geometry/graph.hpp>
#include <surfleet/geometry/graph_components.hpp>
#include <surfleet/geometry/grey_image.hpp>
#include <surfleet/geometry/incremental_search.hpp>
#include <surfleet/geometry/kd_tree.hpp>
#include <surfleet/geometry/keep_out.hpp>
#include <surfleet/geometry/lidar_model.hpp>
#include <surfleet/geometry/matching.hpp>
#include <surfleet/geometry/mesh_adjacency.hpp>
#include <surfleet/geometry/mesh_borders.hpp>
#include <surfleet/geometry/mesh_io.hpp>
#include <surfleet/geometry/mesh_primitives.hpp>
#include <surfleet/geometry/pinhole_camera.hpp>
#include <surfleet/geometry/ply.hpp>
#include <surfleet/geometry/point_cloud.hpp>
#include <surfleet/geometry/point_location.hpp>
#include <surfleet/geometry/point_moments.hpp>
#include <surfleet/geometry/polygon.hpp>
#include <surfleet/geometry/polygon_clipping.hpp>
#include <surfleet/geometry/polygon_geodesic.hpp>
#include <surfleet/geometry/polygon_trapezoids.hpp>
#include <surfleet/geometry/polygon_visibility.hpp>
#include <surfleet/geometry/pose_io.hpp>
#include <surfleet/geometry/predicates.hpp>
#include <surfleet/geometry/prism.hpp>
#include <surfleet/geometry/ray_caster.hpp>
#include <surfleet/geometry/sensor_reading.hpp>
#include <surfleet/geometry/simplify.hpp>
#include <surfleet/geometry/stamped_files.hpp>
#include <surfleet/geometry/teammate_mask.hpp>
#include <surfleet/geometry/text_scanner.hpp>
#include <surfleet/geometry/triangle_mesh.hpp>
#include <surfleet/geometry/triangle_queries.hpp>
