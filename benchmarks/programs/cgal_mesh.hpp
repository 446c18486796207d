// SPDX-License-Identifier: MIT
/// @file
/// @brief Our meshes as CGAL's, for what is compared with it.
#pragma once

#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>

#include <cstdint>

#include <surfleet/geometry/triangle_mesh.hpp>

namespace surfleet::benchmarks {
using CgalKernel = CGAL::Simple_cartesian<double>;
using CgalMesh = CGAL::Surface_mesh<CgalKernel::Point_3>;

/// With vertices and faces in our order.
inline CgalMesh cgal_mesh(const TriangleMesh& mesh) {
  CgalMesh out;
  for (const Point3& p : mesh.vertices) out.add_vertex({p.x(), p.y(), p.z()});
  const auto id = [](std::int32_t v) { return CgalMesh::Vertex_index(static_cast<unsigned>(v)); };
  for (const Triangle& t : mesh.triangles) out.add_face(id(t[0]), id(t[1]), id(t[2]));
  return out;
}
}  // namespace surfleet::benchmarks
