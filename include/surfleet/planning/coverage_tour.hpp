// SPDX-License-Identifier: MIT
/// @file
/// @brief The coverage tour of a known mesh: a short flight from which a camera sees its surface.
///
///     KnownSurface surface{samples, normals, areas};
///     const CoverageTour tour = plan_coverage_tour(surface, caster, free_space, roadmap, camera,
///                                                  start, {.coverage = 0.95});
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/allocation/cheapest_insertion.hpp>
#include <surfleet/allocation/hamiltonian_path.hpp>
#include <surfleet/allocation/lin_kernighan.hpp>
#include <surfleet/core/error.hpp>
#include <surfleet/geometry/ray_caster.hpp>
#include <surfleet/motion/flight_lattice.hpp>
#include <surfleet/motion/lazy_prm.hpp>
#include <surfleet/motion/roadmap_passages.hpp>
#include <surfleet/viewpoint/sight_targets.hpp>

namespace surfleet {
/// Samples of a surface; three arrays of one length. A sheet that is to be seen from both sides is
/// there twice.
struct KnownSurface {
  std::span<const Point3> points;            ///< [m]
  std::span<const Eigen::Vector3d> normals;  ///< Unit, towards where it is seen from.
  std::span<const double> areas;             ///< What each stands for [m²].
};

struct CoverageTourOptions {
  double coverage = 0.95;      ///< Share to be seen of what can be seen.
  double spacing = 1.5;        ///< Of the lattice of candidate positions [m].
  double stop_cost = 1.0;      ///< Added to a viewpoint's insertion, so that few are taken [m].
  double max_incidence = 1.4;  ///< Greatest angle between the normal and the line of sight [rad].
  /// Greatest depth that counts [m]; nothing: the range of the camera.
  std::optional<double> max_range{};
  double image_spacing = 1.0;  ///< Between the images en route [m].
  int rounds = 3;              ///< Of dropping, re-inserting and re-ordering.
};

struct CoverageTour {
  std::vector<Configuration> viewpoints;  ///< In the order of the visit, without the start.
  std::vector<Point3> path;               ///< The whole flight, the start first.
  /// The images that count, in the order of the flight: at the viewpoints, and en route to each
  /// with its heading.
  std::vector<Configuration> images;
  double length = 0.0;          ///< Of `path` [m].
  double seen_area = 0.0;       ///< [m²]
  double reachable_area = 0.0;  ///< What the candidates together can see [m²].
  /// By lines of sight, as the plan was made; what the images of the flight cover is for
  /// `oriented_coverage` to say.
  double coverage() const { return reachable_area > 0.0 ? seen_area / reachable_area : 1.0; }
};

/// How a tour is flown to take images: at constant speed, turning en route to each viewpoint and
/// there until its heading and pitch are reached.
struct TourFlightOptions {
  double speed = 0.6;          ///< [m/s]
  double yaw_rate = 0.8;       ///< [rad/s]
  double pitch_rate = 1.0;     ///< Of a gimbal [rad/s].
  double image_period = 0.25;  ///< Longest time between two images [s].
  double hold = 0.0;           ///< Time spent at every viewpoint, facing its heading [s].
};

/// Where images are taken on a tour: a body's pose and its time in seconds for each. The first is
/// at `start` at time 0; there is one at every corner of the path, so that straight lines between
/// images are the path, and one at every viewpoint with its heading. O(images).
inline std::vector<std::pair<double, Configuration>> fly_tour(
    const CoverageTour& tour, const Configuration& start, const TourFlightOptions& options = {}) {
  require(options.speed > 0.0 && options.yaw_rate > 0.0 && options.pitch_rate > 0.0 &&
              options.image_period > 0.0 && options.hold >= 0.0,
          "tour flight: expected a speed, rates and a period above 0 and a hold of 0 or more");
  std::vector<std::pair<double, Configuration>> images{{0.0, start}};
  // An image `dt` later at `p`, turned towards `view`.
  const auto image = [&](const Point3& p, const Configuration& view, double dt) {
    const auto [time, last] = images.back();
    const double most = options.yaw_rate * dt, most_tilt = options.pitch_rate * dt;
    const double turn = std::clamp(wrap_angle(view.yaw - last.yaw), -most, most);
    const double tilt = std::clamp(view.pitch - last.pitch, -most_tilt, most_tilt);
    images.push_back({time + dt, {p, wrap_angle(last.yaw + turn), last.pitch + tilt}});
  };
  std::size_t stop = 0;
  // At a viewpoint: an image of each that has this place.
  const auto observe_at = [&](const Point3& at) {
    for (; stop < tour.viewpoints.size() && tour.viewpoints[stop].position == at; ++stop) {
      const Configuration& view = tour.viewpoints[stop];
      while (std::abs(wrap_angle(images.back().second.yaw - view.yaw)) > 1e-9 ||
             std::abs(images.back().second.pitch - view.pitch) > 1e-9)
        image(at, view, options.image_period);
      for (double held = 0.0; held < options.hold; held += options.image_period)
        image(at, view, options.image_period);
    }
  };
  if (!tour.path.empty()) observe_at(tour.path.front());
  for (std::size_t k = 1; k < tour.path.size() && stop < tour.viewpoints.size(); ++k) {
    const Point3 &a = tour.path[k - 1], &b = tour.path[k];
    const double time = (b - a).norm() / options.speed;
    const double steps = std::ceil(time / options.image_period);
    for (double i = 1.0; i <= steps; ++i)
      image(i < steps ? Point3(a + (b - a) * (i / steps)) : b, tour.viewpoints[stop], time / steps);
    observe_at(b);
  }
  return images;
}

namespace detail {
/// Plans a coverage tour; see `plan_coverage_tour`.
template <RayCaster Caster>
class CoverageTourPlanner {
 public:
  CoverageTourPlanner(const KnownSurface& surface, const Caster& caster, const FreeSpace& space,
                      const LazyPrmStar& roadmap, const PinholeCamera& camera,
                      const Pose& T_body_camera, const std::vector<double>& pitches,
                      const Configuration& start, const CoverageTourOptions& options)
      : surface_(surface),
        space_(space),
        roadmap_(roadmap),
        start_(start),
        options_(options),
        range_(std::min(options.max_range.value_or(camera.max_range), camera.max_range)),
        headings_(camera, T_body_camera, pitches),
        targets_(targets_of(surface), MeshSight<Caster>(caster), headings_,
                 {.max_range = range_, .max_incidence = options.max_incidence, .by_depth = true}) {}

  CoverageTour plan() {
    find_candidates();
    CoverageTour tour;
    for (std::size_t i = 0; i < surface_.points.size(); ++i)
      if (reachable_[i] != 0) tour.reachable_area += surface_.areas[i];
    goal_ = options_.coverage * tour.reachable_area;
    grow();
    for (int round = 0; round < options_.rounds; ++round) {
      improve_order();
      view_en_route();
      drop_useless();
      grow();
    }
    improve_order();
    // What was seen en route to a stop that is gone, or in another order, does not count.
    for (int round = 0; round < options_.rounds; ++round) {
      view_en_route();
      grow();
    }
    view_en_route();
    fly(tour);
    return tour;
  }

 private:
  struct Candidate {
    std::size_t site = 0;
    int view = 0;
    std::vector<std::int32_t> seen;
  };

  static std::vector<SightTarget> targets_of(const KnownSurface& surface) {
    std::vector<SightTarget> targets;
    for (std::size_t i = 0; i < surface.points.size(); ++i)
      targets.push_back({surface.points[i], surface.normals[i], surface.areas[i], 0});
    return targets;
  }

  void find_candidates() {
    reachable_.assign(surface_.points.size(), 0);
    sites_ = {start_.position};
    FlightLattice<FreeSpace> lattice(space_, space_.options().bounds, options_.spacing);
    const ReachFrom reach = roadmap_.reach_from(start_.position);
    const auto visit = [&](const auto& site) {
      if (!reach(site.position)) return true;
      const std::vector<Sighting> seen = targets_.seen_from(site.position);
      for (const Sighting& s : seen) reachable_[static_cast<std::size_t>(s.target)] = 1;
      for (int k = 0; k < headings_.views() && !seen.empty(); ++k) {
        Candidate c{sites_.size(), k, {}};
        for (const Sighting& s : seen)
          if (has_view(s.views, k)) c.seen.push_back(s.target);
        if (!c.seen.empty()) candidates_.push_back(std::move(c));
      }
      sites_.push_back(site.position);
      return true;
    };
    lattice.search(start_.position, visit, RoadmapPassages(roadmap_, reach));
  }

  /// Samples seen from the stops and en route, as counts; the total area seen.
  double count_seen() {
    count_.assign(surface_.points.size(), 0);
    for (const std::size_t s : stops_)
      for (const std::int32_t i : candidates_[s].seen) ++count_[static_cast<std::size_t>(i)];
    double area = 0.0;
    for (std::size_t i = 0; i < count_.size(); ++i)
      if (count_[i] > 0 || en_route_[i] != 0) area += surface_.areas[i];
    return area;
  }

  /// Sites are numbered places: the start is 0, and so is the 0th place of the tour.
  std::size_t site(std::size_t k) const { return k == 0 ? 0 : candidates_[stops_[k - 1]].site; }
  const Point3& place(std::size_t k) const { return sites_[site(k)]; }
  /// Between two sites; the roadmap is asked once for each pair.
  double distance(std::size_t a, std::size_t b) {
    if (a == b) return 0.0;
    const auto [it, fresh] = lengths_.try_emplace(std::minmax(a, b), 0.0);
    if (fresh) {
      const auto path = roadmap_.query(sites_[it->first.first], sites_[it->first.second]);
      it->second = path ? path->length : kNoPath;
    }
    return it->second;
  }

  /// Adds the viewpoint of most new area per inserted metre until the goal is met.
  ///
  /// Lazy greedy: gains only shrink, so an old gain over the least straight detour bounds a
  /// candidate's rate, and only those that could be the best are counted anew and their paths
  /// queried.
  void grow() {
    if (en_route_.empty()) en_route_.assign(surface_.points.size(), 0);
    double seen = count_seen();
    std::vector<double> legs;
    for (std::size_t k = 0; k < stops_.size(); ++k) legs.push_back(distance(site(k), site(k + 1)));
    std::vector<double> gain(candidates_.size(), std::numeric_limits<double>::infinity());
    const auto straight = [&](std::size_t k, std::size_t c) {
      return (sites_[candidates_[c].site] - place(k)).norm();
    };
    CheapestInsertion detour(candidates_.size(), legs, straight);
    while (seen < goal_) {
      double best_rate = 0.0;
      std::size_t best = candidates_.size();
      for (std::size_t c = 0; c < candidates_.size(); ++c) {
        const double least = std::max(detour[c].extra, 0.0) + options_.stop_cost;
        if (gain[c] <= best_rate * least) continue;
        gain[c] = gain_of(c);
        if (gain[c] <= best_rate * least) continue;
        const std::size_t k = detour[c].leg;
        double extra = distance(site(k), candidates_[c].site);
        if (k < stops_.size()) extra += distance(candidates_[c].site, site(k + 1)) - legs[k];
        const double rate = gain[c] / (std::max(extra, 0.0) + options_.stop_cost);
        if (rate > best_rate) {
          best_rate = rate;
          best = c;
        }
      }
      if (best == candidates_.size()) return;
      const std::size_t k = detour[best].leg;
      const bool at_end = k == stops_.size();
      stops_.insert(stops_.begin() + static_cast<std::ptrdiff_t>(k), best);
      for (const std::int32_t i : candidates_[best].seen) ++count_[static_cast<std::size_t>(i)];
      seen += gain[best];
      legs.insert(legs.begin() + static_cast<std::ptrdiff_t>(k), distance(site(k), site(k + 1)));
      if (!at_end) legs[k + 1] = distance(site(k + 1), site(k + 2));
      detour.inserted(k, legs, straight);
    }
  }
  double gain_of(std::size_t candidate) const {
    double gain = 0.0;
    for (const std::int32_t i : candidates_[candidate].seen) {
      const auto s = static_cast<std::size_t>(i);
      if (count_[s] == 0 && en_route_[s] == 0) gain += surface_.areas[s];
    }
    return gain;
  }

  /// The shortest open path from the start that the tour solver finds, by roadmap lengths among
  /// near neighbours.
  void improve_order() {
    const std::size_t n = stops_.size() + 1;
    if (n < 4) return;
    CostMatrix lengths(static_cast<int>(n));
    const auto set = [&](std::size_t i, std::size_t j, double length) {
      const int a = static_cast<int>(i), b = static_cast<int>(j);
      lengths(a, b) = lengths(b, a) = length;
    };
    std::vector<std::pair<double, std::size_t>> near;
    for (std::size_t i = 0; i < n; ++i)  // far pairs never become neighbours of a good tour
      for (std::size_t j = 0; j < i; ++j) set(i, j, kWinding * (place(i) - place(j)).norm());
    for (std::size_t i = 0; i < n; ++i) {
      near.clear();
      for (std::size_t j = 0; j < n; ++j)
        if (j != i) near.emplace_back((place(i) - place(j)).squaredNorm(), j);
      const std::size_t asked = std::min(kNeighbors, near.size());
      std::nth_element(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(asked - 1),
                       near.end());
      for (std::size_t k = 0; k < asked; ++k)
        set(i, near[k].second, distance(site(i), site(near[k].second)));
    }
    for (std::size_t k = 0; k + 1 < n; ++k) set(k, k + 1, distance(site(k), site(k + 1)));
    std::vector<std::size_t> next;
    for (const int i : shortest_hamiltonian_path(lengths, 0, LinKernighan{}).order)
      if (i > 0) next.push_back(stops_[static_cast<std::size_t>(i) - 1]);
    stops_ = std::move(next);
  }

  /// Images taken en route, facing as at the next viewpoint, as by a drone that turns in flight.
  void view_en_route() {
    en_route_.assign(surface_.points.size(), 0);
    for (std::size_t k = 0; k < stops_.size(); ++k) {
      const auto path = roadmap_.query(place(k), place(k + 1));
      if (!path) continue;
      const int view = candidates_[stops_[k]].view;
      for_each_view_along(*path, [&](const Point3& p) {
        for (const Sighting& seen : targets_.seen_from(p))
          if (has_view(seen.views, view)) en_route_[static_cast<std::size_t>(seen.target)] = 1;
      });
    }
  }
  /// Calls `take` with the positions along a path where an image is taken.
  template <typename Take>
  void for_each_view_along(const Path& path, Take&& take) const {
    double until = options_.image_spacing;
    for (std::size_t s = 1; s < path.points.size(); ++s) {
      const Point3 a = path.points[s - 1], b = path.points[s];
      const double length = (b - a).norm();
      for (; until < length; until += options_.image_spacing) take(a + (b - a) * (until / length));
      until -= length;
    }
  }

  /// Drops viewpoints that see nothing of their own, the dearest first.
  void drop_useless() {
    double seen = count_seen();
    for (bool dropped = true; dropped && !stops_.empty();) {
      dropped = false;
      std::size_t best = 0;
      double best_rate = std::numeric_limits<double>::infinity(), best_loss = 0.0;
      for (std::size_t k = 0; k < stops_.size(); ++k) {
        double loss = 0.0;
        for (const std::int32_t i : candidates_[stops_[k]].seen) {
          const auto s = static_cast<std::size_t>(i);
          if (count_[s] == 1 && en_route_[s] == 0) loss += surface_.areas[s];
        }
        double saved = (place(k + 1) - place(k)).norm();
        if (k + 1 < stops_.size())
          saved += (place(k + 2) - place(k + 1)).norm() - (place(k + 2) - place(k)).norm();
        const double rate = loss / (std::max(saved, 0.0) + options_.stop_cost);
        if (rate < best_rate && seen - loss >= goal_) {
          best_rate = rate;
          best_loss = loss;
          best = k;
          dropped = true;
        }
      }
      if (!dropped) break;
      for (const std::int32_t i : candidates_[stops_[best]].seen)
        --count_[static_cast<std::size_t>(i)];
      seen -= best_loss;
      stops_.erase(stops_.begin() + static_cast<std::ptrdiff_t>(best));
    }
  }

  void fly(CoverageTour& tour) {
    tour.path.push_back(start_.position);
    for (std::size_t k = 0; k < stops_.size(); ++k) {
      const Configuration stop = headings_.at(place(k + 1), candidates_[stops_[k]].view);
      if (const auto path = roadmap_.query(place(k), place(k + 1))) {
        tour.path.insert(tour.path.end(), path->points.begin() + 1, path->points.end());
        for_each_view_along(*path, [&](const Point3& p) {
          tour.images.push_back({p, stop.yaw, stop.pitch});
        });
      }
      tour.viewpoints.push_back(stop);
      tour.images.push_back(stop);
    }
    tour.length = polyline_length(tour.path);
    tour.seen_area = count_seen();
  }

  static constexpr std::size_t kNeighbors = 24;  ///< Of a stop, whose paths are queried.
  static constexpr double kWinding = 1.3;        ///< A path over its straight line, elsewhere.
  static constexpr double kNoPath = 1e6;         ///< [m]

  const KnownSurface& surface_;
  const FreeSpace& space_;
  const LazyPrmStar& roadmap_;
  Configuration start_;
  CoverageTourOptions options_;
  double range_, goal_ = 0.0;
  HeadingTable headings_;
  SightTargets<MeshSight<Caster>> targets_;
  std::vector<Point3> sites_;
  std::map<std::pair<std::size_t, std::size_t>, double> lengths_;
  std::vector<Candidate> candidates_;
  std::vector<std::size_t> stops_;
  std::vector<int> count_;
  std::vector<char> en_route_, reachable_;
};
}  // namespace detail

/// Chooses viewpoints by new area per metre inserted into the tour, improves the order by
/// Lin-Kernighan over roadmap lengths, counts what is seen en route, drops what became useless,
/// and fills up again. Candidates are the nodes of a lattice that can be reached from the start,
/// with sixteen headings each, and a gimbal's `pitches` (see `HeadingTable`). It is what an
/// engineer with a model of the structure would fly, and the yardstick for planners that have none.
///
/// O(candidates · samples in view) for the sightings and O(stops · candidates) for the choice.
template <RayCaster Caster>
CoverageTour plan_coverage_tour(const KnownSurface& surface, const Caster& caster,
                                const FreeSpace& space, const LazyPrmStar& roadmap,
                                const PinholeCamera& camera, const Configuration& start,
                                const CoverageTourOptions& options = {},
                                const Pose& T_body_camera = forward_camera_mount(),
                                const std::vector<double>& pitches = {0.0}) {
  require(surface.points.size() == surface.normals.size() &&
              surface.points.size() == surface.areas.size(),
          "known surface: expected points, normals and areas of one length");
  require(options.coverage > 0.0 && options.coverage <= 1.0 && options.spacing > 0.0 &&
              options.image_spacing > 0.0 && options.stop_cost > 0.0,
          "coverage tour: expected a share in (0, 1] and lengths above 0");
  return detail::CoverageTourPlanner<Caster>(surface, caster, space, roadmap, camera, T_body_camera,
                                             pitches, start, options)
      .plan();
}
}  // namespace surfleet
