// SPDX-License-Identifier: MIT
#include <surfleet/planning/detail/make_planner.hpp>
