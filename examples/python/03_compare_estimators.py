# SPDX-License-Identifier: Apache-2.0
"""Three ways to learn alpha of F = alpha tan(beta x) from the same presses, on tissue that keeps to the law and on
tissue that does not."""
import numpy as np

import tuina
from pictures import figure, words
from tuina import simulation

TRUE_ALPHA_N, TRUE_BETA_PER_M = 9.8, 185.4


def main():
    given = words(__doc__)
    worlds = ("control", "qlv30") if given.fast else ("control", "qlv30", "layered", "breathing")
    made = {}
    for world in worlds:
        presses, truth, _ = simulation.presses(TRUE_ALPHA_N, TRUE_BETA_PER_M, world, seed=2)
        made[world] = (tuina.PressEstimator().follow(presses), tuina.estimate_record(presses), tuina.fit_curve(presses))
        recursive, creep, fit = made[world]
        print(f"{world:<10} alpha: press estimator {recursive.alpha_n[-1]:5.2f}, creep estimator "
              f"{creep.estimate.alpha_n:5.2f} +- {creep.estimate.alpha_ci95_n:.2f} ({creep.tissue_class}), "
              f"fit of all {fit.alpha_n:5.2f} +- {fit.alpha_ci95_n:.2f} N, chi {fit.reduced_chi_square:.1f}")
    with figure(given.picture, 1, len(worlds), figsize=(4.5 * len(worlds), 4), sharey=True) as drawn:
        if drawn is None:
            return
        for axes, (world, (recursive, creep, fit)) in zip(drawn[1], made.items()):
            for name, history in (("PressEstimator", recursive), ("CreepEstimator", creep.history)):
                line, = axes.plot(history.time_s, history.alpha_n, label=name)
                axes.fill_between(history.time_s, history.alpha_n - history.alpha_ci95_n,
                                  history.alpha_n + history.alpha_ci95_n, color=line.get_color(), alpha=0.2)
            axes.axhline(fit.alpha_n, color="tab:green", ls=":", label="fit_curve, all at once")
            axes.axhline(TRUE_ALPHA_N, color="k", lw=0.8, label="elastic part, true")
            axes.set(title=world, xlabel="time (s)", ylim=(0.0, 2.0 * TRUE_ALPHA_N))
        drawn[1][0].set_ylabel("alpha (N), with its 95 % interval")
        drawn[1][0].legend()


if __name__ == "__main__":
    main()
