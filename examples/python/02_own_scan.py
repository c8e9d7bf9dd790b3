# SPDX-License-Identifier: Apache-2.0
"""Your own scan to acupoints: a PLY or PCD in metres, z up from the couch; without one, a simulated person's."""
import numpy as np

import tuina
from pictures import draw_back, figure, words
from tuina import simulation


def draw(cloud, mapping, path):
    with figure(path, figsize=(7, 9)) as drawn:
        if drawn is None:
            return
        axes = drawn[1]
        up = draw_back(axes, cloud.points)
        for name, place, radius_m in zip(mapping.names, mapping.at_in_couch, mapping.uncertainty_m):
            seven = name in mapping.names[:7]
            angle = np.linspace(0.0, 2.0 * np.pi, 49)
            axes.plot(place[0] + radius_m * np.cos(angle), place[up] + radius_m * np.sin(angle), lw=1.0,
                      color="tab:red" if seven else "tab:blue")
            if seven:
                axes.annotate(name, (place[0], place[up]), ha="center", va="center", fontsize=8)
        axes.set_title("acupoints; each circle holds the true point in 95 of 100 cases")


def main():
    given = words(__doc__, ("scan", "PLY or PCD, metres"))
    person = None
    if given.scan:
        cloud = tuina.read_cloud(given.scan)
    else:
        person = simulation.person("phantom:hefty", "prone", seed=7)
        cloud = simulation.scan(person, seed=7)
    back = tuina.fit_back(cloud)
    mapping = tuina.locate_acupoints(back, tuina.read_atlas())
    print(f"a person {mapping.position}, {len(cloud)} points, {100 * mapping.coverage:.0f} % of the back in view")
    for i, name in enumerate(mapping.names[:7]):
        x, y, z = 1e3 * mapping.at_in_couch[i]
        off = ""
        if person is not None:
            truth = person.at_in_couch[person.names.index(name)]
            off = f"; truly {1e3 * np.linalg.norm(truth - mapping.at_in_couch[i]):.1f} mm off"
        print(f"{name:<7} ({x:6.1f}, {y:6.1f}, {z:6.1f}) mm, within {1e3 * mapping.uncertainty_m[i]:.0f} mm{off}")
    draw(cloud, mapping, given.picture)


if __name__ == "__main__":
    main()
