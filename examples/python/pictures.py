# SPDX-License-Identifier: Apache-2.0
"""What the examples share: words of the command line, and a figure where python3-matplotlib is installed."""
import argparse, contextlib, os, tempfile

SHORT = """
name = "short"
description = "two places, less than a minute"
[[part]]
technique = "press"
points = ["BL47"]
force_n = 15
repeats = 1
"""


def words(about, *more):
    """The command line of an example; `more` are (name, help) of its own words."""
    parser = argparse.ArgumentParser(description=about)
    for name, help in more:
        parser.add_argument(name, nargs="?", help=help)
    parser.add_argument("--picture", default="picture.png", help="where the picture goes")
    parser.add_argument("--fast", action="store_true", help="a short form, for a test")
    return parser.parse_args()


@contextlib.contextmanager
def short_programme():
    """The file of a programme that takes half a minute."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "short.toml")
        with open(path, "w") as file:
            file.write(SHORT)
        yield path


@contextlib.contextmanager
def figure(path, rows=1, columns=1, **options):
    """(figure, axes) to draw on, then the picture; nothing to draw on (None) without matplotlib."""
    try:
        import matplotlib
    except ImportError:
        print("no picture: python3-matplotlib is not installed")
        yield None
        return
    matplotlib.use("Agg")
    from matplotlib import pyplot

    drawn, axes = pyplot.subplots(rows, columns, layout="constrained", **options)
    yield drawn, axes
    drawn.savefig(path, dpi=110)
    print(f"picture: {path}")


def draw_back(axes, points, stride=7):
    """A back as its head sees it from above (prone) or behind (sitting): x to the person's left, metres."""
    span = points.max(axis=0) - points.min(axis=0)
    height, depth = (1, 2) if span[1] > span[2] else (2, 1)
    shown = points[::stride]
    axes.scatter(shown[:, 0], shown[:, height], c=shown[:, depth], s=4, cmap="bone", alpha=0.8, linewidths=0)
    axes.set_aspect("equal")
    axes.set_xlabel("x in couch, to the person's left (m)")
    axes.set_ylabel(f"{'xyz'[height]} in couch (m)")
    return height
