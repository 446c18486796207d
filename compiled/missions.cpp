// SPDX-License-Identifier: MIT
#include <surfleet/simulation/detail/fly_mission.hpp>
