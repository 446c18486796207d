// SPDX-License-Identifier: MIT
#include <surfleet/evaluation/rasterizer.hpp>

#include <surfleet/geometry/bvh.hpp>

#include "check.hpp"
#include "test_shapes.hpp"

using namespace surfleet;

namespace {
RenderStyle plain() {
  RenderStyle s;
  s.background_top = s.background_bottom = {0, 0, 0};
  s.shadows = false;
  s.occlusion = 0.0;
  s.supersampling = 1;
  return s;
}
}  // namespace

TEST(silhouette_agrees_with_ray_casting) {
  const TriangleMesh mesh = test_shapes::sphere(1.0, 3);
  const Bvh bvh(mesh);
  for (const bool orthographic : {false, true}) {
    const RenderView view = frame_box(mesh.bounds(), 0.3, 0.4, 90, 60, orthographic);
    Rasterizer r(view, plain());
    r.draw(mesh, {.color = {255, 255, 255}, .light = 0.0});
    const Image image = r.image();
    const Eigen::Vector3d forward = (view.target - view.eye).normalized();
    const Eigen::Vector3d right = forward.cross(view.up).normalized(), down = forward.cross(right);
    int differ = 0, hits = 0;
    for (int y = 0; y < 60; ++y)
      for (int x = 0; x < 90; ++x) {
        const double scale = orthographic ? view.orthographic_height / 60
                                          : 2.0 * std::tan(0.5 * view.vertical_fov) / 60;
        const Eigen::Vector3d aside = scale * ((x - 44.5) * right + (y - 29.5) * down);
        const bool hit = orthographic ? bvh.cast(view.eye + aside, forward).has_value()
                                      : bvh.cast(view.eye, forward + aside).has_value();
        hits += hit ? 1 : 0;
        if (hit != (image(x, y)[0] == 255)) ++differ;
      }
    CHECK(hits > 1000 && differ <= 4);
  }
}

TEST(nearer_surfaces_hide_farther_ones_in_any_order) {
  const TriangleMesh near = test_shapes::plane(2.0, 1, 1.0), far = test_shapes::plane(4.0, 1, 0.0);
  const RenderView view = frame_box(far.bounds(), 0.0, radians(90), 40, 40);
  for (const bool swap : {false, true}) {
    Rasterizer r(view, plain());
    if (swap) r.draw(far, {.color = {0, 255, 0}, .light = 0.0});
    r.draw(near, {.color = {255, 0, 0}, .light = 0.0});
    if (!swap) r.draw(far, {.color = {0, 255, 0}, .light = 0.0});
    const Image image = r.image();
    CHECK(image(20, 20) == (Rgb{255, 0, 0}) && image(4, 20) == (Rgb{0, 255, 0}));
  }
}

TEST(lines_and_points_respect_depth) {
  const TriangleMesh wall = test_shapes::plane(4.0, 1, 0.0);
  const RenderView view = frame_box(wall.bounds(), 0.0, radians(90), 60, 60);
  Rasterizer r(view, plain());
  r.draw(wall, {.color = {255, 255, 255}, .light = 0.0});
  r.draw_polyline(std::vector<Point3>{{-0.8, -1, 0.5}, {-0.8, 1, 0.5}}, {255, 0, 0}, 4);
  r.draw_polyline(std::vector<Point3>{{0.8, -1, -0.5}, {0.8, 1, -0.5}}, {255, 0, 0}, 4);
  r.draw_points(std::vector<Point3>{{0, 0, 0.0}}, {0, 0, 255}, 6);
  const Image image = r.image();
  int red = 0, pink = 0, blue = 0;
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 60; ++x) {
      const Rgb c = image(x, y);
      if (c == Rgb{255, 0, 0}) ++red;
      if (c[0] == 255 && c[1] == c[2] && c[1] > 100 && c[1] < 255) ++pink;
      if (c == Rgb{0, 0, 255}) ++blue;
    }
  CHECK(red > 40 && pink > 40 && blue > 15);
}

TEST(a_shadow_falls_beside_a_block) {
  TriangleMesh scene = test_shapes::plane(10.0, 1, 0.0);
  append(scene, test_shapes::box({-0.5, -0.5, 0}, {0.5, 0.5, 2}));
  RenderStyle style = plain();
  style.shadows = true;
  style.to_light = {1, 0, 1};
  Rasterizer r(frame_box(scene.bounds(), 0.0, radians(90), 101, 101, true), style);
  r.draw(scene);
  const Image image = r.image();
  // The image's up is world −x when seen from above at azimuth 0.
  int dark = 0;
  for (int y = 0; y < 101; ++y)
    for (int x = 0; x < 101; ++x)
      if (image(x, y)[0] > 0 && image(x, y)[0] < image(8, 8)[0] - 30) ++dark;
  CHECK(image(8, 8)[0] > 100 && dark > 100 && dark < 1500);
}

TEST(views_hold_the_whole_box) {
  const Box3 box(Point3(-30, 5, 0), Point3(35, 47, 15));
  const TriangleMesh mesh = test_shapes::box(box.min(), box.max());
  for (const bool orthographic : {false, true})
    for (double azimuth = 0.0; azimuth < 6.0; azimuth += 0.7)
      for (const double elevation : {-0.5, 0.0, 0.6, 0.5 * kPi}) {
        Rasterizer r(frame_box(box, azimuth, elevation, 80, 50, orthographic), plain());
        r.draw(mesh, {.color = {255, 255, 255}, .light = 0.0});
        const Image image = r.image();
        int border = 0, inside = 0;
        for (int y = 0; y < 50; ++y)
          for (int x = 0; x < 80; ++x) {
            if (image(x, y)[0] == 0) continue;
            ++inside;
            if (x == 0 || y == 0 || x == 79 || y == 49) ++border;
          }
        CHECK(border == 0 && inside > 300);
      }
}

TEST(nasty_scenes_are_drawn) {
  TriangleMesh mesh = test_shapes::sphere(1.0, 1);
  mesh.triangles.push_back({0, 0, 1});
  RenderView view;
  view.width = view.height = 20;
  view.eye = {0.2, 0.1, 0.0};  // inside: triangles cross the near plane
  view.target = {0.2, 0.1, 1.0};
  Rasterizer r(view);
  r.draw(mesh);
  r.draw({});
  r.draw_polyline(std::vector<Point3>{{0, 0, -5}, {0, 0, 5}, {0, 0, 5}}, {255, 0, 0});
  r.draw_points({}, {1, 2, 3});
  CHECK(r.image().rgb.size() == 1200);
  view.target = view.eye;
  CHECK(Rasterizer(view).image().width == 20);
  CHECK(Rasterizer(frame_box({}, 0, 0, 8, 8)).image().width == 8);
  view.width = 0;
  CHECK_THROWS(Error, Rasterizer(view));
}
