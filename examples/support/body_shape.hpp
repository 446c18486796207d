// SPDX-License-Identifier: MIT
/// @file
/// @brief The shape of a drone's body as the command line gives it.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/ellipsoid.h>

#include <surfleet/adapters/fcl_body.hpp>
#include <surfleet/core/error.hpp>
#include <surfleet/core/parse_number.hpp>
#include <surfleet/motion/collision_body.hpp>
#include <surfleet/planning/robot_kind.hpp>

namespace surfleet::examples {
/// An ellipsoid or a box about the body's position, turned with the heading.
struct BodyShape {
  bool box = false;
  Eigen::Vector3d half = Eigen::Vector3d::Zero();  ///< Half its extent forward, left and up [m].

  /// Of the ball that holds it [m].
  double radius() const { return box ? half.norm() : half.maxCoeff(); }
  /// The same shape to the judge, which knows all by FCL.
  FclBody judged() const {
    if (box) return FclBody(std::make_shared<fcl::Boxd>(2.0 * half), half.minCoeff());
    return FclBody(std::make_shared<fcl::Ellipsoidd>(half), half.minCoeff());
  }
  void give_to(RobotKind& kind) const {
    if (box)
      kind.take_shape(judged());
    else
      kind.take_shape(EllipsoidBody{half});
  }
};

/// `ellipsoid:A,B,C` with its semi-axes or `box:L,W,H` with its edges, forward, left and up [m].
/// Throws `Error` for anything else.
inline BodyShape parse_body_shape(const std::string& text) {
  const std::size_t colon = text.find(':');
  const std::string kind = text.substr(0, colon);
  BodyShape shape;
  shape.box = kind == "box";
  bool good = colon != std::string::npos && (shape.box || kind == "ellipsoid");
  std::string_view rest = good ? std::string_view(text).substr(colon + 1) : std::string_view();
  for (int k = 0; good && k < 3; ++k) {
    const std::size_t comma = rest.find(',');
    const auto length = parse_number<double>(std::string(rest.substr(0, comma)));
    good = length && *length > 0.0 && *length <= 100.0 &&
           (comma == std::string_view::npos) == (k == 2);
    if (!good) break;
    shape.half[k] = shape.box ? 0.5 * *length : *length;
    rest = k < 2 ? rest.substr(comma + 1) : std::string_view();
  }
  require(good,
          "--body " + text + ": expected ellipsoid:A,B,C or box:L,W,H with lengths in metres");
  return shape;
}
}  // namespace surfleet::examples
