# SPDX-License-Identifier: Apache-2.0
"""The types that editors see are those of the module."""
import importlib.util, os, subprocess, sys, tempfile, unittest

PACKAGE = os.environ["PYTHONPATH"]

RIGHT = """
import numpy as np
import numpy.typing as npt
import tuina
from tuina import simulation

cloud: tuina.PointCloud = simulation.scan(simulation.person("phantom:slim", "prone"))
mapping = tuina.locate_acupoints(tuina.fit_back(cloud, "prone"), tuina.read_atlas())
places: npt.NDArray[np.float64] = mapping.at_in_couch
alpha_n: float = tuina.fit_curve(tuina.Presses([0.0], [0.0], np.zeros(1))).alpha_n
simulation.massage(on_contact=lambda contact: "stop" if contact.felt and contact.felt.alpha_n > 9 else None)
"""
WRONG = """
import tuina
tuina.fit_back("scan.ply")
tuina.locate_acupoints()
tuina.EstimatorOptions(breathing_mm=3.0)
tuina.Mapping().at_in_couchs
"""


@unittest.skipUnless(importlib.util.find_spec("mypy"), "mypy is not installed")
class Stubs(unittest.TestCase):
    def mypy(self, text):
        with tempfile.TemporaryDirectory() as folder:
            with open(f"{folder}/use.py", "w") as file:
                file.write(text)
            return subprocess.run([sys.executable, "-m", "mypy", "--strict", "--cache-dir=/dev/null", f"{folder}/use.py"],
                                  capture_output=True, text=True, env={**os.environ, "MYPYPATH": PACKAGE})

    def test_right_use_passes_and_wrong_use_does_not(self):
        self.assertIn("Success", self.mypy(RIGHT).stdout)
        self.assertIn("Found 4 errors", self.mypy(WRONG).stdout)

    def test_the_stubs_are_those_of_the_module(self):
        done = subprocess.run([sys.executable, "-m", "mypy.stubtest", "tuina", "--concise"], capture_output=True,
                              text=True, env={**os.environ, "MYPYPATH": PACKAGE}, cwd="/")
        self.assertIn("tuina._tuina.Mapping is inconsistent, metaclass differs", done.stdout)  # it has looked
        # Every class of pybind11 has a metaclass of its own, and takes words that it then refuses.
        usual = ("metaclass differs", 'stub does not have *args argument "args"')
        self.assertEqual([line for line in done.stdout.splitlines() if not line.endswith(usual)], [], done.stderr)

    def test_every_public_thing_says_what_it_is(self):
        import tuina
        from tuina import simulation

        silent = [f"{module.__name__}.{name}" for module in (tuina, simulation) for name, what in vars(module).items()
                  if not name.startswith("_") and not getattr(what, "__doc__", None)]
        self.assertEqual(silent, [])
