// SPDX-License-Identifier: MIT
#include <surfleet/mapping/surface_mesh.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <surfleet/geometry/bvh.hpp>

#include "check.hpp"
#include "seen_sheet.hpp"

using namespace surfleet;
using namespace surfleet::test;

namespace {
constexpr double kHalf = 1.2;  // of a slab's width [m]

/// The frame of a slab through about the origin: its normal is z.
Pose slab_frame(const Eigen::Vector3d& normal, const Point3& at) {
  Pose T = Pose::Identity();
  T.linear() =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), normal).toRotationMatrix();
  T.translation() = at;
  return T;
}
/// A square slab, down to no thickness at all.
auto slab(const Pose& T_world_slab, double thickness) {
  const Pose T = T_world_slab.inverse();
  return [T, thickness](const Point3& o, const Eigen::Vector3d& d) -> std::optional<double> {
    const Point3 from = T * o;
    const Eigen::Vector3d along = T.linear() * d, half(kHalf, kHalf, 0.5 * thickness);
    double enter = 0.0, leave = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 3; ++k) {
      const double a = (-half[k] - from[k]) / along[k], b = (half[k] - from[k]) / along[k];
      enter = std::max(enter, std::min(a, b));
      leave = std::min(leave, std::max(a, b));
    }
    return enter <= leave && enter > 0.0 ? std::optional(enter) : std::nullopt;
  };
}
/// A slab whose lower face is slanted: from nothing on one side to `thickness` on the other.
auto wedge(const Pose& T_world_slab, double thickness) {
  const Pose T = T_world_slab.inverse();
  const auto whole = slab(T_world_slab, thickness);
  return [=](const Point3& o, const Eigen::Vector3d& d) -> std::optional<double> {
    const Eigen::Vector3d below(-0.5 * thickness / kHalf, 0.0, -1.0);  // below · p < 0 in the body
    const double from = below.dot(T * o), along = below.dot(T.linear() * d);
    const auto hit = whole(o, d);
    if (!hit || from + *hit * along <= 0.0) return hit;
    const double cut = -from / along;
    const Point3 p = T * Point3(o + cut * d);
    const bool met = cut > *hit && p.head<2>().cwiseAbs().maxCoeff() <= kHalf &&
                     std::abs(p.z()) <= 0.5 * thickness;
    return met ? std::optional(cut) : std::nullopt;
  };
}
/// What `views` images from each side leave behind.
template <typename Body>
TsdfMap seen_from_both_sides(const Body& body, const Pose& T_world_slab, int views,
                             double voxel_size) {
  TsdfMap map({.voxel_size = voxel_size});
  TsdfIntegrator integrate({.truncation = 3.0 * voxel_size}, drop_off_by_voxels(voxel_size));
  for (int i = 0; i < 2 * views; ++i) {
    const double a = 2.0 * kPi * 0.618 * i, side = i % 2 == 0 ? 1.0 : -1.0;
    const Eigen::Vector3d to(0.5 * std::cos(a), 0.5 * std::sin(a), 0.85 * side);
    const Point3 eye = T_world_slab * Point3(3.2 * to);
    const Pose T = facing(eye, -(T_world_slab.linear() * to));
    integrate(render(sheet_camera(), T, body), sheet_camera(), T, map);
  }
  return map;
}
TsdfMap seen_slab(const Pose& T_world_slab, double thickness, int views, double voxel_size) {
  return seen_from_both_sides(slab(T_world_slab, thickness), T_world_slab, views, voxel_size);
}
/// The share of faces, a voxel or more from the rim, over which there is no mesh of their side.
double open_share(const TriangleMesh& mesh, const Pose& T_world_slab, double thickness,
                  double voxel_size, std::vector<double> sides = {1.0, -1.0}) {
  const double step = voxel_size / 5.0;
  int open = 0, all = 0;
  for (const double side : sides) {
    const Eigen::Vector3d n = side * T_world_slab.linear().col(2);
    const Bvh face(selected(mesh, [&](std::size_t t) { return mesh.area_vector(t).dot(n) > 0.0; }));
    // Off the lattice, so that no ray meets an edge of the mesh.
    for (double x = voxel_size - kHalf + 0.0031; x <= kHalf - voxel_size; x += step)
      for (double y = voxel_size - kHalf + 0.0047; y <= kHalf - voxel_size; y += step) {
        const Point3 p = T_world_slab * Point3(x, y, 0.5 * side * thickness);
        open += face.cast(p + voxel_size * n, -n, 2.0 * voxel_size) ? 0 : 1;
        ++all;
      }
  }
  return static_cast<double>(open) / all;
}
std::vector<Eigen::Vector3d> slants() {
  std::vector<Eigen::Vector3d> all;
  for (const double degrees : {0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 90.0})
    all.emplace_back(0.0, -std::sin(radians(degrees)), std::cos(radians(degrees)));
  all.push_back(Eigen::Vector3d::Ones().normalized());
  return all;
}
}  // namespace

TEST(sheets_end_at_their_rims) {
  for (const double h : {0.15, 0.3})
    for (const Eigen::Vector3d& n : slants()) {
      const Pose T = slab_frame(n, Point3(0.1, 0.2, 0.3) * h + 0.3 * h * n);
      const TriangleMesh mesh = extract_surface(seen_slab(T, 0.0, 12, h), {.min_weight = 0.3});
      CHECK_NEAR(mesh.area() / (8.0 * kHalf * kHalf), 1.0, 0.12);
      for (const Point3& v : mesh.vertices)
        CHECK((T.inverse() * v).head<2>().cwiseAbs().maxCoeff() < kHalf + 0.6 * h);
    }
}

TEST(sheets_are_whole_at_any_slant) {
  constexpr double h = 0.15;
  for (const Eigen::Vector3d& n : slants())
    for (const double thickness : {0.0, 0.05})
      for (const double offset : {0.1, 0.5}) {
        const Pose T = slab_frame(n, Point3(0.1, 0.2, 0.3) * h + offset * h * n);
        const TriangleMesh mesh =
            extract_surface(seen_slab(T, thickness, 12, h), {.min_weight = 0.3});
        CHECK(open_share(mesh, T, thickness, h) < 0.005);
        // Nothing stands off the faces, a voxel or more from their rims.
        for (const Point3& v : mesh.vertices) {
          const Point3 p = T.inverse() * v;
          if (p.head<2>().cwiseAbs().maxCoeff() > kHalf - h) continue;
          CHECK(std::abs(std::abs(p.z()) - 0.5 * thickness) < 0.5 * h);
        }
      }
}

TEST(slanted_faces_of_bodies_are_as_whole_as_others) {
  constexpr double h = 0.15;
  for (const Eigen::Vector3d& n : slants()) {
    // So few views that little is known deep behind the faces.
    const Pose T = slab_frame(n, Point3(0.02, 0.03, 0.04));
    const TriangleMesh mesh = extract_surface(seen_slab(T, 6.0 * h, 6, h), {.min_weight = 0.3});
    CHECK(open_share(mesh, T, 6.0 * h, h) < 0.005);
  }
}

TEST(faces_are_whole_where_a_body_becomes_thin) {
  for (const double h : {0.15, 0.3})
    for (const Eigen::Vector3d& n : slants()) {
      const Pose T = slab_frame(n, Point3(0.1, 0.2, 0.3) * h + 0.2 * h * n);
      const TriangleMesh mesh =
          extract_surface(seen_from_both_sides(wedge(T, 3.0 * h), T, 12, h), {.min_weight = 0.3});
      CHECK(open_share(mesh, T, 3.0 * h, h, {1.0}) < 0.005);
    }
}
