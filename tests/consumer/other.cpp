// SPDX-License-Identifier: MIT
// A second translation unit that includes everything: no header may define what it should not.
#include <surfleet/adapters/fcl_mesh_judge.hpp>
#include <surfleet/surfleet.hpp>

std::size_t blocks_elsewhere(const surfleet::TsdfMap& map);
std::size_t blocks_elsewhere(const surfleet::TsdfMap& map) { return map.block_count(); }
