// SPDX-License-Identifier: MIT
#include <surfleet/simulation/detail/fly_distributed.hpp>
#include <surfleet/simulation/detail/fly_mission.hpp>
