// SPDX-License-Identifier: MIT
#include <surfleet/mapping/tsdf_map.hpp>

int main() {
  surfleet::TsdfMap map({.voxel_size = 0.3});
  map.ensure({1, 2, 3}).weight = 1.0F;
  return map.block_count() == 1 ? 0 : 1;
}
