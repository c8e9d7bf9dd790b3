# SPDX-License-Identifier: Apache-2.0
"""A first massage: a simulated person is scanned, mapped and massaged, and each contact is told as it ends."""
import numpy as np

from pictures import draw_back, figure, short_programme, words
from tuina import simulation


def told(contact):
    felt = f"alpha {contact.felt.alpha_n:5.1f} N" if contact.felt else ""
    print(f"{contact.end_s:6.1f} s  {contact.arm:<5}  {contact.path:<24} {felt}")


def draw(session, path):
    with figure(path, 1, 2, figsize=(13, 5), width_ratios=(1, 2)) as drawn:
        if drawn is None:
            return
        back, force = drawn[1]
        up = draw_back(back, session.scan.points)
        for planned in session.plan.paths:
            back.plot(planned.at_in_couch[:, 0], planned.at_in_couch[:, up], lw=3, alpha=0.8)
        places = session.mapping.at_in_couch
        back.plot(places[:7, 0], places[:7, up], "r+", ms=9, mew=2)
        back.set_title("acupoints and paths on the scan")
        for arm in ("left", "right"):
            trace = session.trace(arm)
            force.plot(trace["time_s"], trace["true_force_n"], lw=0.8, label=f"{arm} arm, true force")
            force.plot(trace["time_s"], trace["target_n"], "k", lw=0.5, alpha=0.6)
        force.set(xlabel="time (s)", ylabel="force (N)", title="what was asked for (black) and what was given")
        force.legend(loc="upper right")


def main():
    given = words(__doc__)
    with short_programme() as short:
        session = simulation.massage(person="phantom:medium", position="prone", seed=1,
                                     programme=short if given.fast else "relax", on_contact=told)
    error_mm = 1e3 * np.nanmean(session.acupoint_errors_m[:7])
    print(f"{session.massage_s:.0f} s, the seven acupoints {error_mm:.1f} mm off, {len(session.stops)} stops")
    draw(session, given.picture)


if __name__ == "__main__":
    main()
