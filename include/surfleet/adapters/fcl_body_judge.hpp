// SPDX-License-Identifier: MIT
/// @file
/// @brief How far a body of any shape is from a true mesh, by FCL.
#pragma once

#include <memory>
#include <utility>

#include <surfleet/adapters/fcl_body.hpp>
#include <surfleet/adapters/fcl_mesh_judge.hpp>
#include <surfleet/simulation/body_judge.hpp>

namespace surfleet {
/// A robot's body against the scene's mesh. Thread-safe. O(log triangles) for meshes of some shape.
class FclBodyJudge {
 public:
  /// `mesh` is referred to and must outlive this.
  FclBodyJudge(const MeshJudge& mesh, FclBody body) : mesh_(&mesh), body_(std::move(body)) {}
  /// Distance from the body to the surface [m], 0 where they touch.
  double distance(const Configuration& q) const {
    return mesh_->distance(*body_.geometry(), q.pose());
  }

 private:
  const MeshJudge* mesh_;
  FclBody body_;
};
static_assert(BodyDistanceJudge<FclBodyJudge>);
}  // namespace surfleet
