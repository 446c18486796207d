// SPDX-License-Identifier: MIT
// requires: inspection
// A contact sheet of the generated scenes: a row for every kind, a column for every seed.
//
//   random_scene_sheet --first-seed 1 --seeds 5 --out docs/random_scenes.png
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include "support/cli.hpp"

#include <surfleet/adapters/png_writer.hpp>
#include <surfleet/core/binary_io.hpp>
#include <surfleet/evaluation/rasterizer.hpp>
#include <surfleet/geometry/mesh_adjacency.hpp>
#include <surfleet/simulation/random_scene.hpp>

namespace {
using namespace surfleet;

/// Without the walls of rooms that stand before what is in them: back faces of parts as wide as
/// all.
TriangleMesh opened(const TriangleMesh& mesh, const Point3& eye) {
  const MeshComponents parts = connected_components(mesh);
  std::vector<Box3> boxes(parts.count);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      boxes[static_cast<std::size_t>(parts.of_triangle[t])].extend(mesh.corner(t, k));
  const Eigen::Vector3d all = mesh.bounds().sizes();
  TriangleMesh open = mesh;
  open.triangles.clear();
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Eigen::Vector3d own = boxes[static_cast<std::size_t>(parts.of_triangle[t])].sizes();
    const bool is_room = ((all - own).array() < 0.1).all();
    if (is_room && mesh.area_vector(t).dot(eye - mesh.centroid(t)) < 0.0) continue;
    open.triangles.push_back(mesh.triangles[t]);
  }
  return open;
}

Image picture_of(const RandomSceneId& id, int width, int height) {
  const Scene scene = random_scene(id);
  const TriangleMesh structure = scene.structure();
  const double elevation = scene.has_ground ? 20.0 : 48.0;
  const RenderView view =
      frame_points(structure.vertices, radians(-52.0), radians(elevation), width, height);
  Rasterizer picture(view, {.background_top = {244, 246, 249},
                            .background_bottom = {244, 246, 249},
                            .to_light = {0.2, -1.0, 1.1},
                            .supersampling = 3});
  picture.draw(scene.has_ground ? structure : opened(structure, view.eye));
  if (scene.has_ground) {  // a floor that shows where things stand
    const Box3 box = structure.bounds();
    const Point2 apron = Point2::Constant(1.0);
    picture.draw(make_plane(Box2(box.min().head<2>() - apron, box.max().head<2>() + apron), -0.02),
                 {.color = {214, 219, 208}});
  }
  return picture.image();
}

int run(int argc, char** argv) {
  cli::Options app("Renders random scenes as one picture: a row a kind, a column a seed.");
  std::string out = "random_scenes.png", kind = "all";
  int first = 1, seeds = 5, width = 230, height = 165;
  app.add("--out", out, "file to write");
  app.add("--kind", kind, "one kind alone, or all");
  app.add("--first-seed", first, "of the first column").within(0, 1000000);
  app.add("--seeds", seeds, "columns").within(1, 40);
  app.add("--width", width, "of a picture [px]").within(32, 2000);
  app.add("--height", height, "of a picture [px]").within(32, 2000);
  app.parse(argc, argv);
  std::vector<std::string_view> kinds;
  for (const RandomSceneSpec& spec : kRandomSceneKinds)
    if (kind == "all" || kind == spec.kind) kinds.push_back(spec.kind);
  if (kinds.empty()) random_scene_spec(kind);
  Image sheet(seeds * width, static_cast<int>(kinds.size()) * height);
  for (std::size_t row = 0; row < kinds.size(); ++row)
    for (int column = 0; column < seeds; ++column) {
      const auto seed = static_cast<std::uint64_t>(first + column);
      const Image cell = picture_of({kinds[row], seed}, width - 2, height - 2);
      for (int y = 0; y < cell.height; ++y)
        for (int x = 0; x < cell.width; ++x)
          sheet.set(column * width + x, static_cast<int>(row) * height + y, cell(x, y));
    }
  write_file(out, encode_png(sheet));
  std::printf("%s: %d x %d pixels\n", out.c_str(), sheet.width, sheet.height);
  return cli::kDone;
}
}  // namespace

int main(int argc, char** argv) {
  return surfleet::cli::run("random_scene_sheet", [&] { return run(argc, argv); });
}
