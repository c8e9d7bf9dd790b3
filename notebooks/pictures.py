# SPDX-License-Identifier: Apache-2.0
"""How the notebooks draw a back: shaded, head up, the person's left on the left."""
import numpy as np
import tuina
from matplotlib.colors import LinearSegmentedColormap

CLAY = LinearSegmentedColormap.from_list("clay", ["#4e4540", "#b9aaa0", "#f4efeb"])
TECHNIQUES = tuina.technique_colours()
ARMS = {"left": "#00796b", "right": "#d35400"}


def draw_back(axes, cloud, centres=()):
    """Draws a cloud with normals, in couch, as who stands beside the person sees it: from above lying, from behind
    sitting. Gives the function that turns N x 3 places in couch, metres, into what axes.plot(*...) takes, centimetres.
    `centres`, places in couch, choose a part of the back: all within 12 cm around them."""
    points, normals = cloud.points, cloud.normals
    span = np.ptp(points, axis=0)
    up = 1 if span[1] > span[2] else 2  # where a person lies, the head is towards -y

    def on(places):
        places = np.atleast_2d(places)
        return 100.0 * places[:, 0], (-100.0 if up == 1 else 100.0) * places[:, up]

    # Light from beside the head grazes the back, so that its relief shows.
    light = np.array([0.6, -0.55, 0.58]) if up == 1 else np.array([0.6, 0.58, 0.55])
    axes.scatter(*on(points), c=normals @ light, cmap=CLAY, vmin=0.0, vmax=1.0, s=16, linewidths=0)
    axes.set_aspect("equal")
    axes.set(xlabel="x, to the person's left (cm)", ylabel="towards the head (cm)")
    if len(centres):
        x, y = on(centres)
        axes.set(xlim=(x.min() - 12.0, x.max() + 12.0), ylim=(y.min() - 12.0, y.max() + 12.0))
    axes.invert_xaxis()
    axes.spines[["top", "right"]].set_visible(False)
    return on
