// SPDX-License-Identifier: MIT
/// @file
/// @brief Declarations of the simulation room, for headers that only name its types.
#pragma once

namespace surfleet {
struct BumpySlopeOptions;
struct DroneWorldOptions;
struct JudgeReport;
struct MissionOptions;
struct MissionPreset;
struct MissionProgress;
struct MissionResult;
struct NoNoise;
struct PlanarEnvironment;
struct RandomSceneId;
struct RandomSceneSpec;
struct Scene;
struct SceneOptions;
class SceneSpace;
struct StartOptions;
struct StereoNoise;
struct TimedConfiguration;
}  // namespace surfleet
