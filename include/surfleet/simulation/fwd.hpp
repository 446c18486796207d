// SPDX-License-Identifier: MIT
/// @file
/// @brief Declarations of the simulation room, for headers that only name its types.
#pragma once

namespace surfleet {
struct BumpySlopeOptions;
class CameraMotion;
struct CameraMotionOptions;
struct DroneWorldOptions;
struct HoledTubeOptions;
struct ImageDisc;
struct JudgeReport;
class MarkerImages;
struct MarkerImageOptions;
struct LidarWorldOptions;
struct MarkerSightOptions;
struct MissionOptions;
struct MissionPreset;
struct MissionProgress;
struct MissionResult;
struct NoNoise;
struct PlanarEnvironment;
struct RandomSceneId;
struct RandomSceneSpec;
struct RotatingLidar;
struct Scene;
struct SceneOptions;
class SceneSpace;
struct StartOptions;
struct StereoNoise;
struct TimedConfiguration;
}  // namespace surfleet
