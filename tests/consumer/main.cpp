// SPDX-License-Identifier: MIT
#include <surfleet/adapters/fcl_mesh_judge.hpp>
#include <surfleet/surfleet.hpp>

std::size_t blocks_elsewhere(const surfleet::TsdfMap& map);

int main() {
  surfleet::TsdfMap map{{.voxel_size = 0.3}};
  map.ensure({1, 2, 3}).weight = 1.0F;
  return blocks_elsewhere(map) == 1 ? 0 : 1;
}
