// SPDX-License-Identifier: MIT
/// @file
/// @brief Everything of the room `localization`: where a target of like markers is, from one image,
/// how sure that is, and when it cannot be told [004 ch. 9].
#pragma once

#include <surfleet/localization/fwd.hpp>

#include <surfleet/localization/blobs.hpp>
#include <surfleet/localization/connected_components.hpp>
#include <surfleet/localization/estimate_pose.hpp>
#include <surfleet/localization/hough_circles.hpp>
#include <surfleet/localization/identify.hpp>
#include <surfleet/localization/identify_targets.hpp>
#include <surfleet/localization/image_thresholds.hpp>
#include <surfleet/localization/image_tracker.hpp>
#include <surfleet/localization/marker_target.hpp>
#include <surfleet/localization/nelder_mead.hpp>
#include <surfleet/localization/observation.hpp>
#include <surfleet/localization/p3p.hpp>
#include <surfleet/localization/p3p_kneip.hpp>
#include <surfleet/localization/p3p_lambda_twist.hpp>
#include <surfleet/localization/pose_prediction.hpp>
#include <surfleet/localization/predicted_match.hpp>
#include <surfleet/localization/refine_pose.hpp>
#include <surfleet/localization/sphere_outline.hpp>
#include <surfleet/localization/target_design.hpp>
#include <surfleet/localization/target_tracker.hpp>
#include <surfleet/localization/uncertain_pose.hpp>
