// SPDX-License-Identifier: MIT
/// @file
/// @brief Everything of the motion room.
#pragma once

#include <surfleet/motion/fwd.hpp>

#include <surfleet/motion/ball_cover.hpp>
#include <surfleet/motion/body_check.hpp>
#include <surfleet/motion/cell_sample.hpp>
#include <surfleet/motion/collision_body.hpp>
#include <surfleet/motion/flight_lattice.hpp>
#include <surfleet/motion/free_space.hpp>
#include <surfleet/motion/free_space_options.hpp>
#include <surfleet/motion/kinematics.hpp>
#include <surfleet/motion/lattice_path.hpp>
#include <surfleet/motion/lazy_prm.hpp>
#include <surfleet/motion/low_level_planner.hpp>
#include <surfleet/motion/obstacle_voxels.hpp>
#include <surfleet/motion/optimistic_lattice.hpp>
#include <surfleet/motion/path.hpp>
#include <surfleet/motion/path_follower.hpp>
#include <surfleet/motion/reachable_set.hpp>
#include <surfleet/motion/roadmap_passages.hpp>
#include <surfleet/motion/shortcut.hpp>
#include <surfleet/motion/string_pulling.hpp>
#include <surfleet/motion/swept_body.hpp>
#include <surfleet/motion/tangent_bug.hpp>
#include <surfleet/motion/traffic_policy.hpp>
