// SPDX-License-Identifier: MIT
/// @file
/// @brief Pictures of the plane as SVG: ground, regions, paths and robots.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <span>
#include <string>
#include <vector>

#include <surfleet/coverage/coverage_grid.hpp>
#include <surfleet/evaluation/plot.hpp>
#include <surfleet/geometry/polygon.hpp>

namespace surfleet::cli {
class PlanarPicture {
 public:
  explicit PlanarPicture(const Polygon& domain) : domain_(domain), box_(domain.bounds()) {
    const Point2 size = box_.sizes();
    scale_ = 900.0 / std::max(size.x(), 1.3 * size.y());
    body_ += "<path d=\"" + outline(domain) + "\" fill=\"#f4f4f2\" fill-rule=\"evenodd\"/>\n";
  }
  void add_region(const Region& region, Rgb color, double opacity = 0.35) {
    for (const Polygon& part : region)
      body_ += "<path d=\"" + outline(part) + "\" fill=\"" + name(color) + "\" fill-opacity=\"" +
               number(opacity) + "\" fill-rule=\"evenodd\" stroke=\"" + name(color) + "\"/>\n";
  }
  /// Cells of a grid in the colour of their owner; −1 is left out.
  void add_cells(const CoverageGrid& grid, std::span<const std::int32_t> owner) {
    const auto columns = static_cast<std::size_t>(grid.columns());
    for (std::size_t c = 0; c < grid.cells();) {
      std::size_t end = c + 1;
      while (end < grid.cells() && end % columns != 0 && owner[end] == owner[c]) ++end;
      if (owner[c] >= 0) {
        const Point2 a = at(grid.centre(c)), b = at(grid.centre(end - 1));
        const double side = grid.cell_size() * scale_;
        body_ += "<rect x=\"" + number(a.x() - side / 2) + "\" y=\"" + number(a.y() - side / 2) +
                 "\" width=\"" + number(b.x() - a.x() + side) + "\" height=\"" + number(side) +
                 "\" fill=\"" + name(categorical_color(static_cast<std::size_t>(owner[c]))) +
                 "\" fill-opacity=\"0.35\"/>\n";
      }
      c = end;
    }
  }
  void add_path(std::span<const Point2> points, Rgb color, double width = 1.5) {
    if (points.size() < 2) return;
    std::string d;
    for (const Point2& p : points) d += coordinates(p) + " ";
    body_ += "<polyline points=\"" + d + "\" fill=\"none\" stroke=\"" + name(color) +
             "\" stroke-width=\"" + number(width) + "\" stroke-linejoin=\"round\"/>\n";
  }
  void add_robot(const Point2& p, Rgb color) {
    body_ +=
        circle(p, 6.0) + " fill=\"" + name(color) + "\" stroke=\"white\" stroke-width=\"1.5\"/>\n";
  }
  void add_start(const Point2& p, Rgb color) {
    body_ +=
        circle(p, 4.0) + " fill=\"white\" stroke=\"" + name(color) + "\" stroke-width=\"1.5\"/>\n";
  }
  void add_cross(const Point2& p, Rgb color) {
    const Point2 q = at(p);
    body_ += "<path d=\"M" + number(q.x() - 5) + " " + number(q.y() - 5) +
             "l10 10m0 -10l-10 10\" stroke=\"" + name(color) + "\" stroke-width=\"2\"/>\n";
  }
  void add_label(const Point2& p, const std::string& text) {
    const Point2 q = at(p);
    body_ += "<text x=\"" + number(q.x() + 8) + "\" y=\"" + number(q.y() - 6) +
             "\" font-size=\"13\" fill=\"#222\">" + escape_markup(text) + "</text>\n";
  }
  std::string svg() const {
    const Point2 size = scale_ * box_.sizes();
    return "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"-8 -8 " + number(size.x() + 16) +
           " " + number(size.y() + 16) + "\" width=\"100%\" font-family=\"sans-serif\">\n" + body_ +
           "<path d=\"" + outline(domain_) +
           "\" fill=\"none\" stroke=\"#555\" stroke-width=\"2\"/>\n</svg>\n";
  }

 private:
  static std::string number(double v) {
    char text[32];
    std::snprintf(text, sizeof text, "%.2f", v);
    return text;
  }
  static std::string name(Rgb c) {
    char text[16];
    std::snprintf(text, sizeof text, "#%02x%02x%02x", c[0], c[1], c[2]);
    return text;
  }
  Point2 at(const Point2& p) const {
    return {scale_ * (p.x() - box_.min().x()), scale_ * (box_.max().y() - p.y())};
  }
  std::string coordinates(const Point2& p) const {
    const Point2 q = at(p);
    return number(q.x()) + "," + number(q.y());
  }
  std::string circle(const Point2& p, double radius) const {
    const Point2 q = at(p);
    return "<circle cx=\"" + number(q.x()) + "\" cy=\"" + number(q.y()) + "\" r=\"" +
           number(radius) + "\"";
  }
  std::string outline(const Polygon& polygon) const {
    std::string d;
    for (std::size_t r = 0; r < polygon.rings(); ++r) {
      d += "M";
      for (const Point2& p : polygon.ring(r)) d += coordinates(p) + " ";
      d += "Z";
    }
    return d;
  }
  Polygon domain_;
  Box2 box_;
  double scale_;
  std::string body_;
};
}  // namespace surfleet::cli
