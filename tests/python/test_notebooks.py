# SPDX-License-Identifier: Apache-2.0
"""The notebooks: code that compiles, names that the module has, links that lead somewhere, nothing printed. Running
them is the affair of `./run notebooks`."""
import ast, glob, json, os, re, unittest

import tuina
from tuina import simulation

from program import ROOT

MODULES = {"tuina": tuina, "simulation": simulation}


def unknown_names(tree):
    """What code takes from the modules, and they do not have."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id in MODULES:
            if not hasattr(MODULES[node.value.id], node.attr):
                yield f"{node.value.id}.{node.attr}"
        elif isinstance(node, ast.ImportFrom) and node.module == "tuina":
            yield from (f"tuina.{name.name}" for name in node.names if not hasattr(tuina, name.name))


class Notebooks(unittest.TestCase):
    def setUp(self):
        self.notebooks = {}
        for path in sorted(glob.glob(f"{ROOT}/notebooks/*.ipynb")):
            with open(path, encoding="utf-8") as file:
                self.notebooks[os.path.basename(path)] = json.load(file)["cells"]
        self.assertGreaterEqual(len(self.notebooks), 6)

    def cells(self, kind):
        for name, cells in self.notebooks.items():
            yield from ((f"{name}, cell {i}", cell) for i, cell in enumerate(cells) if cell["cell_type"] == kind)

    def test_every_cell_compiles_and_every_name_exists(self):
        for where, cell in self.cells("code"):
            with self.subTest(where):
                tree = ast.parse("".join(cell["source"]), where)
                self.assertEqual(list(unknown_names(tree)), [])

    def test_a_name_that_the_module_does_not_have_is_found(self):
        wrong = "from tuina import simulations\ntuina.fit_backs(cloud)\nmapping.anything"
        self.assertEqual(sorted(unknown_names(ast.parse(wrong))), ["tuina.fit_backs", "tuina.simulations"])

    def test_no_output_is_kept(self):
        kept = [where for where, cell in self.cells("code") if cell["outputs"] or cell["execution_count"]]
        self.assertEqual(kept, [])

    def test_every_link_leads_somewhere(self):
        for where, cell in self.cells("markdown"):
            for link in re.findall(r"\]\(([^)#]+)", "".join(cell["source"])):
                self.assertTrue(os.path.exists(f"{ROOT}/notebooks/{link}"), f"{where}: {link}")


if __name__ == "__main__":
    unittest.main()
