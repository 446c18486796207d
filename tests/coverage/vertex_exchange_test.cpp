// SPDX-License-Identifier: MIT
#include <surfleet/coverage/vertex_exchange.hpp>

#include <surfleet/geometry/mesh_primitives.hpp>
#include <surfleet/simulation/surfaces.hpp>

#include "check.hpp"
#include "deployment_laws.hpp"

namespace {
using namespace surfleet;

TEST(a_hole_and_a_short_radio) {
  const TriangleMesh slope = bumpy_slope({.edge = 0.05, .hole = true});
  SurfaceCoverageOptions options;
  options.sensing_range = 0.5;
  options.communication_range = 0.6;
  run<MeshGraph, EdgeGeodesic, VertexExchange>(slope, 6, options);
}

TEST(fields_shape_the_regions) {
  const TriangleMesh torus = make_torus(Point3::Zero(), 1.0, 0.4, 40, 20);
  SurfaceCoverageOptions options;
  options.field = CurvatureField{}(torus);
  run<MeshGraph, EdgeGeodesic, VertexExchange>(torus, 6, options);
  options.field = DirectionalField{Eigen::Vector3d::UnitZ(), 3.0}(torus);
  run<MeshGraph, EdgeGeodesic, VertexExchange>(torus, 6, options);
  run<DualMeshGraph, EdgeGeodesic, VertexExchange>(torus, 6, options);
  run<MeshGraph, FaceGeodesic, WavefrontPropagation>(torus, 6, options);
  options.field = PrincipalDirectionField{}(torus);
  options.field.norm = 3.0;
  options.exponent = 3.0;
  run<MeshGraph, EdgeGeodesic, WavefrontPropagation>(torus, 4, options);
}
}  // namespace
