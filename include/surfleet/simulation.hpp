// SPDX-License-Identifier: MIT
/// @file
/// @brief Everything of the simulation room.
#pragma once

#include <surfleet/simulation/fwd.hpp>

#include <surfleet/simulation/agreeing_judges.hpp>
#include <surfleet/simulation/body_judge.hpp>
#include <surfleet/simulation/catch_up.hpp>
#include <surfleet/simulation/climbing_scenes.hpp>
#include <surfleet/simulation/depth_camera.hpp>
#include <surfleet/simulation/distributed_mission.hpp>
#include <surfleet/simulation/distributed_simulation.hpp>
#include <surfleet/simulation/drone_world.hpp>
#include <surfleet/simulation/fly_distributed.hpp>
#include <surfleet/simulation/fly_mission.hpp>
#include <surfleet/simulation/house.hpp>
#include <surfleet/simulation/judge.hpp>
#include <surfleet/simulation/lidar_world.hpp>
#include <surfleet/simulation/marker_images.hpp>
#include <surfleet/simulation/marker_sight.hpp>
#include <surfleet/simulation/mesh_map.hpp>
#include <surfleet/simulation/mission.hpp>
#include <surfleet/simulation/mission_record.hpp>
#include <surfleet/simulation/planar_environments.hpp>
#include <surfleet/simulation/powerplant.hpp>
#include <surfleet/simulation/presets.hpp>
#include <surfleet/simulation/random_scene.hpp>
#include <surfleet/simulation/rotating_lidar.hpp>
#include <surfleet/simulation/scene.hpp>
#include <surfleet/simulation/scenes.hpp>
#include <surfleet/simulation/simulated_drone.hpp>
#include <surfleet/simulation/simulation.hpp>
#include <surfleet/simulation/statue.hpp>
#include <surfleet/simulation/steam_chest.hpp>
#include <surfleet/simulation/stereo_noise.hpp>
#include <surfleet/simulation/surfaces.hpp>
#include <surfleet/simulation/target_motions.hpp>
#include <surfleet/simulation/world_model.hpp>
