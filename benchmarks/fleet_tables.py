# SPDX-License-Identifier: MIT
"""Missions of distributed fleets and runs of fleets of processes, as tables of RESULTS.md."""
from figures import mean, number, ratio

# Of distributed missions, in the order they are shown.
ROWS = ("centralized", "perfect", "wifi", "poor", "sight", "parted", "killed", "restarted",
        "images10", "images20", "images40")


def difference(pairs, key):
    found = [b[key] - a[key] for a, b in pairs if a.get(key) is not None and b.get(key) is not None]
    return mean(found)


def sent(metrics):
    """Of all robots, without what a centre tells them [bytes]."""
    return sum(metrics.get("bytes_sent") or [])


def catching_up(all_of):
    """Worst time until all held what any held [s]; nothing if one never came to that."""
    took = [c["took_s"] for m in all_of for c in m.get("caught_up", [])]
    return None if not took or None in took else max(took)


def missions(files):
    """A table over the centralised missions of the same scene, team and seed."""
    flown = {}
    for f in files:
        flown.setdefault((f["scene"], f["robots"], f["row"]), {})[f["seed"]] = f["metrics"]
    teams = sorted({(scene, robots) for scene, robots, _ in flown})
    for scene, robots in teams:
        base = flown.get((scene, robots, "centralized"), {})
        for row in ROWS:
            seeds = flown.get((scene, robots, row))
            if not seeds:
                continue
            all_of = list(seeds.values())
            pairs = [(base[s], m) for s, m in seeds.items() if s in base]
            stops = [m["redundant_stops"] for m in all_of if "redundant_stops" in m]
            equal = [m["maps_equal"] for m in all_of if m.get("maps_equal") is not None]
            same = row == "centralized"
            yield (f"{scene}×{robots}", row, str(len(seeds)),
                   number(mean([m["completion_time_s"] for m in all_of])) + " s" if same else
                   number(ratio(pairs, lambda m: m["completion_time_s"]), 2),
                   number(mean([m["total_path_length_m"] for m in all_of])) + " m" if same else
                   number(ratio(pairs, lambda m: m["total_path_length_m"]), 2),
                   number(mean([m["surface_coverage"] for m in all_of]), 1, 100) + " %" if same else
                   number(difference(pairs, "surface_coverage"), 1, 100),
                   number(mean([m["rmse_m"] for m in all_of]), 2, 100) + " cm" if same else
                   number(ratio(pairs, lambda m: m["rmse_m"]), 2),
                   number(mean([sent(m) / robots for m in all_of]), 1, 1e-6),
                   "–" if same else number(ratio(pairs, sent), 3),
                   "–" if not stops else number(mean(stops), 1),
                   "–" if not equal else f"{sum(equal)}/{len(equal)}",
                   number(catching_up(all_of), 1),
                   number(sum(m["collisions"] for m in all_of)),
                   number(mean([m["mission_peak_memory_bytes"] for m in all_of
                                if m.get("mission_peak_memory_bytes")]), 2, 1e-9),
                   number(mean([m["wall_time_s"] for m in all_of])) + " s" if same else
                   number(ratio(pairs, lambda m: m["wall_time_s"]), 1))


MISSION_COLUMNS = ("scene×drones", "network", "n", "time", "path", "coverage", "RMSE", "MB each",
                   "bytes", "stops left", "equal", "caught up, s", "collisions", "memory, GB", "wall")
RUN_COLUMNS = ("variant", "runs", "complete, maps equal", "found in, s", "most MB sent",
               "idle B/s", "idle growth, MB", "collisions")


def runs(data):
    for variant, v in data["variants"].items():
        s, each = v["summary"], v["runs"]
        idle = [r["idle_bytes_per_s"] for r in each if r.get("idle_bytes_per_s") is not None]
        growth = [r["idle_memory_growth_bytes"] for r in each
                  if r.get("idle_memory_growth_bytes") is not None]
        yield (variant, str(s["runs"]), str(s["complete_and_maps_equal"]),
               number(s["found_team_s"], 2), number(s["most_bytes_sent"], 1, 1e-6),
               number(max(idle, default=None)), number(max(growth, default=None), 1, 1e-6),
               number(s["collisions"]))
