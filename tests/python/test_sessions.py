# SPDX-License-Identifier: Apache-2.0
"""Massages in simulation from Python, and their records."""
import csv, json, os, signal, subprocess, sys, tempfile, unittest

import numpy as np

import tuina
from tuina import simulation
from program import answer, timeless

SHORT = """
name = "short"
description = "two places"
[[part]]
technique = "press"
points = ["BL47"]
force_n = 15
repeats = 1
hold_s = 1
[[part]]
technique = "rub"
points = ["BL47_L"]
force_n = 10
repeats = 1
"""


class Sessions(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        made = tempfile.TemporaryDirectory()
        cls.addClassCleanup(made.cleanup)
        cls.folder = made.name
        cls.words = dict(person="phantom:slim", position="prone", seed=4, programme=f"{cls.folder}/short.toml")
        with open(cls.words["programme"], "w") as file:
            file.write(SHORT)
        cls.told = []
        cls.session = simulation.massage(**cls.words, out=f"{cls.folder}/ours", on_contact=cls.told.append)

    def test_a_massage_is_that_of_the_program(self):
        theirs = answer("massage", "--person", "phantom:slim", "--position", "prone", "--seed", "4", "--programme",
                        self.words["programme"], "--out", f"{self.folder}/theirs")
        self.assertEqual(timeless(json.loads(self.session.to_json())), timeless(theirs))
        for name in ("trace.csv", "joints.csv", "distances.csv", "scan.ply", "config.toml", "consent.toml"):
            with open(f"{self.folder}/ours/{name}", "rb") as ours, open(f"{self.folder}/theirs/{name}", "rb") as others:
                self.assertEqual(ours.read(), others.read(), name)

    def test_each_contact_is_told(self):
        self.assertEqual(len(self.told), 3)
        self.assertEqual([c.path for c in self.told], [c.path for c in self.session.contacts])
        self.assertEqual({c.arm for c in self.told}, {"left", "right"})
        for contact in self.told:
            self.assertLess(contact.begin_s, contact.end_s)
            self.assertEqual((contact.contact_fault, contact.whole), ("none", True))
            self.assertEqual(contact.felt is not None, contact.path.startswith("press"))
            if contact.felt:
                self.assertGreater(contact.felt.alpha_n, 0.0)
        self.assertEqual(self.session.stops, [])

    def test_what_is_seen_of_a_session_are_views(self):
        trace = self.session.trace("left")
        with open(f"{self.folder}/ours/trace.csv") as file:
            rows = [row for row in csv.DictReader(file) if row["arm"] == "left"]
        self.assertEqual(len(rows), len(trace["time_s"]))
        for name in ("time_s", "target_n", "true_force_n"):
            np.testing.assert_allclose(trace[name], [float(row[name]) for row in rows], atol=1e-3, err_msg=name)
            self.assertFalse(trace[name].flags.owndata)
            self.assertFalse(trace[name].flags.writeable)
        errors_m = self.session.acupoint_errors_m
        self.assertEqual(errors_m.shape, (len(self.session.mapping.names),))
        self.assertLess(np.nanmax(errors_m[:7]), 0.03)
        with self.assertRaisesRegex(tuina.Error, "arm is middle; left or right is needed"):
            self.session.trace("middle")

    def test_a_callback_that_raises_ends_the_session_cleanly(self):
        out = f"{self.folder}/raised"

        class Enough(Exception):
            pass

        seen = []

        def raising(contact):
            seen.append(contact.path)
            raise Enough("after the first")

        with self.assertRaisesRegex(Enough, "after the first"):
            simulation.massage(**self.words, out=out, on_contact=raising)
        self.assertEqual(len(seen), 1)
        # The record is whole, and says that somebody has stopped the arms.
        record = tuina.read_record(f"{out}/session.mcap")
        self.assertEqual(record.lost, [])
        self.assertEqual([event["command"] for event in record["/tuina/commands"]], ["stop"])
        told = json.loads(record.attachment("session.json"))
        self.assertEqual([command["command"] for command in told["commands"]], ["stop"])
        self.assertLess(record["/joint_states"]["time_s"][-1], self.session.massage_s - 5.0)
        self.assertTrue(os.path.exists(f"{out}/report.html"))

    def test_a_callback_commands(self):
        answers = iter(["softer", "stop"])
        session = simulation.massage(**self.words, on_contact=lambda contact: next(answers, None))
        self.assertEqual([command["command"] for command in json.loads(session.to_json())["commands"]],
                         ["softer", "stop"])
        self.assertLess(session.massage_s, self.session.massage_s)
        with self.assertRaisesRegex(ValueError, "on_contact returned 'faster'; None or one of pause, resume, stop"):
            simulation.massage(**self.words, on_contact=lambda contact: "faster")

    def test_ctrl_c_ends_a_session(self):
        code = ("import os, signal, threading\nfrom tuina import simulation\n"
                "threading.Timer(3.0, lambda: os.kill(os.getpid(), signal.SIGINT)).start()\n"
                "simulation.massage(programme='full_back_20min', position='prone')\n")
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
        self.assertIn("KeyboardInterrupt", done.stderr)

    def test_a_record_has_what_the_program_exports(self):
        mcap = f"{self.folder}/ours/session.mcap"
        answer("export", "csv", mcap, "--out", f"{self.folder}/tables")
        record = tuina.read_record(mcap)
        shown = answer("record", "show", mcap)
        self.assertEqual(record.topics, {channel["topic"]: channel["messages"] for channel in shown["channels"]})
        self.assertEqual(record.attachments, [one["name"] for one in shown["attachments"]])
        joints = record["/joint_states"]
        table = np.genfromtxt(f"{self.folder}/tables/joint_states.csv", delimiter=",", skip_header=1)
        ours = np.column_stack([joints["time_s"], joints["position"], joints["velocity"], joints["effort"]])
        np.testing.assert_array_equal(ours, table)
        tools = record["/tools"]
        table = np.genfromtxt(f"{self.folder}/tables/tools.csv", delimiter=",", skip_header=1)
        ours = np.concatenate([tools["at_in_base"], tools["base_from_tool_xyzw"], tools["force_in_tool_n"],
                               tools["torque_in_tool_nm"]], axis=2)
        np.testing.assert_array_equal(ours.reshape(len(ours), -1), table[:, 1:])
        with open(f"{self.folder}/tables/tuina_contacts.csv") as file:
            self.assertEqual([row["path"] for row in csv.DictReader(file)],
                             [event["path"] for event in record["/tuina/contacts"]])
        with open(f"{self.folder}/ours/session.json", "rb") as file:
            self.assertEqual(record.attachment("session.json"), file.read())
        np.testing.assert_allclose(record["/scan"][0]["points"], self.session.scan.points, atol=1e-6)
        self.assertEqual(record["/left/wrench"]["force_in_tool_n"].shape[1], 3)
        self.assertEqual(record["/tf_static"][0]["transforms"][0]["header"]["frame_id"], "base")

    def test_a_record_says_what_it_lacks(self):
        mcap = f"{self.folder}/ours/session.mcap"
        record = tuina.read_record(mcap)
        with self.assertRaisesRegex(tuina.Error, "has no channel /nothing; it has .*/joint_states"):
            record["/nothing"]
        with self.assertRaisesRegex(tuina.Error, "has no attachment nothing.txt"):
            record.attachment("nothing.txt")
        with open(mcap, "rb") as whole, open(f"{self.folder}/cut.mcap", "wb") as cut:
            content = whole.read()
            cut.write(content[:len(content) // 2])
        cut = tuina.read_record(f"{self.folder}/cut.mcap")
        self.assertNotEqual(cut.lost, [])
        self.assertGreater(len(cut["/joint_states"]["time_s"]), 100)
        with self.assertRaisesRegex(tuina.Error, "short.toml"):
            tuina.read_record(self.words["programme"])


if __name__ == "__main__":
    unittest.main()
