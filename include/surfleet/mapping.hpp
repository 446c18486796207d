// SPDX-License-Identifier: MIT
/// @file
/// @brief Everything of the mapping room.
#pragma once

#include <surfleet/mapping/fwd.hpp>

#include <surfleet/mapping/any_integrator.hpp>
#include <surfleet/mapping/block_bits.hpp>
#include <surfleet/mapping/distance_transform.hpp>
#include <surfleet/mapping/grown_voxels.hpp>
#include <surfleet/mapping/map_file.hpp>
#include <surfleet/mapping/map_patch.hpp>
#include <surfleet/mapping/marching_cubes.hpp>
#include <surfleet/mapping/mesh_extractor.hpp>
#include <surfleet/mapping/moved_patch.hpp>
#include <surfleet/mapping/occupancy_integrator.hpp>
#include <surfleet/mapping/occupancy_map.hpp>
#include <surfleet/mapping/patch_codec.hpp>
#include <surfleet/mapping/patch_fusion.hpp>
#include <surfleet/mapping/patch_recorder.hpp>
#include <surfleet/mapping/projective_update.hpp>
#include <surfleet/mapping/ray_traversal_update.hpp>
#include <surfleet/mapping/surface_hits.hpp>
#include <surfleet/mapping/surface_mesh.hpp>
#include <surfleet/mapping/surface_points.hpp>
#include <surfleet/mapping/tsdf_integrator.hpp>
#include <surfleet/mapping/tsdf_map.hpp>
#include <surfleet/mapping/update_policy.hpp>
#include <surfleet/mapping/view_notes.hpp>
#include <surfleet/mapping/voxel_grid.hpp>
#include <surfleet/mapping/voxel_state_map.hpp>
#include <surfleet/mapping/voxel_traversal.hpp>
#include <surfleet/mapping/weight_policy.hpp>
