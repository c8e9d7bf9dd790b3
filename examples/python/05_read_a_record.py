# SPDX-License-Identifier: Apache-2.0
"""What a session.mcap holds, as arrays; without one, a short massage is given and recorded first."""
import os
import tempfile

import numpy as np

import tuina
from pictures import figure, short_programme, words
from tuina import simulation


def show(file, picture):
    record = tuina.read_record(file)
    for topic, count in record.topics.items():
        print(f"{topic:<22} {count:7d} messages")
    for sentence in record.lost:
        print("lost:", sentence)
    tools, joints = record["/tools"], record["/joint_states"]
    contacts = record["/tuina/contacts"]
    force_n = np.linalg.norm(tools["force_in_tool_n"], axis=2)
    print(f"{len(contacts)} contacts in {tools['time_s'][-1]:.0f} s, strongest wrist reading {force_n.max():.1f} N")
    with figure(picture, 3, 1, figsize=(11, 8), sharex=True) as drawn:
        if drawn is None:
            return
        force, height, speed = drawn[1]
        for i, name in enumerate(tools["name"]):
            force.plot(tools["time_s"], force_n[:, i], lw=0.6, label=name)
            height.plot(tools["time_s"], tools["at_in_base"][:, i, 2], lw=1.0)
        for contact in contacts:
            force.axvspan(contact["begin_s"], contact["end_s"], color="tab:green", alpha=0.08)
            height_n = force_n.max() * (0.55 if contact["arm"] == "left" else 0.1)
            force.annotate(contact["path"], (contact["begin_s"], height_n), fontsize=7, rotation=90)
        force.set_ylabel("wrist, weight of the tool included (N)")
        force.legend(loc="upper right")
        height.set_ylabel("tools above base (m)")
        speed.plot(joints["time_s"], np.abs(joints["velocity"][:, 1:]).max(axis=1), lw=0.6, color="tab:purple")
        speed.set(ylabel="fastest joint (rad/s)", xlabel="time of the session (s)")


def main():
    given = words(__doc__, ("record", "a session.mcap"))
    if given.record:
        return show(given.record, given.picture)
    with short_programme() as short, tempfile.TemporaryDirectory() as folder:
        simulation.massage(programme=short if given.fast else "relax", position="prone", out=folder)
        show(os.path.join(folder, "session.mcap"), given.picture)


if __name__ == "__main__":
    main()
