# SPDX-License-Identifier: Apache-2.0
"""The same presses, on tissue that keeps to F = alpha tan(beta x) and on tissue that does not: what two recursive
estimators and a fit say of them, and the force of the next press as each foretells it."""
import numpy as np

import tuina
from pictures import figure, words
from tuina import simulation


def foretell(record, world_presses, last):
    """The last press, its forces hidden from 1.5 N on: time, position, and the force by law and by creep estimator."""
    time_s, position_m = world_presses.time_s[last:], world_presses.position_m[last:]
    known = np.array(world_presses.force_n[last:])
    known[np.argmax(known > 1.5):] = np.nan
    fit = tuina.fit_curve(record)
    steady_m = np.convolve(np.pad(position_m, 12, mode="edge"), np.ones(25) / 25, "valid")  # without the noise
    by_law = tuina.force_at_depth(steady_m - fit.contact_m, fit.alpha_n, fit.beta_per_m)
    hidden = np.isnan(known)
    _, force_n, low_n, high_n = tuina.estimate_record(record).predict(time_s, position_m, known)
    return hidden, by_law[hidden], force_n, low_n, high_n


def main():
    given = words(__doc__)
    worlds = ("control", "qlv30") if given.fast else ("control", "qlv30", "layered", "breathing")
    with figure(given.picture, 2, len(worlds), figsize=(4.2 * len(worlds), 7), sharey="row") as drawn:
        for column, world in enumerate(worlds):
            # The tissue is drawn within 15 % of this alpha, so true are the forces, not it.
            presses, truth, last = simulation.presses(9.8, 185.4, world, seed=2)
            record = tuina.Presses(presses.time_s[:last], presses.position_m[:last], presses.force_n[:last])
            recursive, creep = tuina.PressEstimator().follow(record), tuina.estimate_record(record)
            hidden, by_law, force_n, low_n, high_n = foretell(record, presses, last)
            true_n = truth.force_n[last:][hidden]
            rms = [np.sqrt(np.mean((told - true_n) ** 2)) for told in (by_law, force_n)]
            print(f"{world:<10} alpha {recursive.alpha_n[-1]:5.2f} and {creep.estimate.alpha_n:5.2f} N; the next press "
                  f"is foretold {rms[0]:.2f} N off by the fitted law, {rms[1]:.2f} N by the creep estimator")
            if drawn is None:
                continue
            alpha, force = drawn[1][:, column]
            for name, history in (("PressEstimator", recursive), ("CreepEstimator", creep.history)):
                line, = alpha.plot(history.time_s, history.alpha_n, label=name)
                alpha.fill_between(history.time_s, history.alpha_n - history.alpha_ci95_n,
                                   history.alpha_n + history.alpha_ci95_n, color=line.get_color(), alpha=0.2)
            alpha.set(title=world, ylim=(0.0, 20.0), xlabel="time (s)")
            later_s = truth.time_s[last:][hidden]
            force.plot(later_s, true_n, "k", lw=2, label="true")
            force.plot(later_s, by_law, "tab:green", label="fitted law")
            force.plot(later_s, force_n, "tab:orange", label="CreepEstimator")
            force.fill_between(later_s, low_n, high_n, color="tab:orange", alpha=0.2)
            force.set(xlabel="time (s)")
        if drawn is not None:
            drawn[1][0, 0].set_ylabel("alpha (N), with its 95 % interval")
            drawn[1][1, 0].set_ylabel("force of the next press (N), with its 95 % band")
            for axes in drawn[1][:, 0]:
                axes.legend()


if __name__ == "__main__":
    main()
