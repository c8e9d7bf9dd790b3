# SPDX-License-Identifier: Apache-2.0
"""Arrays show the library's memory; what is no such array is refused."""
import gc, threading, unittest

import numpy as np

import tuina
from tuina import simulation


def address(array):
    return array.__array_interface__["data"][0]


class Views(unittest.TestCase):
    def assertView(self, owner, name, shape):
        array = getattr(owner, name)
        self.assertEqual(array.shape, shape, name)
        self.assertFalse(array.flags.writeable, name)
        if array.size == 0:
            return array
        self.assertEqual(address(array), address(getattr(owner, name)), f"{name} is copied each time")
        self.assertFalse(array.flags.owndata, name)
        with self.assertRaises(ValueError, msg=name):
            array[...] = 0
        return array

    def test_a_cloud_shows_its_points(self):
        given = np.arange(30.0).reshape(10, 3)
        cloud = tuina.PointCloud(given)
        points = self.assertView(cloud, "points", (10, 3))
        self.assertNotEqual(address(points), address(given))
        given[:] = 0.0
        self.assertEqual(points[9].tolist(), [27.0, 28.0, 29.0])
        self.assertView(cloud, "normals", (0, 3))
        self.assertView(cloud, "triangles", (0, 3))

    def test_a_view_keeps_its_owner(self):
        points = tuina.PointCloud(np.full((1000, 3), 7.0)).points
        gc.collect()
        _ = [tuina.PointCloud(np.zeros((1000, 3))) for _ in range(20)]
        self.assertTrue((points == 7.0).all())

    def test_integers_floats_lists_and_columns_of_other_arrays_are_points(self):
        wide = np.arange(40, dtype=np.float32).reshape(10, 4)
        for given in (wide[:, :3], wide[:, :3].astype(int), wide[:, :3].tolist(), np.asfortranarray(wide[:, :3])):
            self.assertEqual(tuina.PointCloud(given).points.tolist(), wide[:, :3].tolist())

    def test_presses_estimates_and_maps_are_views(self):
        presses, truth, _ = simulation.presses(9.8, 185.4, "control", 1)
        for name in ("time_s", "position_m", "force_n"):
            self.assertView(presses, name, (len(presses),))
        self.assertGreater(np.abs(presses.force_n - truth.force_n).max(), 0.1)
        history = tuina.estimate_record(presses).history
        for name in ("time_s", "alpha_n", "beta_per_m", "alpha_ci95_n", "beta_ci95_per_m", "converged"):
            self.assertView(history, name, (len(presses),))
        self.assertIn(history.converged.dtype, (bool,))
        person = simulation.person("phantom:slim", "sitting", 2)
        back = tuina.fit_back(simulation.scan(person, 2))
        mapping = tuina.locate_acupoints(back, tuina.read_atlas())
        count = len(mapping.names)
        self.assertView(mapping, "at_in_couch", (count, 3))
        self.assertView(mapping, "uncertainty_m", (count,))
        self.assertView(back, "points", (len(back.points), 3))
        covariance = self.assertView(mapping, "covariance_m2", mapping.covariance_m2.shape)
        self.assertGreaterEqual(covariance.shape[0], 3 * count)
        np.testing.assert_allclose(covariance, covariance.T, rtol=1e-9)
        path = tuina.plan(back, mapping, tuina.load_programme("lower_back")).paths[0]
        gc.collect()  # the plan is gone but for this path
        self.assertView(path, "at_in_couch", (len(path.time_s), 3))
        self.assertView(path, "force_n", (len(path.time_s),))
        self.assertLessEqual(path.force_n.max(), path.cap_n)

    def test_the_law_is_one_for_numbers_and_arrays(self):
        depth_m = np.array([[-0.001, 0.0, 0.002], [0.004, 0.006, 0.5]])
        force_n = tuina.force_at_depth(depth_m, 9.8, 185.4)
        np.testing.assert_allclose(force_n[0], [0.0, 0.0, 9.8 * np.tan(185.4 * 0.002)], rtol=1e-12)
        self.assertTrue(np.isfinite(force_n).all())


class Refusals(unittest.TestCase):
    def refused(self, sentence, call, *words):
        with self.assertRaises(tuina.Error) as raised:
            call(*words)
        self.assertIn(sentence, str(raised.exception))
        self.assertIn(raised.exception.fault, ("bad_input", "usage", "not_found"))

    def test_clouds(self):
        self.refused("points has the shape (5, 2); N rows of x, y, z are needed", tuina.PointCloud, np.zeros((5, 2)))
        self.refused("points has the shape (3,)", tuina.PointCloud, [1, 2, 3])
        self.refused("points has the shape ()", tuina.PointCloud, 1.0)
        hole = np.zeros((4, 3))
        hole[2, 1] = np.nan
        self.refused("points[2] is (0, nan, 0)", tuina.PointCloud, hole)
        hole[2, 1] = np.inf
        self.refused("points[2] is (0, inf, 0)", tuina.PointCloud, hole)
        self.refused("there are 1 normals and 2 points", tuina.PointCloud, np.zeros((2, 3)), np.zeros((1, 3)))
        for other in ("text", [[1j, 0, 0]], [["a", "b", "c"]], [None], [[1, 2], [3]], np.zeros((2, 3), dtype=bool)):
            self.refused("array of", tuina.PointCloud, other)
        self.refused("no person found: 4 of 4 points", tuina.fit_back, tuina.PointCloud(np.zeros((4, 3))))
        self.refused("no person found: 0 of 0 points", tuina.fit_back, tuina.PointCloud(np.zeros((0, 3))))
        with self.assertRaises(TypeError):
            tuina.fit_back(np.zeros((4, 3)))

    def test_presses(self):
        self.refused("time_s has 2 numbers, position_m 1 and force_n 2", tuina.Presses, [0, 1], [0], [0, 1])
        self.refused("time_s has the shape (1, 1)", tuina.Presses, [[0]], [0], [0])
        self.refused("force_n[1] is nan", tuina.Presses, [0, 1], [0, 0], [0, np.nan])
        self.refused("sample 1: time_s goes from 1 to 1, it must grow", tuina.Presses, [1, 1], [0, 0], [0, 0])
        self.refused("sample 0: 2000 mm and 0 N are no press", tuina.Presses, [1], [2], [0])
        self.refused("the record has no samples", tuina.estimate_record, tuina.Presses([], [], []))
        with self.assertRaises(tuina.Error):
            tuina.fit_curve(tuina.Presses([], [], []))
        self.refused("alpha_n is nan; more than 0 is needed", simulation.presses, np.nan, 185.4)
        self.refused("beta_per_m is -1; more than 0 is needed", tuina.force_at_depth, [0.01], 9.8, -1.0)
        self.refused("depth_m[1] is nan", tuina.force_at_depth, [0.01, np.nan], 9.8, 185.4)
        masked = np.ma.masked_array(np.ones((2, 3)), mask=[[0, 0, 1], [0, 0, 0]])
        self.refused("is masked in part", tuina.PointCloud, masked)

    def test_estimators(self):
        estimator = tuina.CreepEstimator()
        estimator.update(1.0, 0.0, 0.0)
        self.refused("time_s goes from 1 to 0.5", estimator.update, 0.5, 0.0, 0.0)
        self.refused("force_n[0] is nan", estimator.update, 2.0, 0.0, np.nan)
        self.assertEqual(estimator.update(2.0, 0.0, 0.0).presses, 0)
        self.refused("breathing_m is -1; 0 or more is needed", lambda: tuina.EstimatorOptions(breathing_m=-1))
        self.refused("torso_sd is nan", lambda: tuina.EstimatorOptions(torso_sd=np.nan))
        with self.assertRaises(AttributeError):
            tuina.EstimatorOptions(breathing_mm=1)
        presses, _, _ = simulation.presses(9.8, 185.4)
        self.refused("force_noise_n is 0; more than 0 is needed", lambda: tuina.fit_curve(presses, force_noise_n=0))
        made = tuina.estimate_record(presses)
        self.refused("every row has a force_n", made.predict, [20.0], [0.0], [0.0])
        self.refused("lies within the record", made.predict, [1.0], [0.0], [np.nan])
        self.refused("has no rows", made.predict, [], [], [])
        self.refused("position_m[0] is nan", made.predict, [20.0], [np.nan], [np.nan])

    def test_words(self):
        person = simulation.person()
        self.refused("position is lying; sitting or prone is needed", simulation.person, "phantom:medium", "lying")
        self.refused("world is nothing; one of control,", simulation.presses, 9.8, 185.4, "nothing")
        self.refused("format is stl", person.skin_in_couch.write, "/tmp/never.stl", "stl")
        back = tuina.fit_back(person.skin_in_couch)
        self.refused("method is best", tuina.locate_acupoints, back, tuina.read_atlas(), "best")
        self.refused("place_in_couch is (nan, 0, 0)", back.nearest, [np.nan, 0, 0])
        mapping = tuina.locate_acupoints(back, tuina.read_atlas())
        self.refused("XX1", mapping.fix, back, {"XX1": [0, 0, 0]})
        self.refused("BL47_L has the shape (2,)", mapping.fix, back, {"BL47_L": [0, 0]})

    def test_long_work_lets_other_threads_run(self):
        presses, _, _ = simulation.presses(9.8, 185.4)
        turns, over = [0], threading.Event()

        def count():
            while not over.is_set():
                turns[0] += 1

        counter = threading.Thread(target=count)
        counter.start()
        before = turns[0]
        tuina.fit_curve(presses)  # a third of a second
        counted = turns[0] - before
        over.set()
        counter.join()
        self.assertGreater(counted, 1000)


if __name__ == "__main__":
    unittest.main()
