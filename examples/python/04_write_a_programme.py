# SPDX-License-Identifier: Apache-2.0
"""A programme of your own, laid onto a back: what it becomes there, and which forces were lowered."""
import tuina
from pictures import draw_back, figure, words
from tuina import simulation

PROGRAMME = """
name = "shoulders first"
description = "Press both sides, circle, then long strokes."

[[part]]
technique = "press"
points = ["SI11", "BL47", "BL50"]
force_n = 24
repeats = 2

[[part]]
technique = "rub"
points = ["BL47"]
force_n = 15
radius_mm = 30
repeats = 4

[[part]]
technique = "stroke"
points = ["SI11", "BL47", "BL50"]
force_n = 12
repeats = 2
"""
COLOURS = {"press": "tab:red", "rub": "tab:blue", "stroke": "tab:green", "tap": "tab:purple", "knead": "tab:cyan"}


def main():
    given = words(__doc__)
    programme = tuina.parse_programme(PROGRAMME)
    cloud = simulation.scan(simulation.person("phantom:medium", "sitting", seed=3), seed=3)
    back = tuina.fit_back(cloud)
    mapping = tuina.locate_acupoints(back, tuina.read_atlas())
    plan = tuina.plan(back, mapping, programme, config=tuina.Config(settings=["safety.force_ceiling_n=30"]))
    print(f"{plan.programme}: {len(plan.paths)} paths in {plan.duration_s:.0f} s")
    for path in plan.paths:
        print(f"{path.start_s:6.1f} s  {path.arm:<5}  {path.name:<26} {path.peak_n:5.1f} N  {path.zone}")
    for note in plan.notes:
        print("note:", note)
    with figure(given.picture, 1, 2, figsize=(13, 6), width_ratios=(1, 1.5)) as drawn:
        if drawn is None:
            return
        where, when = drawn[1]
        up = draw_back(where, cloud.points)
        for path in plan.paths:
            colour = COLOURS[path.technique]
            stays = path.technique in ("press", "tap")
            where.plot(path.at_in_couch[:, 0], path.at_in_couch[:, up], "o" if stays else "-", color=colour, lw=2)
            side = 1 if path.arm == "left" else -1
            when.fill_between(path.start_s + path.time_s, 0, side * path.force_n, color=colour, lw=0)
        where.set_title("where")
        when.set(title="when and how hard", xlabel="time (s)", ylabel="right arm (N)   |   left arm (N)")
        when.axhline(0, color="k", lw=0.5)


if __name__ == "__main__":
    main()
