// SPDX-License-Identifier: MIT
/// @file
/// @brief A short tour of the stops that pay best, in place of the one that pays best.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include <surfleet/allocation/cheapest_insertion.hpp>
#include <surfleet/allocation/hamiltonian_path.hpp>
#include <surfleet/allocation/lin_kernighan.hpp>
#include <surfleet/core/rotation.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/viewpoint/sight_targets.hpp>

namespace surfleet {
/// What a place would show at each heading.
using WorthByHeading = std::array<double, kHeadings>;

/// What looks from places would show, as stops are taken one after the other.
///
/// `look(s, enough, worth)` is no less than the worth of the best look from site s; if it is above
/// `enough` it is that, and `worth` is by heading, so what is clearly too little need not be looked
/// at. It never grows. `take(s, heading)` says that what is seen there counts no more.
template <typename L>
concept LooksFromSites = requires(L& looks, std::size_t s, double enough, WorthByHeading& worth,
                                  int heading) {
  { looks.look(s, enough, worth) } -> std::convertible_to<double>;
  looks.take(s, heading);
};

struct TourAheadOptions {
  int stops = 10;          ///< At the most.
  double stop_cost = 1.0;  ///< What a stop costs beside its detour; more than 0 [m].
  double turn_cost = 0.1;  ///< What turning costs [m/rad].
};
/// Where a stop could be.
struct TourSite {
  Point3 position = Point3::Zero();
  double distance = 0.0;  ///< From the robot, along its way there [m].
};
struct TourAheadStop {
  std::size_t site = 0;
  int heading = 0;
  double rate = 0.0;  ///< Its worth over what it cost when it was inserted.
};

/// Stops for one robot in the order of the visit: those of the most worth per metre inserted, one
/// after the other wherever they cost least, the whole then put in the shortest order. What pays
/// best alone may be the end of it, and what lies on the way is not left to be come back for.
///
/// Ways between stops are taken as straight. O(stops · sites), and the views that `looks` has to
/// take.
template <LooksFromSites Looks>
std::vector<TourAheadStop> tour_ahead(const Configuration& from, std::span<const TourSite> sites,
                                      Looks& looks, const TourAheadOptions& options = {}) {
  std::vector<TourAheadStop> stops;
  const auto position = [&](std::size_t k) -> const Point3& {
    return k == 0 ? from.position : sites[stops[k - 1].site].position;
  };
  const auto yaw = [&](std::size_t k) {
    return k == 0 ? from.yaw : heading_angle(stops[k - 1].heading);
  };
  const auto distance = [&](std::size_t k, std::size_t s) {
    return k == 0 ? sites[s].distance : (position(k) - sites[s].position).norm();
  };
  const auto turn = [&](double a, double b) {
    return options.turn_cost * std::abs(wrap_angle(a - b));
  };
  const auto turn_at = [&](std::size_t k, double a) {
    const double before = turn(yaw(k), a);
    return k == stops.size() ? before : before + turn(a, yaw(k + 1)) - turn(yaw(k), yaw(k + 1));
  };
  std::vector<double> most(sites.size(), std::numeric_limits<double>::infinity());
  std::vector<double> legs;
  CheapestInsertion insertion(sites.size(), legs, distance);
  while (stops.size() < static_cast<std::size_t>(std::max(options.stops, 0))) {
    TourAheadStop best;
    WorthByHeading worth;
    for (std::size_t s = 0; s < sites.size(); ++s) {
      const auto [extra, leg] = insertion[s];
      const double cost = std::max(extra, 0.0) + options.stop_cost;
      // Turning may come for less than nothing, but never for so much less.
      const double least = std::max(cost - 2.0 * kPi * options.turn_cost, 0.5 * options.stop_cost);
      if (most[s] <= best.rate * least) continue;
      most[s] = looks.look(s, best.rate * least, worth);
      if (most[s] <= best.rate * least) continue;
      for (std::size_t k = 0; k < kHeadings; ++k) {
        const int heading = static_cast<int>(k);
        if (worth[k] <= best.rate * least) continue;
        const double metres = std::max(cost + turn_at(leg, heading_angle(heading)), least);
        if (worth[k] > best.rate * metres) best = {s, heading, worth[k] / metres};
      }
    }
    if (best.rate <= 0.0) break;
    const std::size_t leg = insertion[best.site].leg;
    const auto at = static_cast<std::ptrdiff_t>(leg);
    stops.insert(stops.begin() + at, best);
    looks.take(best.site, best.heading);
    legs.insert(legs.begin() + at, distance(leg, best.site));
    if (leg + 1 < stops.size()) legs[leg + 1] = distance(leg + 1, stops[leg + 1].site);
    insertion.inserted(leg, legs, distance);
  }
  const auto length = [&](int i, int j) {
    const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j);
    return distance(b, stops[a - 1].site) + turn(yaw(a), yaw(b));
  };
  std::vector<TourAheadStop> ordered;
  for (const int i :
       shortest_hamiltonian_path(static_cast<int>(stops.size()) + 1, length, LinKernighan{}).order)
    if (i > 0) ordered.push_back(stops[static_cast<std::size_t>(i) - 1]);
  return ordered;
}
}  // namespace surfleet
