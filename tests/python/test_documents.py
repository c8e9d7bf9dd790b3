# SPDX-License-Identifier: Apache-2.0
"""What docs/python.md shows and what examples/python/ has works."""
import glob, importlib.util, os, re, subprocess, sys, tempfile, unittest

from program import ROOT


class Documents(unittest.TestCase):
    def test_every_block_of_the_page_runs(self):
        with open(f"{ROOT}/docs/python.md", encoding="utf-8") as file:
            blocks = re.findall(r"^```python\n(.*?)^```", file.read(), re.DOTALL | re.MULTILINE)
        self.assertGreaterEqual(len(blocks), 6)
        names, before = {}, os.getcwd()
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            try:
                for number, block in enumerate(blocks, 1):
                    exec(compile(block, f"docs/python.md, block {number}", "exec"), names)
            finally:
                os.chdir(before)
        # What the page claims by its names.
        self.assertLess(abs(names["gv4"][0] - names["person"].at_in_couch[names["person"].names.index("GV4")][0]), 0.02)
        self.assertLess(names["hardest"], 30.0)
        self.assertEqual(names["now"].alpha_n, names["estimator"].estimate.alpha_n)
        self.assertLess(names["error_n"].mean(), 2.0)
        self.assertEqual(len(names["contacts"]), 1)
        self.assertTrue(names["report"].lstrip().lower().startswith(b"<!doctype html"))

    def test_every_example_runs_in_its_short_form(self):
        examples = sorted(glob.glob(f"{ROOT}/examples/python/0*.py"))
        self.assertGreaterEqual(len(examples), 5)
        draws = importlib.util.find_spec("matplotlib") is not None
        for example in examples:
            with self.subTest(os.path.basename(example)), tempfile.TemporaryDirectory() as folder:
                done = subprocess.run([sys.executable, example, "--fast", "--picture", f"{folder}/picture.png"],
                                      capture_output=True, text=True, cwd=folder)
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertGreater(len(done.stdout.splitlines()), 2)
                if draws:
                    self.assertGreater(os.path.getsize(f"{folder}/picture.png"), 20_000)
                else:
                    self.assertIn("no picture", done.stdout)


if __name__ == "__main__":
    unittest.main()
