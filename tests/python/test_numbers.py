# SPDX-License-Identifier: Apache-2.0
"""What Python computes is what the program says, to the last digit."""
import json, os, tempfile, unittest

import numpy as np

import tuina
from tuina import simulation
from program import ROOT, answer, run, timeless


class Numbers(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.made = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.made.cleanup)
        cls.folder = cls.made.name
        cls.scan = f"{cls.folder}/scan.ply"
        simulation.scan(simulation.person("phantom:medium", "prone", 5), 5).write(cls.scan)
        presses, _, last = simulation.presses(9.786, 185.4, "qlv30", 3)
        cls.presses, cls.next = f"{cls.folder}/presses.csv", f"{cls.folder}/next.csv"
        with open(cls.presses, "w") as record, open(cls.next, "w") as later:
            for file in (record, later):
                file.write("time_s,position_mm,force_n\n")
            met = False
            for i, (time_s, position_m, force_n) in enumerate(
                    zip(presses.time_s, presses.position_m, presses.force_n)):
                met = met or (i >= last and force_n > 1.5)
                row = f"{time_s:.3f},{position_m * 1e3:.5f},{'' if met else f'{force_n:.4f}'}\n"
                (record if i < last else later).write(row)

    def back(self):
        return tuina.fit_back(tuina.read_cloud(self.scan))

    def test_a_map_is_that_of_the_program(self):
        for method in ("surface", "field_morphing"):
            with self.subTest(method):
                mapping = tuina.locate_acupoints(self.back(), tuina.read_atlas(), method)
                told = answer("map", self.scan, "--method", method)
                self.assertEqual(timeless(json.loads(mapping.to_json())), timeless(told))
                self.assertEqual(set(mapping.names), set(told["acupoints"]))
                for i, name in enumerate(mapping.names):
                    self.assertEqual(mapping.at_in_couch[i].tolist(), told["acupoints"][name]["position_m"])
                    self.assertEqual(mapping.normals_in_couch[i].tolist(), told["acupoints"][name]["normal"])
                    self.assertEqual(mapping.uncertainty_m[i] * 1e3, told["acupoints"][name]["uncertainty_mm"])
                for name, place in mapping.landmarks_in_couch.items():
                    self.assertEqual(place.tolist(), told["landmarks"][name])

    def test_a_cloud_that_was_copied_from_an_array_is_mapped_likewise(self):
        cloud = tuina.read_cloud(self.scan)
        ours = tuina.PointCloud(np.array(cloud.points), np.array(cloud.normals) if len(cloud.normals) else None)
        there, here = (tuina.locate_acupoints(tuina.fit_back(c), tuina.read_atlas()) for c in (cloud, ours))
        self.assertEqual(there.at_in_couch.tolist(), here.at_in_couch.tolist())

    def test_a_point_that_a_finger_found_moves_the_others_as_in_the_program(self):
        back = self.back()
        mapping = tuina.locate_acupoints(back, tuina.read_atlas())
        place = mapping.at_in_couch[mapping.names.index("BL47_L")] + [0.004, 0.0, 0.0]
        fixed = mapping.fix(back, {"BL47_L": place}, error_m=5e-3)
        told = answer("map", self.scan, "--fix", "BL47_L=" + ",".join(map(repr, place.tolist())),
                      "--fix-error-mm", "5")
        self.assertEqual(timeless(json.loads(fixed.to_json())), timeless(told))

    def test_a_plan_is_that_of_the_program(self):
        acupoints = f"{self.folder}/acupoints.json"
        answer("map", self.scan, "--out", acupoints)
        map = tuina.read_acupoints(acupoints)
        back = tuina.fit_back(tuina.read_cloud(self.scan), map.position)
        for programme, settings in (("relax", []), ("lower_back", ["safety.force_ceiling_n=12"])):
            with self.subTest(programme):
                plan = tuina.plan(back, map, tuina.load_programme(programme), config=tuina.Config(settings=settings))
                told = answer("plan", self.scan, acupoints, "--programme", programme,
                              *(word for setting in settings for word in ("--set", setting)))
                self.assertEqual(timeless(json.loads(plan.to_json())), timeless(told))
                self.assertEqual([path.name for path in plan.paths], [path["name"] for path in told["paths"]])
                # A plan.json is rounded to micrometres and micronewtons.
                for path, in_file in zip(plan.paths, told["paths"]):
                    places = [p["position_m"] for p in in_file["points"]]
                    np.testing.assert_allclose(path.at_in_couch, places, atol=6e-7)
                    np.testing.assert_allclose(path.force_n, [p["force_n"] for p in in_file["points"]], atol=6e-7)

    def test_a_fit_is_that_of_the_program(self):
        fit = tuina.fit_curve(tuina.read_presses(self.presses))
        told = answer("tissue", "fit", self.presses)
        self.assertEqual((fit.alpha_n, fit.beta_per_m * 1e-3, fit.contact_m * 1e3, fit.offset_n, fit.rmse_n,
                          fit.reduced_chi_square, fit.peak_force_n, fit.samples, fit.alpha_ci95_n,
                          fit.beta_ci95_per_m * 1e-3),
                         (*(told[key] for key in ("alpha_n", "beta_per_mm", "contact_mm", "force_offset_n", "rmse_n",
                                                  "chi", "peak_force_n", "samples")),
                          told["ci95"]["alpha_n"], told["ci95"]["beta_per_mm"]))

    def test_an_estimate_is_that_of_the_program(self):
        for noise, words in (({}, []), (dict(force_noise_n=0.3, position_noise_m=1e-4),
                                        ["--force-noise-n", "0.3", "--position-noise-mm", "0.1"])):
            with self.subTest(noise):
                made = tuina.estimate_record(tuina.read_presses(self.presses), **noise)
                told = answer("tissue", "estimate", self.presses, *words)
                now = made.estimate
                self.assertEqual((now.alpha_n, now.beta_per_m * 1e-3, now.contact_m * 1e3, now.alpha_ci95_n,
                                  now.converged, now.converged_after_s, now.presses, made.nis, made.tissue_class,
                                  made.class_probabilities, made.force_noise_n),
                                 (told["alpha_n"], told["beta_per_mm"], told["contact_mm"], told["ci95"]["alpha_n"],
                                  told["converged"], told["converged_after_s"], told["presses"], told["chi"],
                                  told["class"], told["class_probabilities"], told["noise"]["force_n"]))
                self.assertEqual(made.history.alpha_n[-1], now.alpha_n)

    def test_samples_one_by_one_arrays_and_records_give_the_same(self):
        presses = tuina.read_presses(self.presses)
        options = tuina.EstimatorOptions(breathing_m=2e-3)
        for kind in (tuina.PressEstimator, tuina.CreepEstimator):
            with self.subTest(kind.__name__):
                one_by_one, at_once, followed = kind(options), kind(options), kind(options)
                rows = zip(presses.time_s, presses.position_m, presses.force_n)
                alphas = [one_by_one.update(*row).alpha_n for row in rows]
                at_once.update(presses.time_s, presses.position_m, presses.force_n)
                history = followed.follow(presses)
                self.assertEqual(history.alpha_n.tolist(), alphas)
                self.assertEqual(at_once.estimate.alpha_n, alphas[-1])
                self.assertNotEqual(kind().follow(presses).alpha_n[-1], alphas[-1])  # the options count
                at_once.reset()
                self.assertEqual(at_once.update(0.0, 0.0, 0.0).presses, 0)

    def test_the_next_press_is_foretold_as_by_the_program(self):
        told = f"{self.folder}/told.csv"
        answer("tissue", "estimate", self.presses, "--predict", self.next, "--predict-out", told)
        rows = np.genfromtxt(self.next, delimiter=",", skip_header=1)
        made = tuina.estimate_record(tuina.read_presses(self.presses))
        foretold = np.column_stack(made.predict(rows[:, 0], rows[:, 1] * 1e-3, rows[:, 2]))
        self.assertGreater(len(foretold), 100)
        np.testing.assert_allclose(foretold, np.genfromtxt(told, delimiter=",", skip_header=1), rtol=1e-5)

    def test_an_atlas_is_learned_as_by_the_program(self):
        people = f"{self.folder}/people"
        os.mkdir(people)
        for seed in (1, 2):
            simulation.person("phantom:medium", "prone", seed).write(f"{people}/{seed}.ply")
        atlas = tuina.learn_atlas(tuina.read_labelled_bodies(people))
        atlas.write(f"{self.folder}/ours.tuina")
        answer("atlas", "learn", people, "--scan", "ideal", "--out", f"{self.folder}/theirs.tuina")
        with open(f"{self.folder}/ours.tuina", "rb") as ours, open(f"{self.folder}/theirs.tuina", "rb") as theirs:
            self.assertEqual(ours.read(), theirs.read())
        self.assertEqual(tuina.read_atlas(f"{self.folder}/ours.tuina").bodies, atlas.bodies)

    def test_an_error_has_the_sentence_of_the_program(self):
        broken = f"{self.folder}/broken.ply"
        with open(broken, "w") as file:
            file.write("ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nend_header\n1\n")
        bad = f"{self.folder}/bad.csv"
        with open(bad, "w") as file:
            file.write("time_s,position_mm,force_n\n1,0,0\n0.5,0,0\n")
        calls = (((lambda: tuina.read_cloud(broken)), ["map", broken]),
                 ((lambda: tuina.read_cloud("nothing.pcd")), ["map", "nothing.pcd"]),
                 ((lambda: tuina.read_presses(bad)), ["tissue", "fit", bad]),
                 ((lambda: tuina.Config(settings=["safety.force_ceiling_n=95"])),
                  ["config", "show", "--set", "safety.force_ceiling_n=95"]),
                 ((lambda: simulation.massage(programme="nothing")), ["massage", "--programme", "nothing"]))
        for call, words in calls:
            with self.subTest(words):
                with self.assertRaises(tuina.Error) as raised:
                    call()
                done = run(*words)
                self.assertNotEqual(done.returncode, 0)
                self.assertIn(str(raised.exception), done.stderr)
                self.assertIn(raised.exception.fault, ("usage", "not_found", "bad_input", "config", "file"))


if __name__ == "__main__":
    unittest.main()
