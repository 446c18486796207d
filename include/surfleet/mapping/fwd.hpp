// SPDX-License-Identifier: MIT
/// @file
/// @brief Declarations of the mapping room, for headers that only name its types.
#pragma once

namespace surfleet {
class AnyIntegrator;
struct ConstantWeight;
class GrownVoxels;
struct InverseSquareWeight;
struct ViewNotes;
struct MapFileOptions;
struct MapPatch;
class MeshExtractor;
struct MeshOptions;
class OccupancyIntegrator;
struct OccupancyOptions;
struct OccupancyVoxel;
class PatchFusion;
struct PatchFusionOptions;
struct PatchId;
struct PatchKey;
struct PatchLimits;
class PatchRecorder;
struct PatchRecorderOptions;
class ProjectiveUpdate;
class RayTraversalUpdate;
struct TsdfOptions;
struct TsdfVoxel;
struct VoxelGridOptions;
class VoxelStateMap;
struct VoxelStateOptions;

class SurfaceHits;
template <typename Voxel, int kSide, typename Layer>
class VoxelGrid;
using TsdfMap = VoxelGrid<TsdfVoxel, 8, SurfaceHits>;
}  // namespace surfleet
