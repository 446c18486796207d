// SPDX-License-Identifier: MIT
/// @file
/// @brief Views from the nodes of a flight lattice, taken when they are first asked for.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <map>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include <surfleet/motion/flight_lattice.hpp>
#include <surfleet/motion/free_space.hpp>
#include <surfleet/planning/team_tour.hpp>
#include <surfleet/viewpoint/look_bound.hpp>
#include <surfleet/viewpoint/sight_targets.hpp>

namespace surfleet {
/// What was in view where a robot had looked already: not worth another view there.
class ViewsInVain {
 public:
  /// `gain` is left in a view from a node after a look there; says whether that is new.
  bool note(std::size_t node, int view, double gain) {
    return left_.insert_or_assign({node, view}, gain).second;
  }
  bool contains(std::size_t node, int view, double gain) const {
    const auto it = left_.find({node, view});
    return it != left_.end() && gain <= kMore * it->second;
  }

 private:
  static constexpr double kMore = 1.1;  ///< Times what was left, for another look to be worth it.
  std::map<std::pair<std::size_t, int>, double> left_;  // [m²]
};

/// Views of one set of targets from nodes of a lattice. All that is handed over must outlive it.
class LatticeViews {
 public:
  LatticeViews(const SightTargets<>& targets, FlightLattice<FreeSpace>& lattice,
               const HeadingTable& headings, const ViewsInVain& vain, double unknown_gain)
      : targets_(&targets),
        lattice_(&lattice),
        vain_(&vain),
        most_(targets.all(), lattice, headings, targets.reach()),
        unknown_gain_(unknown_gain),
        done_(targets.size(), 0) {}

  /// A site in the order they are added.
  struct Site {
    VoxelIndex cell;
    bool known = true;  ///< To be free; views from elsewhere pass through unknown space.
  };
  void add(const Site& site) { places_.push_back({site}); }
  const Site& operator[](std::size_t s) const { return places_[s].site; }
  std::size_t size() const { return places_.size(); }
  std::size_t node(std::size_t s) const { return lattice_->index(places_[s].site.cell); }
  /// Whether anything could be in view from a node.
  bool any(const VoxelIndex& cell) const { return most_.in_any_view(cell) > 0.0; }

  // A model of `ViewsFromSites`.
  double look(std::size_t s, double enough, WorthByView& gain) {
    Place& place = places_[s];
    const double share = place.site.known ? 1.0 : unknown_gain_;
    const auto best = [&](const WorthByView& g) { return share * g.most(); };
    if (place.view == nullptr) {
      if (const double any = share * most_.in_any_view(place.site.cell); any <= enough) return any;
      if (const double most = best(most_(place.site.cell)); most <= enough) return most;
    }
    View& view = view_of(place);
    gain = worth_by_view(*targets_, view.seen, done_);
    if (const double most = best(gain); most <= enough) return most;
    if (!view.complete()) {
      cast(place.site, view, [&](const Sighting& hidden) {
        const auto target = static_cast<std::size_t>(hidden.target);
        if (done_[target] != 0) return true;
        for (ViewBits bits = hidden.views; bits != 0; bits &= bits - 1)
          gain[static_cast<std::size_t>(std::countr_zero(bits))] -= (*targets_)[target].worth;
        return best(gain) + kRounding > enough;
      });
      if (!view.complete()) return enough;
      gain = worth_by_view(*targets_, view.seen, done_);
    }
    const std::size_t n = node(s);
    for (std::size_t k = 0; k < gain.size(); ++k)
      gain[k] = vain_->contains(n, static_cast<int>(k), gain[k]) ? 0.0 : share * gain[k];
    return gain.most();
  }
  void take(std::size_t s, int view_taken) {
    View& view = view_of(places_[s]);
    if (!view.complete()) cast(places_[s].site, view, [](const Sighting&) { return true; });
    mark_in_view(view.seen, view_taken, done_, [](std::size_t) {});
  }

  /// Counts no more what is seen from a place.
  void mark(const Configuration& at) {
    mark_in_view(targets_->seen_from(at.position), targets_->headings().nearest_view(at), done_,
                 [](std::size_t) {});
  }
  std::span<const char> done() const { return done_; }

 private:
  struct View {
    std::vector<Sighting> seen;
    std::size_t in_sight = 0;  ///< So many are known to be in sight, the rest may be.
    bool complete() const { return in_sight == seen.size(); }
  };
  struct Place {
    Site site;
    View* view = nullptr;
  };
  static constexpr double kRounding = 1e-9;  ///< Of sums of gain [m²].

  View& view_of(Place& place) {
    if (place.view == nullptr) {
      const auto [it, fresh] = views_.try_emplace(lattice_->index(place.site.cell));
      place.view = &it->second;
      if (fresh) {
        const auto view = targets_->in_view(lattice_->position(place.site.cell), buffer_);
        it->second.seen.assign(view.begin(), view.end());
      }
    }
    return *place.view;
  }
  /// Leaves of a view what is in sight. `go_on` is told of each target that is not, and may put the
  /// rest off.
  template <typename GoOn>
  void cast(const Site& site, View& view, GoOn&& go_on) {
    MapSight sees = targets_->sight();
    if (!site.known) sees.look_through_unknown();
    const Point3 position = lattice_->position(site.cell);
    std::size_t next = view.in_sight;
    for (bool on = true; on && next < view.seen.size(); ++next) {
      const Sighting& s = view.seen[next];
      if (sees(position, (*targets_)[static_cast<std::size_t>(s.target)]))
        view.seen[view.in_sight++] = s;
      else
        on = go_on(s);
    }
    const auto at = [&](std::size_t k) {
      return view.seen.begin() + static_cast<std::ptrdiff_t>(k);
    };
    view.seen.erase(at(view.in_sight), at(next));
  }

  const SightTargets<>* targets_;
  FlightLattice<FreeSpace>* lattice_;
  const ViewsInVain* vain_;
  LookBound most_;
  double unknown_gain_;
  std::vector<char> done_;  // by target
  std::vector<Place> places_;
  std::unordered_map<std::size_t, View> views_;  // by node
  std::vector<Sighting> buffer_;
};
static_assert(ViewsFromSites<LatticeViews>);
}  // namespace surfleet
