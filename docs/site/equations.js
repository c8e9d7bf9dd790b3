// SPDX-License-Identifier: Apache-2.0
// Equations of a page, which stand between \( \) and \[ \], are set by KaTeX.
document.addEventListener("DOMContentLoaded", () => {
  for (const equation of document.querySelectorAll(".arithmatex")) renderMathInElement(equation);
});
