# SPDX-License-Identifier: Apache-2.0
"""What docs/python.md shows works."""
import os, re, tempfile, unittest

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


if __name__ == "__main__":
    unittest.main()
