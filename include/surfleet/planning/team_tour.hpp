// SPDX-License-Identifier: MIT
/// @file
/// @brief Orienteering tours of a team, by gain per metre inserted.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/allocation/cheapest_insertion.hpp>
#include <surfleet/allocation/hamiltonian_path.hpp>
#include <surfleet/allocation/lin_kernighan.hpp>
#include <surfleet/core/parallel.hpp>
#include <surfleet/core/rotation.hpp>
#include <surfleet/core/types.hpp>
#include <surfleet/viewpoint/sight_targets.hpp>

namespace surfleet {
/// What views from sites would show, as stops are taken one after the other.
///
/// `evaluate(s, enough, gain)` is no less than the gain of the best view from site s; if it is
/// above `enough` it is that, and `gain` is by view [m²] wherever it is above, so what is clearly
/// too little need not be examined. It never grows, and different sites may be evaluated at once.
/// `most(s)` is no less than it was at first, and quickly told. `take(s, view)` says that what is
/// seen there counts no more.
template <typename V>
concept ViewsFromSites = requires(V& views, std::size_t s, double enough, GainByView& gain,
                                  int view) {
  { views.most(s) } -> std::convertible_to<double>;
  { views.evaluate(s, enough, gain) } -> std::convertible_to<double>;
  views.take(s, view);
};

struct TeamTourOptions {
  double stop_cost = 1.0;  ///< What a stop costs beside its detour; more than 0 [m].
  double turn_cost = 0.1;  ///< What turning costs; gimbals tilt meanwhile [m/rad].
  double keep = 1.3;       ///< Gain of a robot's current goal, over that of another.
  /// What a metre costs by which a robot's tour is longer than the shortest of the team.
  double balance = 0.3;
  int threads = 1;  ///< The result is the same for any number.
};
/// Where a robot's tour begins.
struct TourStart {
  Configuration from;
  std::vector<double> distance;       ///< To each site [m]; infinite where there is no path.
  int stops = 10;                     ///< At the most.
  std::optional<std::size_t> goal{};  ///< The site it is flying to.
  /// Whether the order of the tour is asked for, or only what it leaves to the others.
  bool asked = true;
};
struct TeamTourStop {
  std::size_t site = 0;
  int view = 0;
  double rate = 0.0;  ///< Its gain over what it cost when it was inserted.
  double gain = 0.0;  ///< What it shows beside those that were inserted before [m²].
};

/// Stops for each robot in the order of the visit: those of the most gain per metre inserted, one
/// after the other wherever in the team's tours they cost least, each tour then put in the shortest
/// order. What pays best alone may be the end of a tour, and what lies along a leg is visited when
/// passed.
///
/// Legs between stops are taken as straight. O(robots · stops · sites), and the views that `views`
/// has to take.
template <ViewsFromSites Views>
class TeamTours {
 public:
  /// All must outlive the object.
  TeamTours(std::span<const TourStart> team, std::span<const Point3> sites, Views& views,
            const TeamTourOptions& options)
      : sites_(sites), views_(&views), options_(options) {
    tours_.reserve(team.size());
    for (const TourStart& start : team) tours_.emplace_back(start, sites);
  }

  std::vector<std::vector<TeamTourStop>> operator()() {
    std::vector<double> most(sites_.size());
    parallel_for(
        sites_.size(), options_.threads, [&](std::size_t s) { most[s] = views_->most(s); }, 256);
    while (const auto best = best_insertion(most)) {
      tours_[best->tour].insert(best->stop, best->leg, options_.stop_cost);
      views_->take(best->stop.site, best->stop.view);
    }
    std::vector<std::vector<TeamTourStop>> ordered(tours_.size());
    parallel_for(tours_.size(), options_.threads, [&](std::size_t t) {
      ordered[t] = tours_[t].start->asked ? in_order(tours_[t]) : tours_[t].stops;
    });
    return ordered;
  }

 private:
  struct Tour {
    Tour(const TourStart& s, std::span<const Point3> all)
        : start(&s), sites(all), insertion(all.size(), legs, Distance{this}) {}
    Tour(const Tour&) = delete;
    Tour& operator=(const Tour&) = delete;
    Tour(Tour&&) = default;  // for a vector that does not grow

    struct Distance {
      const Tour* tour;
      double operator()(std::size_t k, std::size_t s) const { return tour->distance(k, s); }
    };
    const Point3& position(std::size_t k) const {
      return k == 0 ? start->from.position : sites[stops[k - 1].site];
    }
    double yaw(std::size_t k) const {
      return k == 0 ? start->from.yaw : heading_angle(stops[k - 1].view % kHeadings);
    }
    double distance(std::size_t k, std::size_t s) const {
      return k == 0 ? start->distance[s] : (position(k) - sites[s]).norm();
    }
    bool full() const {
      return stops.size() >= static_cast<std::size_t>(std::max(start->stops, 0));
    }
    void insert(const TeamTourStop& stop, std::size_t leg, double stop_cost) {
      length += insertion[stop.site].extra + stop_cost;
      const double to_stop = distance(leg, stop.site);
      const auto at = static_cast<std::ptrdiff_t>(leg);
      stops.insert(stops.begin() + at, stop);
      legs.insert(legs.begin() + at, to_stop);
      if (leg + 1 < stops.size()) legs[leg + 1] = distance(leg + 1, stops[leg + 1].site);
      insertion.inserted(leg, legs, Distance{this});
    }

    const TourStart* start;
    std::span<const Point3> sites;
    std::vector<TeamTourStop> stops;
    std::vector<double> legs;
    double length = 0.0;
    CheapestInsertion insertion;
  };
  struct Insertion {
    TeamTourStop stop;
    std::size_t tour = 0, leg = 0;

    bool better_than(const Insertion& other) const {
      return stop.rate != other.stop.rate ? stop.rate > other.stop.rate
                                          : stop.rate > 0.0 && stop.site < other.stop.site;
    }
  };
  /// A site that may become a stop.
  struct Candidate {
    double most_rate = 0.0;
    std::size_t site = 0;
    double cheapest = 0.0;  ///< No insertion costs less [m].

    bool operator<(const Candidate& o) const {  // for a heap
      return most_rate != o.most_rate ? most_rate < o.most_rate : site > o.site;
    }
  };
  /// What inserting a site in a tour costs, turns aside, and what at least with them [m].
  struct InsertionCost {
    double metres = std::numeric_limits<double>::infinity(), least = metres;
  };

  double turn(double a, double b) const { return options_.turn_cost * std::abs(wrap_angle(a - b)); }
  double turn_at(const Tour& tour, std::size_t leg, double yaw) const {
    const double before = turn(tour.yaw(leg), yaw);
    return leg == tour.stops.size()
               ? before
               : before + turn(yaw, tour.yaw(leg + 1)) - turn(tour.yaw(leg), tour.yaw(leg + 1));
  }

  InsertionCost cost_of(const Tour& tour, std::size_t s, double shortest) const {
    if (tour.full() || std::isinf(tour.start->distance[s])) return {};
    const double keep = tour.start->goal == s ? 1.0 / options_.keep : 1.0;
    InsertionCost cost;
    cost.metres = keep * (std::max(tour.insertion[s].extra, 0.0) + options_.stop_cost +
                          options_.balance * (tour.length - shortest));
    // Turning may come for less than nothing, but never for so much less.
    cost.least =
        std::max(cost.metres - 2.0 * kPi * options_.turn_cost, 0.5 * keep * options_.stop_cost);
    return cost;
  }
  /// Sites are evaluated where most may be gained for a metre, and as long as that may be the best,
  /// first those that were best the last time. In batches of the same size for any number of
  /// threads, so that the result is the same.
  std::optional<Insertion> best_insertion(std::vector<double>& most) {
    double shortest = std::numeric_limits<double>::infinity();
    for (const Tour& t : tours_)
      if (!t.full()) shortest = std::min(shortest, t.length);
    Insertion best;
    std::vector<Insertion> tried;
    std::array<Candidate, kBatch> batch;
    std::array<Insertion, kBatch> found;
    const auto evaluate = [&](std::size_t count) {
      parallel_for(count, options_.threads, [&](std::size_t k) {
        found[k] = best_at(batch[k], kTie * best.stop.rate, shortest, most[batch[k].site]);
      });
      for (std::size_t k = 0; k < count; ++k) {
        if (found[k].stop.rate > 0.0) tried.push_back(found[k]);
        if (found[k].better_than(best)) best = found[k];
      }
    };
    std::size_t count = 0;
    for (const std::size_t s : promising_)
      if (const auto c = candidate(s, shortest, most[s])) batch[count++] = *c;
    evaluate(count);
    const double floor = 0.5 * options_.stop_cost / std::max(options_.keep, 1.0);
    std::vector<Candidate> open;  // without those just evaluated
    for (std::size_t s = 0; s < sites_.size(); ++s) {
      if (most[s] <= kTie * best.stop.rate * floor) continue;  // most are
      const auto c = candidate(s, shortest, most[s]);
      if (c && c->most_rate > kTie * best.stop.rate && !is_promising(s)) open.push_back(*c);
    }
    std::make_heap(open.begin(), open.end());
    for (;;) {
      for (count = 0;
           count < kBatch && !open.empty() && open.front().most_rate > kTie * best.stop.rate;) {
        std::pop_heap(open.begin(), open.end());
        batch[count++] = open.back();
        open.pop_back();
      }
      if (count == 0) break;
      evaluate(count);
    }
    std::stable_sort(tried.begin(), tried.end(), [](const Insertion& a, const Insertion& b) {
      return a.stop.rate > b.stop.rate;
    });
    promising_.clear();
    for (std::size_t k = 0; k < tried.size() && promising_.size() < kBatch; ++k)
      if (tried[k].stop.site != best.stop.site) promising_.push_back(tried[k].stop.site);
    return best.stop.rate > 0.0 ? std::optional(best) : std::nullopt;
  }
  bool is_promising(std::size_t s) const {
    return std::find(promising_.begin(), promising_.end(), s) != promising_.end();
  }
  /// Nothing where no tour takes the site.
  std::optional<Candidate> candidate(std::size_t s, double shortest, double most) const {
    double cheapest = std::numeric_limits<double>::infinity();
    for (const Tour& tour : tours_) cheapest = std::min(cheapest, cost_of(tour, s, shortest).least);
    if (std::isinf(cheapest)) return std::nullopt;
    return Candidate{most / cheapest, s, cheapest};
  }
  /// The best insertion of a site, if it is better than `best_rate`; else one without gain.
  Insertion best_at(const Candidate& c, double best_rate, double shortest, double& most) const {
    Insertion best;
    GainByView gain;
    most =
        std::min(most, static_cast<double>(views_->evaluate(c.site, best_rate * c.cheapest, gain)));
    if (most <= best_rate * c.cheapest) return best;
    for (std::size_t t = 0; t < tours_.size(); ++t) {
      const InsertionCost cost = cost_of(tours_[t], c.site, shortest);
      if (std::isinf(cost.metres)) continue;
      const std::size_t leg = tours_[t].insertion[c.site].leg;
      for (std::size_t k = 0; k < gain.size(); ++k) {
        const int view = static_cast<int>(k);
        if (gain[k] <= best_rate * cost.least) continue;
        const double metres = std::max(
            cost.metres + turn_at(tours_[t], leg, heading_angle(view % kHeadings)), cost.least);
        if (gain[k] <= best_rate * metres) continue;
        best_rate = gain[k] / metres;
        best = {{c.site, view, best_rate, gain[k]}, t, leg};
      }
    }
    return best;
  }
  std::vector<TeamTourStop> in_order(const Tour& tour) const {
    const auto length = [&](int i, int j) {
      const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j);
      return tour.distance(b, tour.stops[a - 1].site) + turn(tour.yaw(a), tour.yaw(b));
    };
    std::vector<TeamTourStop> ordered;
    for (const int i :
         shortest_hamiltonian_path(static_cast<int>(tour.stops.size()) + 1, length, LinKernighan{})
             .order)
      if (i > 0) ordered.push_back(tour.stops[static_cast<std::size_t>(i) - 1]);
    return ordered;
  }

  static constexpr std::size_t kBatch = 8;  ///< Sites evaluated at a time.
  /// Of the best rate, for another to be as good but for rounding; then the first site is taken.
  static constexpr double kTie = 1.0 - 1e-12;

  std::span<const Point3> sites_;
  Views* views_;
  TeamTourOptions options_;
  std::vector<Tour> tours_;
  std::vector<std::size_t> promising_;  // sites next best the last time
};
}  // namespace surfleet
